"""The thickness cut: limbs keep what the body loses, and nothing is lost in between."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import spectral_tv
from shapes import bumpy_sphere, dumbbell

BODY = spectral_tv.Mesh(*dumbbell())
METHODS = ("m1", "m2", "m3")


def turned_over(mesh: spectral_tv.Mesh, shape: np.ndarray) -> int:
    """Triangles whose normal turns by over 90°."""

    def normals(vertices: np.ndarray) -> np.ndarray:
        p, q, r = np.moveaxis(vertices[mesh.triangles], 1, 0)
        return np.cross(q - p, r - p)

    return int((np.sum(normals(mesh.vertices) * normals(shape), axis=1) < 0).sum())


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("keep_limbs", [1e-6, 0.5, 3.0])
def test_bands_and_what_they_leave_add_up(method, keep_limbs):
    split = spectral_tv.decompose(BODY, method, steps=12)
    edges = split.band_edges(4)
    bands = split.bands(edges, keep_limbs)
    kept = split.filter(np.ones(11), keep_limbs)
    assert np.array_equal(kept, BODY.vertices) or np.abs(kept - BODY.vertices).max() < 1e-12
    removed = split.filter(np.zeros(11), keep_limbs)
    size = np.abs(BODY.vertices).max()
    assert np.abs(BODY.vertices - bands.sum(axis=0) - removed).max() < 1e-12 * size


def test_bands_of_neighbouring_edges_are_parts_of_those_of_fewer():
    split = spectral_tv.decompose(BODY, steps=16)
    edges = split.band_edges(5)
    fine, coarse = split.bands(edges, 0.5), split.bands(edges[[0, 2, 5]], 0.5)
    assert np.allclose(fine[:2].sum(0), coarse[0], atol=1e-13)
    assert np.allclose(fine[2:].sum(0), coarse[1], atol=1e-13)


def test_without_it_bands_are_what_they_were():
    split = spectral_tv.decompose(BODY, steps=12)
    edges = split.band_edges(4)
    assert np.array_equal(split.bands(edges), split.bands(edges, 0.0))


def test_a_neck_stays_while_the_ends_are_smoothed():
    """The paper's low-pass leaves a string of the neck."""
    mesh = spectral_tv.Mesh(*dumbbell(neck_length=3.0))
    vertices = mesh.vertices
    neck = np.abs(vertices[:, 2]) < 0.5
    radius = np.linalg.norm(vertices[neck, :2], axis=1).mean()
    times = spectral_tv.graded_times(1e-4 * mesh.area, 3 * radius**2, 32)
    split = spectral_tv.decompose(mesh, times=times)

    def left(keep_limbs: float) -> float:
        shape = vertices - split.bands([0, times[-1]], keep_limbs)[0]
        return float(np.linalg.norm(shape[neck, :2], axis=1).mean() / radius)

    assert left(0.0) < 0.35
    assert left(2.0) > 0.85
    assert left(2.0) > left(1.0) > left(0.25) > left(0.0)


def test_the_order_of_vertices_and_triangles_hardly_matters():
    """Thickness is measured at samples, which follow it."""
    vertices, triangles = dumbbell()
    rng = np.random.default_rng(0)
    order = rng.permutation(len(vertices))
    places = np.argsort(order)
    other = spectral_tv.Mesh(vertices[order], rng.permutation(places[triangles]))
    removed = [
        split.bands(split.band_edges(1), 1.0)[0]
        for split in (spectral_tv.decompose(mesh, steps=12) for mesh in (BODY, other))
    ]
    apart = np.linalg.norm(removed[0] - removed[1][places], axis=1)
    assert apart.mean() < 0.05 * np.linalg.norm(removed[0], axis=1).mean()


@pytest.mark.parametrize("method", ["m1", "m3"])
def test_keeping_all_limbs_leaves_every_band_empty(method):
    split = spectral_tv.decompose(BODY, method, steps=12)
    bands = split.bands(split.band_edges(3), 1e9)
    assert np.abs(bands).max() < 1e-9 * np.abs(BODY.vertices).max()


