"""The bands of the paper and those that Blender makes, of many kinds of shapes."""

from __future__ import annotations

import numpy as np

from .gallery import Gallery
from .page import Shape, save
from .shipped import COUNT, PAPER, SHIPPED, Bands, mixed

CELL, SHADES = 130, 64
ROWS = (
    ("M1, the paper's", PAPER["m1"]),
    ("M1, as it ships", SHIPPED["m1"]),
    ("M2", SHIPPED["m2"]),
    ("M3, the paper's", PAPER["m3"]),
    ("M3, as it ships", SHIPPED["m3"]),
)
LABELS = ("Low-pass", *(f"Band {band} × 2" for band in range(1, COUNT + 1)))
# All bands removed; each doubled.
VALUES = np.vstack([np.full(COUNT, -1), np.eye(COUNT)])


def make(gallery: Gallery) -> None:
    """A picture of each model; faces that are folded over are red."""
    for name, shape, is_own in gallery.models():
        folder = gallery.output / ("looks" if is_own else "meshes")
        before = [("Shape", shape.positions([shape.vertices], CELL)[0])]
        sheets = [(title, [before + _row(shape, bands)]) for title, bands in ROWS]
        save(folder / f"looks_{name}.png", sheets, CELL, SHADES)


def _row(shape: Shape, bands: Bands) -> list[tuple[str, object]]:
    """Low-pass, and each band doubled."""
    mesh = shape.mesh
    found = bands.of(mesh)
    shots = shape.folds([mixed(mesh, found, values) for values in VALUES], CELL)
    return list(zip(LABELS, shots, strict=True))
