"""Eigenpairs of the Laplace–Beltrami operator, and filtering by them."""

from __future__ import annotations

import numpy as np
import pytest
import reference
import scipy.sparse as sp
import spectral_tv
from scipy.linalg import eigh
from scipy.sparse.linalg import eigsh
from shapes import bumpy_sphere, cylinder_open, icosphere, torus

SPHERE, CYLINDER = bumpy_sphere(4, amplitude=0.3), cylinder_open()
TWO = (
    np.concatenate([SPHERE[0], CYLINDER[0] + [5.0, 0.0, 0.0]]),
    np.concatenate([SPHERE[1], CYLINDER[1] + len(SPHERE[0])]),
)
SHAPES = {"bumpy": SPHERE, "open": CYLINDER, "torus": torus(2.0, 0.6, 60, 24), "two": TWO}


def matrices(shape):
    """L and M of the reference, (V, V)."""
    ops = reference.Operators(*shape)
    return ops.laplacian(np.ones(len(shape[1]))), sp.diags_array(ops.vertex_areas, format="csc")


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_eigenpairs_are_those_of_arpack(shape):
    laplacian, masses = matrices(shape)
    values, functions = spectral_tv.eigenpairs(spectral_tv.Mesh(*shape), 60)
    expected, modes = eigsh(laplacian, k=60, M=masses, sigma=-0.01)
    order = np.argsort(expected)
    np.testing.assert_allclose(values, expected[order], atol=1e-9 * expected.max())
    assert (np.diff(values) >= -1e-9).all()
    products = functions.T @ masses @ functions
    np.testing.assert_allclose(products, np.eye(60), atol=1e-10)
    residual = laplacian @ functions - masses @ functions * values
    assert np.abs(residual).max() < 1e-7 * np.abs(laplacian @ functions).max()
    # The spaces agree up to a gap; single functions of a multiple eigenvalue do not.
    last = np.flatnonzero(np.diff(values) > 1e-3 * values[-1])[-1] + 1
    ours, theirs = functions[:, :last], modes[:, order[:last]]
    off = theirs - ours @ (ours.T @ (masses @ theirs))
    assert np.abs(off).max() < 1e-6 * np.abs(theirs).max()


def test_sphere_has_l_times_l_plus_1_as_often_as_it_should():
    values, _ = spectral_tv.eigenpairs(spectral_tv.Mesh(*icosphere(5, 2.0)), 64)
    expected = np.concatenate(
        [np.full(2 * degree + 1, degree * (degree + 1)) for degree in range(8)]
    )
    np.testing.assert_allclose(values, expected / 2.0**2, rtol=0.01, atol=1e-9)


def test_all_eigenpairs_of_a_small_mesh():
    """As many as there are vertices, however many more are asked for."""
    shape = icosphere(2)
    laplacian, masses = matrices(shape)
    values, functions = spectral_tv.eigenpairs(spectral_tv.Mesh(*shape), 1000)
    np.testing.assert_allclose(
        values, eigh(laplacian.toarray(), masses.toarray(), eigvals_only=True), atol=1e-9
    )
    np.testing.assert_allclose(functions @ functions.T @ masses, np.eye(162), atol=1e-9)


def test_vertices_in_no_triangle_and_torn_triangles_do_no_harm():
    vertices, triangles = icosphere(3)
    alone = np.concatenate([vertices, [[3.0, 0, 0], [4.0, 0, 0]]])
    values, functions = spectral_tv.eigenpairs(spectral_tv.Mesh(alone, triangles), 20)
    expected, _ = spectral_tv.eigenpairs(spectral_tv.Mesh(vertices, triangles), 18)
    np.testing.assert_allclose(values, np.append([0.0, 0.0], expected), atol=1e-9)
    assert np.count_nonzero(np.abs(functions[-2:]) > 1e-12) == 2
    # Every triangle a component of its own.
    soup = vertices[triangles].reshape(-1, 3)
    with pytest.warns(spectral_tv.MeshWarning, match="the triangles are not joined"):
        mesh = spectral_tv.Mesh(soup, np.arange(len(soup)).reshape(-1, 3))
    split = spectral_tv.decompose(mesh, "lb", eigenpairs=len(triangles))
    means = soup.reshape(-1, 3, 3).mean(axis=1)
    np.testing.assert_allclose(split.residual, np.repeat(means, 3, axis=0), atol=1e-9)


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_low_pass_is_the_projection_and_all_pass_exact(shape):
    mesh = spectral_tv.Mesh(*shape)
    split = spectral_tv.decompose(mesh, "lb", eigenpairs=80)
    _, functions = spectral_tv.eigenpairs(mesh, 80)
    projection = functions @ (functions.T @ (mesh.vertex_areas[:, None] * mesh.vertices))
    low_pass = split.filter(lambda time: float(time > split.times[1]))
    np.testing.assert_allclose(low_pass, projection, atol=1e-8)
    np.testing.assert_allclose(split.filter(np.ones(31)), mesh.vertices, atol=1e-13)
    # A projection: once more changes nothing.
    twice = functions @ (functions.T @ (mesh.vertex_areas[:, None] * low_pass))
    np.testing.assert_allclose(twice, low_pass, atol=1e-8)


