"""Triangle soups of the worst kind: every method gives finite bands that add up to the shape."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv

# Some meshes are bad on purpose.
pytestmark = pytest.mark.filterwarnings("ignore::spectral_tv.MeshWarning")

KINDS = {
    "random": lambda v, rng: v,
    "flat": lambda v, rng: v * [1, 1, 0],
    "coincident": lambda v, rng: v[rng.integers(0, len(v), len(v))],
    "on a grid": lambda v, rng: np.round(2 * v),
    "needles": lambda v, rng: v * [1, 1e-9, 1e-9],
    "far away": lambda v, rng: v + 1e6,
}


def soup(kind, rng):
    """Random triangles over random vertices, of any size, repeated indices included."""
    vertices = KINDS[kind](rng.normal(size=(rng.integers(3, 40), 3)), rng)
    triangles = rng.integers(0, len(vertices), (rng.integers(1, 80), 3))
    return vertices * 10.0 ** rng.integers(-8, 8), triangles


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scheme", ["lagged", "extrapolated", "exact"])
def test_soups(kind, scheme):
    rng = np.random.default_rng(len(kind))
    methods = ["m1", "m3", "naive"] if scheme == "exact" else ["m1", "m2", "m3", "naive", "heat"]
    survived = 0
    for _ in range(12):
        vertices, triangles = soup(kind, rng)
        try:
            mesh = spectral_tv.Mesh(vertices, triangles)
        except spectral_tv.MeshError as error:
            assert "span no area" in str(error)
            continue
        survived += 1
        for method in methods:
            split = spectral_tv.decompose(mesh, method, steps=6, scheme=scheme)
            bands = split.bands(split.band_edges(3))
            assert np.isfinite(bands).all()
            total = bands.sum(axis=0) + split.residual
            np.testing.assert_allclose(total, vertices, atol=1e-9 * np.abs(vertices).max())
    assert survived > 5
