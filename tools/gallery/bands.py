"""Figure 9: three bands of M1, each amplified, and each alone on the residual.

Below the paper's are those with soft edges and limbs kept.
"""

from __future__ import annotations

from ..demo.contact_sheet import Cell
from .gallery import Gallery
from .page import Shape
from .shipped import PAPER, SHIPPED, Bands

GAIN = 2.5


def make(gallery: Gallery) -> None:
    """Split each subject in both ways, and put it together again in eight ways."""
    for name, shape in gallery.subjects("igea", "armadillo"):
        sheets = [
            ("M1, three bands, the paper's", _rows(shape, PAPER["m1"])),
            ("M1, three bands, as they ship", _rows(shape, SHIPPED["m1"])),
        ]
        gallery.save("bands", sheets, name)


def _rows(shape: Shape, by: Bands) -> list[list[Cell]]:
    """Each band amplified, and each on the residual."""
    bands = by.of(shape.mesh, 3, steps=40)
    residual = shape.vertices - bands.sum(axis=0)
    versions = [shape.vertices, residual]
    versions += [shape.vertices + (GAIN - 1) * band for band in bands]
    versions += [residual + band for band in bands]
    shots = shape.positions(versions)
    return [
        [
            ("All-pass", shots[0]),
            ("Residual", shots[1]),
            *((f"Band {n} × {GAIN:g}", shot) for n, shot in enumerate(shots[2:5], 1)),
        ],
        [
            ("", None),
            ("", None),
            *((f"Band {n} on the residual", shot) for n, shot in enumerate(shots[5:], 1)),
        ],
    ]
