"""What holds for every flow, mesh and filter."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import bumpy_sphere, cylinder_open, dumbbell, icosphere
from torn import half_grids

METHODS = ["naive", "m1", "m2", "m3", "heat", "lb"]
SCHEMES = ["lagged", "extrapolated", "exact"]
ROTATION = np.linalg.qr(np.array([[2.0, 1.0, 0.3], [-0.5, 1.0, 2.0], [1.0, -2.0, 0.7]]))[0]


def two_components():
    (first, triangles), (second, more) = bumpy_sphere(3), cylinder_open()
    vertices = np.concatenate([first, second + np.array([5.0, 0.0, 0.0])])
    return vertices, np.concatenate([triangles, more + len(first)]), len(first)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("shape", [bumpy_sphere(4), cylinder_open(), dumbbell()])
def test_bands_and_residual_are_the_shape(method, shape):
    vertices, _ = shape
    split = spectral_tv.decompose(spectral_tv.Mesh(*shape), method, steps=12)
    for edges in (split.band_edges(5), split.times[[0, 3, 5, 12]]):
        total = split.bands(edges).sum(axis=0) + split.residual
        np.testing.assert_allclose(total, vertices, atol=1e-9)
    np.testing.assert_allclose(split.filter(np.ones(11)), vertices, atol=1e-9)
    np.testing.assert_allclose(split.filter(np.zeros(11)), split.residual, atol=1e-12)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("channels", [1, 3])
def test_mean_is_kept_on_every_component(scheme, channels):
    vertices, triangles, first = two_components()
    mesh = spectral_tv.Mesh(vertices, triangles)
    values = vertices[:, 2] if channels == 1 else vertices
    times = np.geomspace(1e-3, 1, 12)
    flow = spectral_tv.flow(mesh, values, [0, *times], scheme=scheme)
    areas = mesh.vertex_areas
    for part in (slice(0, first), slice(first, None)):
        means = np.average(flow.states[:, part], axis=1, weights=areas[part])
        np.testing.assert_allclose(means, means[:1] * np.ones_like(means), atol=1e-9)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize("steps", [10, 40])
def test_tv_never_grows(scheme, channels, steps):
    vertices, triangles = bumpy_sphere(4)
    values = (vertices[:, 0] > 0.2).astype(float) if channels == 1 else vertices
    mesh = spectral_tv.Mesh(vertices, triangles)
    # Well past extinction, where extrapolation is tempted to overshoot.
    times = np.linspace(0, 1.2, steps + 1)
    if scheme == "exact":
        on_edges = spectral_tv.flow(mesh, values, times, scheme=scheme, elements="edges")
        # Each of its steps is exact but for the gap.
        growth = np.diff(on_edges.total_variation) / on_edges.total_variation[0]
        assert growth.max() <= 1e-6
    flow = spectral_tv.flow(mesh, values, times, scheme=scheme, elements="vertices")
    growth = np.diff(flow.total_variation) / flow.total_variation[0]
    assert growth.max() <= 1e-9
    measured = spectral_tv.total_variation(mesh, flow.states[3])
    assert flow.total_variation[3] == pytest.approx(measured)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("alpha", [-1.0, 3.0, -0.01])
def test_zero_homogeneity(scheme, alpha):
    """p(αu) = sign(α) p(u): scaling the values scales time."""
    vertices, triangles = bumpy_sphere(3)
    mesh = spectral_tv.Mesh(vertices, triangles)
    times = np.array([0, 0.01, 0.02, 0.05, 0.1])
    flow = spectral_tv.flow(mesh, vertices[:, 0], times, scheme=scheme)
    scaled = spectral_tv.flow(mesh, alpha * vertices[:, 0], abs(alpha) * times, scheme=scheme)
    np.testing.assert_allclose(scaled.states, alpha * flow.states, atol=1e-9 * abs(alpha))


@pytest.mark.parametrize("method", ["m1", "m2", "m3", "heat"])
@pytest.mark.parametrize(
    ("matrix", "offset", "scale"),
    [
        (ROTATION, [0, 0, 0], 1),
        (np.eye(3), [100, -20, 3], 1),
        (1e3 * np.eye(3), [0, 0, 0], 1e3),
        (0.02 * ROTATION, [1, 2, 3], 0.02),
    ],
    ids=["rotation", "translation", "scale", "all"],
)
def test_rotation_translation_and_scale_commute(method, matrix, offset, scale):
    vertices, triangles = bumpy_sphere(4)
    split = spectral_tv.decompose(spectral_tv.Mesh(vertices, triangles), method, steps=10)
    moved = spectral_tv.Mesh(vertices @ matrix.T + offset, triangles)
    other = spectral_tv.decompose(moved, method, steps=10)
    # Scaling the mesh by s scales time by s²; default times follow the area.
    np.testing.assert_allclose(other.times, scale**2 * split.times, rtol=1e-9)
    expected = split.bands(split.band_edges(4)) @ matrix.T
    np.testing.assert_allclose(other.bands(other.band_edges(4)), expected, atol=1e-7 * scale)


def test_naive_method_depends_on_the_axes():
    vertices, triangles = bumpy_sphere(4)
    split = spectral_tv.decompose(spectral_tv.Mesh(vertices, triangles), "naive", steps=10)
    turned = spectral_tv.Mesh(vertices @ ROTATION.T, triangles)
    other = spectral_tv.decompose(turned, "naive", steps=10)
    assert np.abs(other.residual - split.residual @ ROTATION.T).max() > 1e-2


def test_vertex_order_does_not_matter():
    vertices, triangles = bumpy_sphere(4)
    order = np.random.default_rng(1).permutation(len(vertices))
    split = spectral_tv.decompose(spectral_tv.Mesh(vertices, triangles), steps=10)
    shuffled = spectral_tv.Mesh(vertices[order], np.argsort(order)[triangles])
    other = spectral_tv.decompose(shuffled, steps=10)
    np.testing.assert_allclose(other.residual, split.residual[order], atol=1e-9)


def test_two_channels_are_coupled_but_equal_copies_are_not_told_apart():
    """VNETV of (u, u) is √2 NETV(u), so the pair flows √2 times faster than in its own time."""
    vertices, triangles = bumpy_sphere(3)
    mesh = spectral_tv.Mesh(vertices, triangles)
    u = vertices[:, 0]
    times = np.array([0, 0.02, 0.05, 0.1])
    pair = spectral_tv.flow(mesh, np.column_stack([u, u]), np.sqrt(2) * times, scheme="lagged")
    alone = spectral_tv.flow(mesh, u, times, scheme="lagged")
    np.testing.assert_allclose(pair.states[..., 0], alone.states, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_bad_triangles_loose_vertices_and_fins(method):
    """Zero-area triangles, needles, a non-manifold fin, vertices in no triangle."""
    vertices, triangles = icosphere(3)
    v = len(vertices)
    extra = [
        0.5 * (vertices[triangles[0, 0]] + vertices[triangles[0, 1]]),
        vertices[5] * 1.5,
        [9.0, 9.0, 9.0],
    ]
    vertices = np.concatenate([vertices, extra])
    bad = [[*triangles[0, :2], v], [5, triangles[7, 0], v + 1], [3, 3, 4]]
    mesh = spectral_tv.Mesh(vertices, np.concatenate([triangles, bad]))
    split = spectral_tv.decompose(mesh, method, steps=10)
    bands = split.bands(split.band_edges(4))
    assert np.isfinite(bands).all()
    np.testing.assert_allclose(bands.sum(axis=0) + split.residual, vertices, atol=1e-9)
    np.testing.assert_allclose(split.residual[v + 2], [9, 9, 9], atol=1e-12)


@pytest.mark.parametrize("method", ["naive", "m1", "m2", "m3", "heat"])
def test_vertices_in_no_triangle_change_nothing(method):
    """Nor on which side of its base M3 takes a relief to be, of which nearly all is at it."""
    whole = spectral_tv.Mesh(*half_grids(9, 33, 0.0), weld=1e-6)
    vertices, triangles = whole.vertices, whole.triangles
    more = np.vstack([vertices, vertices[:9] + 1e-3])
    split, other = (
        spectral_tv.decompose(spectral_tv.Mesh(places, triangles), method, steps=12)
        for places in (vertices, more)
    )
    np.testing.assert_allclose(other.residual[:-9], split.residual, atol=1e-10)
    np.testing.assert_allclose(other.residual[-9:], more[-9:], atol=1e-12)


@pytest.mark.parametrize("size", [1e-9, 1e7])
@pytest.mark.parametrize("method", METHODS)
def test_extreme_units(method, size):
    vertices, triangles = bumpy_sphere(3)
    split = spectral_tv.decompose(spectral_tv.Mesh(size * vertices, triangles), method, steps=8)
    expected = spectral_tv.decompose(spectral_tv.Mesh(vertices, triangles), method, steps=8)
    np.testing.assert_allclose(split.residual, size * expected.residual, atol=1e-6 * size)


def test_a_constant_function_stays():
    mesh = spectral_tv.Mesh(*icosphere(2))
    for scheme in SCHEMES:
        flow = spectral_tv.flow(mesh, np.full(162, 7.0), [0, 1, 2], scheme=scheme)
        np.testing.assert_allclose(flow.states, 7.0)
        np.testing.assert_allclose(flow.gap, 0.0)
