"""Figures 13, 15 and 19: pulls followed in several ways, and how far everything moves."""

from __future__ import annotations

import numpy as np
import spectral_tv

from .colors import colors
from .gallery import Gallery
from .pulls import pulls

WAYS = (
    ("Harmonic", "harmonic"),
    ("Biharmonic", "biharmonic"),
    ("As rigid as possible", "arap"),
    ("TV, Algorithm 1", "paper"),
    ("TV, convex", "convex"),
)


def make(gallery: Gallery) -> None:
    """Each way as clay, and with the lengths of its displacements as colors."""
    for name, shape, indices, targets in pulls(gallery):
        mesh = shape.mesh
        ways = [
            (label, spectral_tv.deform(mesh, indices, targets, algorithm=a)) for label, a in WAYS
        ]
        longest = np.linalg.norm(targets - shape.vertices[indices], axis=1).max()
        pictures = [(shape.vertices, None)]
        pictures += [(way.vertices, None) for _, way in ways]
        for _, way in ways:
            lengths = np.linalg.norm(way.vertices - shape.vertices, axis=1)
            pictures.append((way.vertices, colors(lengths, 0, longest)))
        shots = shape.photograph(pictures, cell=150)
        least = min(way.total_variation for _, way in ways)
        rows = [
            [
                ("Before", shots[0]),
                *((label, s) for (label, _), s in zip(ways, shots[1:6], strict=True)),
            ],
            [
                ("", None),
                *(
                    (f"TV {way.total_variation / least:.2f}", shot)
                    for (_, way), shot in zip(ways, shots[6:], strict=True)
                ),
            ],
        ]
        title = "One pull; below, how far each point moves, and TV against the least"
        gallery.save("deformations", [(title, rows)], name, cell=150)