def test_a_factor_that_makes_no_sense_is_refused():
    split = spectral_tv.decompose(BODY, steps=4)
    for value in (-1.0, np.nan, np.inf):
        with pytest.raises(spectral_tv.MeshError, match="keep_limbs must be 0 or more"):
            split.bands(split.band_edges(2), value)
        with pytest.raises(spectral_tv.MeshError, match="keep_limbs must be 0 or more"):
            split.filter(np.ones(3), keep_limbs=value)


def test_a_restored_decomposition_keeps_limbs_as_well():
    split = spectral_tv.decompose(BODY, steps=8)
    restored = pickle.loads(pickle.dumps(split))
    edges = split.band_edges(3)
    assert np.array_equal(split.bands(edges, 0.5), restored.bands(edges, 0.5))


def test_caricature_and_accuracy_know_it():
    band = (1e-4, 1e-3)
    shapes = [
        spectral_tv.caricature([BODY], band, gain=3.0, method="m1", steps=12, keep_limbs=kept)[0]
        for kept in (0.0, 1.0)
    ]
    assert np.abs(shapes[0] - shapes[1]).max() > 7e-4 * np.sqrt(BODY.area)
    found = [
        spectral_tv.accuracy(BODY, steps=[6, 12], bands=3, refinement=4, keep_limbs=kept)
        for kept in (0.0, 1.0)
    ]
    for accuracy in found:
        assert (accuracy.relative[1] < accuracy.relative[0]).all()
    assert not np.array_equal(found[0].relative, found[1].relative)


def test_soft_edges_stretch_less_and_keep_the_sum():
    mesh = spectral_tv.Mesh(*bumpy_sphere(4))

    def steepest(soft_edges: float) -> float:
        split = spectral_tv.decompose(mesh, soft_edges=soft_edges, steps=24)
        assert np.abs(split.filter(np.ones(23)) - mesh.vertices).max() < 1e-12
        shape = split.residual
        edges = np.vstack([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]]])

        def lengths(vertices: np.ndarray) -> np.ndarray:
            return np.linalg.norm(np.diff(vertices[edges], axis=1)[:, 0], axis=1)

        return float((lengths(shape) / lengths(mesh.vertices)).max())

    assert steepest(0.3) < steepest(0.0)


def test_soft_edges_are_refused_where_they_mean_nothing():
    for options, message in (
        ({"soft_edges": -0.1}, "soft_edges must be from 0 to 1"),
        ({"soft_edges": 0.3, "method": "m2"}, 'soft_edges is an option of the method "m1" only'),
        ({"soft_edges": 0.3, "scheme": "exact"}, "do not go with soft_edges"),
    ):
        with pytest.raises(spectral_tv.MeshError, match=message):
            spectral_tv.decompose(BODY, **options)


def test_m3_on_a_base_that_keeps_limbs_turns_nothing_over():
    """The paper's base swallows the neck, and M3's scalar then shreds it."""
    split = spectral_tv.decompose(BODY, "m3", base="limbs", displacement="vector", steps=16)
    bands = split.bands(split.band_edges(4))
    assert np.abs(split.residual + bands.sum(0) - BODY.vertices).max() < 1e-12
    for shape in (split.residual, BODY.vertices + bands.sum(0)):
        assert turned_over(BODY, shape) == 0


def test_a_vector_is_flowed_where_the_displacement_is_one():
    split = spectral_tv.decompose(BODY, "m3", displacement="vector", steps=8)
    assert split.flow.states.shape[2] == 3
    assert np.abs(split.filter(np.ones(7)) - BODY.vertices).max() < 1e-12
    with pytest.raises(spectral_tv.MeshError, match="base must be"):
        spectral_tv.decompose(BODY, "m3", base="arms")
