"""The picture of the paper's comparison: one pull on the creature, followed in several ways.

python -m tools.demo.deformations CREATURE.blend PICTURE.png
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import spectral_tv

from .contact_sheet import render
from .shapes import opened

CELL = 190
PULL = np.array([0.45, -0.1, 0.25])
# Label, algorithm, and softness relative to the size of the object.
FOLLOWED = (
    ("Harmonic", "harmonic", 0.0),
    ("Biharmonic", "biharmonic", 0.0),
    ("As rigid as possible", "arap", 0.0),
    ("Total variation", "convex", 0.0),
    ("… with softness 10 %", "convex", 0.1),
)


def main(blend: Path, path: Path) -> None:
    """Render the creature, and each way in which it follows."""
    obj, basis, mesh = opened(blend)
    height = basis[:, 2]
    feet, crown = np.flatnonzero(height < 0.08), np.flatnonzero(height > 1.72)
    indices = np.r_[feet, crown]
    targets = np.vstack([basis[feet], basis[crown] + PULL])
    bodies = np.repeat([-1, 0], [len(feet), len(crown)])
    row = [
        ("Before", basis),
        ("Pose", spectral_tv.pose(mesh, indices, targets, bodies=bodies).vertices),
    ]
    for label, algorithm, softness in FOLLOWED:
        result = spectral_tv.deform(
            mesh, indices, targets, softness=softness * mesh.area**0.5, algorithm=algorithm
        )
        row.append((label, result.vertices))
    render(obj, [("Feet held, crown pulled", [row[:4], row[4:]])], path, cell=CELL, shades=64)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
