"""Figure 8: a stone smoothed by M1 and axis by axis, and the detail of one on the other."""

from __future__ import annotations

import spectral_tv

from . import shapes
from .gallery import Gallery

SMOOTH = 2.5e-3


def make(gallery: Gallery) -> None:
    """Low-pass by both, and M1's high-pass on the naive low-pass."""
    shape = shapes.meteorite()
    mesh = shape.mesh
    times = spectral_tv.graded_times(1e-5 * mesh.area, 1.5e-2 * mesh.area, 40)
    splits = [spectral_tv.decompose(mesh, method, times) for method in ("m1", "naive")]
    low = [split.filter(lambda t: float(t > SMOOTH * mesh.area)) for split in splits]
    stages = (
        ("The stone", shape.vertices),
        ("M1, low-pass", low[0]),
        ("Naive, low-pass", low[1]),
        ("Naive low-pass + M1 high-pass", low[1] + shape.vertices - low[0]),
    )
    shots = shape.positions([positions for _, positions in stages], cell=210)
    row = [(label, shot) for (label, _), shot in zip(stages, shots, strict=True)]
    gallery.save("meteorite", [("Together, or each axis by itself", [row])], cell=210)
