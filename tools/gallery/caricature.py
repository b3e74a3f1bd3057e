"""Figures 12 and 21: M3 smooths, and exaggerates poses alike."""

from __future__ import annotations

import numpy as np
import spectral_tv

from .gallery import Gallery
from .page import Shape
from .shapes import poses

# As t/area: scales are gone before the first, and the band begins at the second.
SMOOTH, BAND, GAIN = 4e-5, (1e-4, 1e-3), 2.0


def make(gallery: Gallery) -> None:
    """Low-pass by M3 and by heat, and the band with and without smoothing; then the poses."""
    for name, shape in gallery.subjects("armadillo"):
        mesh = shape.mesh
        splits = [spectral_tv.decompose(mesh, method) for method in ("heat", "m3")]
        low = [_smoothed(split, 1.5 * SMOOTH * mesh.area) for split in splits]
        grown = [
            spectral_tv.caricature([mesh], BAND, gain=GAIN, smooth=smooth)[0]
            for smooth in (SMOOTH, 0.0)
        ]
        labels = (
            "Original",
            "Heat, low-pass",
            "M3, low-pass",
            "Band × 2, smoothed",
            "Band × 2",
        )
        shots = shape.positions([shape.vertices, *low, *grown], cell=190)
        row = list(zip(labels, shots, strict=True))
        gallery.save("caricature", [("M3", [row])], name, cell=190)
    _poses(gallery, poses(), "")
    others = [gallery.mesh(f"michael{number}") for number in (0, 4, 13, 16)]
    if None not in others:
        _poses(gallery, [shape for shape in others if shape is not None], "michael")


def _smoothed(split: spectral_tv.Decomposition, time: float) -> np.ndarray:
    """Without what has vanished at a time."""
    return split.filter((split.times[1:-1] > time).astype(float))


def _poses(gallery: Gallery, shapes: list[Shape], subject: str) -> None:
    grown = spectral_tv.caricature([shape.mesh for shape in shapes], BAND, gain=GAIN)
    row = []
    for shape, positions in zip(shapes, grown, strict=True):
        before, after = shape.positions([shape.vertices, positions])
        row += [("Pose", before), ("Band × 2", after)]
    gallery.save("caricature_poses", [("One filter, several poses", [row])], subject)
