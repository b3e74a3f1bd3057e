"""Figure 9: three bands of M1, each amplified, and each alone on the residual."""

from __future__ import annotations

import spectral_tv

from .gallery import Gallery

GAIN = 2.5


def make(gallery: Gallery) -> None:
    """Split each subject, and put it together again in eight ways."""
    for name, shape in gallery.subjects("igea", "armadillo"):
        split = spectral_tv.decompose(shape.mesh, "m1", steps=40)
        bands = split.bands(split.band_edges(3))
        versions = [shape.vertices, split.residual]
        versions += [shape.vertices + (GAIN - 1) * band for band in bands]
        versions += [split.residual + band for band in bands]
        shots = shape.positions(versions)
        rows = [
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
        gallery.save("bands", [("M1, three bands", rows)], name)
