"""Clamped displacements: what they promise on any mesh, and what they keep."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from nasty_meshes import corpus
from shapes import bumpy_sphere, torus

pytestmark = pytest.mark.filterwarnings("ignore::spectral_tv.MeshWarning")


@pytest.mark.parametrize("name", corpus())
@pytest.mark.parametrize("size", [1e-2, 1.0, 1e3])
def test_on_bad_meshes_nothing_folds_or_stretches(name, size):
    vertices, triangles = corpus()[name]
    mesh = spectral_tv.Mesh(vertices, triangles)
    rng = np.random.default_rng(3)
    displacement = size * mesh.area**0.5 * rng.normal(size=vertices.shape)
    for stretch in (1.2, 2.5):
        safe = spectral_tv.safe_displacement(mesh, displacement, stretch)
        found = spectral_tv.folds(mesh, safe.displacement, stretch)
        assert found.safe_gain >= 1
        assert len(found.flipped) == len(found.stretched) == 0
        assert safe.shares.min() >= 0
        assert safe.shares.max() <= 1
        np.testing.assert_array_equal(safe.displacement, safe.shares[:, np.newaxis] * displacement)


def test_an_exaggerated_band_keeps_most_of_itself():
    vertices, triangles = bumpy_sphere(4)
    mesh = spectral_tv.Mesh(vertices, triangles)
    split = spectral_tv.decompose(mesh, "m1", steps=12)
    band = split.bands(split.band_edges(3))[1]
    displacement = 2 * band / np.abs(band).max() * 0.2
    before = spectral_tv.folds(mesh, displacement)
    assert len(before.stretched) > 0
    safe = spectral_tv.safe_displacement(mesh, displacement)
    assert spectral_tv.folds(mesh, safe.displacement).safe_gain >= 1
    moved, asked = (np.linalg.norm(d, axis=1) @ mesh.vertex_areas
                    for d in (safe.displacement, displacement))  # fmt: skip
    assert safe.kept == pytest.approx(moved / asked, rel=1e-12)
    # More than what is safe everywhere.
    assert before.safe_gain < safe.kept < 1
    assert (safe.shares == 1).any()


def test_shares_rise_by_one_over_three_hundredths_of_the_size():
    vertices, triangles = torus(2.0, 0.7, 60, 24)
    mesh = spectral_tv.Mesh(vertices, triangles)
    spikes = vertices * np.where(np.arange(len(vertices)) % 300 == 0, 2.0, 0.1)[:, np.newaxis]
    safe = spectral_tv.safe_displacement(mesh, spikes)
    assert safe.shares.min() < 0.5
    for one, other in ((0, 1), (1, 2), (2, 0)):
        ends = triangles[:, one], triangles[:, other]
        length = np.linalg.norm(vertices[ends[0]] - vertices[ends[1]], axis=1)
        rise = np.abs(safe.shares[ends[0]] - safe.shares[ends[1]])
        assert (rise <= length / (0.03 * mesh.area**0.5) * (1 + 1e-9)).all()


def test_what_is_safe_stays_to_the_bit():
    vertices, triangles = bumpy_sphere(3)
    mesh = spectral_tv.Mesh(vertices, triangles)
    displacement = 0.1 * vertices
    safe = spectral_tv.safe_displacement(mesh, displacement)
    np.testing.assert_array_equal(safe.displacement, displacement)
    assert (safe.kept, safe.rounds) == (1, 0)
    assert (safe.shares == 1).all()
