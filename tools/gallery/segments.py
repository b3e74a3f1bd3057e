"""Figure 18: the same parts in several poses, by M2's spectra."""

from __future__ import annotations

import spectral_tv

from .colors import labels
from .gallery import Gallery
from .page import Shape
from .shapes import poses

SEGMENTS = 6


def make(gallery: Gallery) -> None:
    """Segment the dragon's poses together, and those of a folder."""
    _segment(gallery, poses(), "")
    others = [gallery.mesh(f"michael{number}") for number in (0, 4, 13, 16)]
    if None not in others:
        _segment(gallery, [shape for shape in others if shape is not None], "michael")


def _segment(gallery: Gallery, shapes: list[Shape], subject: str) -> None:
    splits = [spectral_tv.decompose(shape.mesh, "m2", steps=48) for shape in shapes]
    numbers = spectral_tv.cosegment(splits, SEGMENTS)
    row = []
    for shape, parts in zip(shapes, numbers, strict=True):
        agreement = (parts == numbers[0]).mean()
        (shot,) = shape.painted([labels(parts)], cell=210)
        row.append((f"{agreement:.0%} as in the first pose", shot))
    gallery.save("segments", [("Six parts of all poses together", [row])], subject, cell=210)
