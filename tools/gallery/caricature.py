"""Figures 12 and 21: M3 smooths, and exaggerates poses alike.

Below the paper's are M3 with Blender's base, and what Exaggerate Selected does.
"""

from __future__ import annotations

import numpy as np
import spectral_tv
from PIL import Image

from .gallery import Gallery
from .page import Shape
from .shapes import poses
from .shipped import AMOUNTS, CARICATURE, SHIPPED, mixed

# As t/area: scales are gone before the first, and the band begins at the second.
SMOOTH, BAND, GAIN = 4e-5, (1e-4, 1e-3), 2.0
# M3's bands as they ship, of which the two finest are smoothed away, and the others doubled.
LOW, RAISED, RAISED_SMOOTH = (-1, -1, 0, 0, 0), (0, 0, 1, 1, 1), (-1, -1, 1, 1, 1)
EXAGGERATED = "Exaggerate Selected"


def make(gallery: Gallery) -> None:
    """Low-pass by M3 and by heat, and the band with and without smoothing; then the poses."""
    for name, shape in gallery.subjects("armadillo"):
        sheets = [("M3, the paper's", _paper(shape)), ("As it ships", _shipped(shape))]
        gallery.save("caricature", [(title, [row]) for title, row in sheets], name, cell=190)
    _poses(gallery, poses(), "")
    others = [gallery.mesh(f"michael{number}") for number in (0, 4, 13, 16)]
    if None not in others:
        _poses(gallery, [shape for shape in others if shape is not None], "michael")


def _paper(shape: Shape) -> list[tuple[str, Image.Image]]:
    mesh = shape.mesh
    splits = [spectral_tv.decompose(mesh, method) for method in ("heat", "m3")]
    low = [_smoothed(split, 1.5 * SMOOTH * mesh.area) for split in splits]
    grown = [
        spectral_tv.caricature([mesh], BAND, gain=GAIN, smooth=smooth)[0]
        for smooth in (SMOOTH, 0.0)
    ]
    labels = ("Original", "Heat, low-pass", "M3, low-pass", "Band × 2, smoothed", "Band × 2")
    shots = shape.positions([shape.vertices, *low, *grown], cell=190)
    return list(zip(labels, shots, strict=True))


def _shipped(shape: Shape) -> list[tuple[str, Image.Image]]:
    mesh = shape.mesh
    bands = SHIPPED["m3"].of(mesh)
    versions = [
        shape.vertices,
        _exaggerated(mesh),
        *(mixed(mesh, bands, values) for values in (LOW, RAISED_SMOOTH, RAISED)),
    ]
    labels = ("Original", EXAGGERATED, "M3, low-pass", "M3, 3–5 × 2, smoothed", "M3, 3–5 × 2")
    return list(zip(labels, shape.positions(versions, cell=190), strict=True))


def _exaggerated(mesh: spectral_tv.Mesh) -> np.ndarray:
    return mixed(mesh, CARICATURE.of(mesh), AMOUNTS)


def _smoothed(split: spectral_tv.Decomposition, time: float) -> np.ndarray:
    """Without what has vanished at a time."""
    return split.filter((split.times[1:-1] > time).astype(float))


def _poses(gallery: Gallery, shapes: list[Shape], subject: str) -> None:
    grown = spectral_tv.caricature([shape.mesh for shape in shapes], BAND, gain=GAIN)
    rows: list[list[tuple[str, Image.Image]]] = [[], []]
    for shape, by_paper in zip(shapes, grown, strict=True):
        own = _exaggerated(shape.mesh)
        before, paper, after = shape.positions([shape.vertices, by_paper, own])
        rows[0] += [("Pose", before), ("Band × 2", paper)]
        rows[1] += [("Pose", before), (EXAGGERATED, after)]
    titles = ("One filter, several poses: M3, the paper's", "The same by Exaggerate Selected")
    gallery.save("caricature_poses", [(t, [r]) for t, r in zip(titles, rows, strict=True)], subject)