def test_components_at_the_eigenvalues_are_the_projections():
    """At the times 1/λ every component is what the eigenfunctions of this λ hold."""
    mesh = spectral_tv.Mesh(*SPHERE)
    values, functions = spectral_tv.eigenpairs(mesh, 30)
    nodes = 1 / values[:0:-1]
    times = [0.0, nodes[0] / 2, *nodes, 2 * nodes[-1]]
    split = spectral_tv.decompose(mesh, "lb", times=times, eigenpairs=30)
    held = functions.T @ (mesh.vertex_areas[:, None] * mesh.vertices)
    bands = split.bands(split.times[1:])
    for band, k in zip(bands[1:], range(29, 0, -1), strict=True):
        np.testing.assert_allclose(band, np.outer(functions[:, k], held[k]), atol=1e-9)
    np.testing.assert_allclose(bands[0], mesh.vertices - functions @ held, atol=1e-9)
    mean = np.average(mesh.vertices, axis=0, weights=mesh.vertex_areas)
    np.testing.assert_allclose(split.residual, np.tile(mean, (len(mesh.vertices), 1)), atol=1e-9)


def test_bands_by_ranges_of_eigenvalues_are_orthogonal():
    mesh = spectral_tv.Mesh(*SPHERE)
    values, functions = spectral_tv.eigenpairs(mesh, 40)
    # Cut in the widest gaps, with a step from one side of each to the other.
    gaps = 1 + np.argsort(np.diff(1 / values[1:]) / (1 / values[2:]))[:3]
    cuts = np.sort(1 / np.sqrt(values[gaps] * values[gaps + 1]))
    sides = np.sort(np.concatenate([1 / values[gaps], 1 / values[gaps + 1]]))
    times = [0.0, 0.5 / values[-1], *sides, 2 / values[1]]
    split = spectral_tv.decompose(mesh, "lb", times=times, eigenpairs=40)
    bands = split.bands([0.0, *cuts, np.inf])
    products = np.einsum("avc,v,bvc->ab", bands, mesh.vertex_areas, bands)
    between = (values > 1 / cuts[1]) & (values < 1 / cuts[0])
    assert between.any()
    held = functions.T @ (mesh.vertex_areas[:, None] * mesh.vertices)
    expected = functions[:, between] @ held[between]
    np.testing.assert_allclose(bands[1], expected, atol=1e-9)
    assert abs(products[1, 0]) < 1e-9 > abs(products[1, 2])


def test_scaling_and_turning_the_shape_does_the_same_to_its_bands():
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    vertices, triangles = SPHERE
    one = spectral_tv.decompose(spectral_tv.Mesh(vertices, triangles), "lb", eigenpairs=50)
    moved = spectral_tv.Mesh(3 * vertices @ turn + [1, 2, 3], triangles)
    other = spectral_tv.decompose(moved, "lb", eigenpairs=50)
    np.testing.assert_allclose(other.times, 9 * one.times, rtol=1e-9)
    bands = [split.bands(split.band_edges(4)) for split in (one, other)]
    np.testing.assert_allclose(bands[1], 3 * bands[0] @ turn, atol=1e-8)


def test_cancelling_ends_it():
    def stop(fraction):
        if fraction > 0:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        spectral_tv.eigenpairs(spectral_tv.Mesh(*icosphere(5)), 1000, progress=stop)
