"""How many faces fold, cross and stretch under the bands of the paper, and under Blender's."""

from __future__ import annotations

import numpy as np
import spectral_tv

from .gallery import Gallery
from .shipped import COUNT, PAPER, SHIPPED, mixed
from .tables import write_row

# Of the columns: every band removed, and the largest doubled.
REMOVED, DOUBLED = np.full(COUNT, -1), np.eye(COUNT)[-1]
METHODS = ("m1", "m3")


def make(gallery: Gallery) -> None:
    """Fill in the rows of looks.md whose meshes are there; the others stay."""
    page = gallery.output / "looks.md"
    for name, shape, _ in gallery.models():
        mesh = shape.mesh
        crossing = len(spectral_tv.self_intersections(mesh))
        begin = f"| {name} | {len(mesh.vertices):,} | {crossing:,} |".replace(",", " ")
        for method in METHODS:
            bands = [each[method].of(mesh) for each in (PAPER, SHIPPED)]
            cells = [
                _measured(mesh, mixed(mesh, found, values))
                for values in (REMOVED, DOUBLED)
                for found in bands
            ]
            write_row(page, method, f"{begin} {' | '.join(cells)} |")


def _measured(mesh: spectral_tv.Mesh, shape: np.ndarray) -> str:
    """Folded, crossing faces; the largest stretch."""
    moved = shape - mesh.vertices
    found = spectral_tv.folds(mesh, moved)
    crossing = len(spectral_tv.self_intersections(mesh, moved))
    return f"{len(found.flipped)} / {crossing} / {found.largest_stretch:.1f}"
