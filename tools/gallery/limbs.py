"""Figure 11: limbs and heads grown and shrunk by M2."""

from __future__ import annotations

import spectral_tv

from .gallery import Gallery

FILTERS = (
    ("Original", (1, 1, 1, 1, 1)),
    ("Bands 3-5 × 0.5", (1, 1, 0.5, 0.5, 0.5)),
    ("Bands 3-5 × 1.5", (1, 1, 1.5, 1.5, 1.5)),
    ("Band 5 × 2", (1, 1, 1, 1, 2)),
)


def make(gallery: Gallery) -> None:
    """The same filters on every subject."""
    for name, shape in gallery.subjects("michael0", "michael13", "armadillo"):
        split = spectral_tv.decompose(shape.mesh, "m2", steps=40)
        bands = split.bands(split.band_edges(5))
        versions = [
            split.residual + sum(g * band for g, band in zip(gains, bands, strict=True))
            for _, gains in FILTERS
        ]
        shots = shape.positions(versions, cell=200)
        row = [(label, shot) for (label, _), shot in zip(FILTERS, shots, strict=True)]
        gallery.save("limbs", [("M2", [row])], name, cell=200)
