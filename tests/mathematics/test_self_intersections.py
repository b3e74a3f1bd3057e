"""Faces that cross, against exact rational arithmetic and on shapes of which it is known."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import spectral_tv
from nasty_meshes import corpus
from reference_guard import cross
from shapes import icosphere, torus

pytestmark = pytest.mark.filterwarnings("ignore::spectral_tv.MeshWarning")

PAIRS = 1500


def exact(points):
    return [[Fraction(float(x)) for x in point] for point in points]


def found_of_pairs(pairs):
    """Whether each pair of triangles (n, 2, 3, 3) crosses, all of them in one mesh."""
    apart = 100.0 * np.arange(len(pairs))[:, np.newaxis, np.newaxis, np.newaxis] * [1, 0, 0]
    vertices = (pairs + apart).reshape(-1, 3)
    mesh = spectral_tv.Mesh(vertices, np.arange(len(vertices)).reshape(-1, 3))
    crossing = np.isin(np.arange(2 * len(pairs)), spectral_tv.self_intersections(mesh))
    one, other = crossing.reshape(-1, 2).T
    np.testing.assert_array_equal(one, other)
    return one


@pytest.mark.parametrize("shared", [0, 1, 2, 3])
@pytest.mark.parametrize("is_flat", [False, True])
def test_pairs_on_a_lattice_cross_by_definition(shared, is_flat):
    """On few places, so that corners on edges, edges on faces and common planes abound."""
    rng = np.random.default_rng(shared)
    pairs = rng.integers(-2, 3, (PAIRS, 2, 3, 3)).astype(float)
    pairs[..., 2] *= not is_flat
    pairs[:, 1, :shared] = pairs[:, 0, :shared][:, ::-1]
    expected = [cross(exact(one), exact(other)) for one, other in pairs]
    assert 0 < sum(expected) < PAIRS
    np.testing.assert_array_equal(found_of_pairs(pairs), expected)


def test_a_hair_decides():
    """A corner that is above a face, on it, and below it by the last digit."""
    face = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    heights = [1e-16, 1e-300, 0.0, -1e-300, -1e-16]
    pairs = np.array([[face, [[0.3, 0.3, z], [5, 5, 1], [5, 4, 1]]] for z in heights])
    assert found_of_pairs(pairs).tolist() == [False, False, True, True, True]
    # The plane x + y + z = 1, which no number that is near 1/3 is on exactly.
    face = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    third = 1 / 3
    near = [np.nextafter(third, way) for way in (0, 1)]
    pairs = np.array([[face, [[x, third, third], [5, 5, 1], [5, 4, 1]]] for x in (third, *near)])
    shifted = 100.0 * np.arange(3)[:, np.newaxis, np.newaxis, np.newaxis] * [1, 0, 0] + pairs
    expected = [cross(exact(one), exact(other)) for one, other in shifted]
    assert found_of_pairs(pairs).tolist() == expected


@pytest.mark.parametrize("name", corpus())
def test_bad_meshes_cross_by_definition(name):
    vertices, triangles = corpus()[name]
    mesh = spectral_tv.Mesh(vertices, triangles)
    lower, upper = vertices[triangles].min(axis=1), vertices[triangles].max(axis=1)
    corners = [exact(vertices[triangle]) for triangle in triangles]
    crossing = set()
    for face in range(len(triangles)):
        meets = ((lower[face + 1 :] <= upper[face]) & (upper[face + 1 :] >= lower[face])).all(1)
        for other in face + 1 + np.flatnonzero(meets):
            if cross(corners[face], corners[other]):
                crossing |= {face, int(other)}
    np.testing.assert_array_equal(spectral_tv.self_intersections(mesh), sorted(crossing))


def test_two_spheres_cross_in_a_ring():
    sphere, triangles = icosphere(3)
    vertices = np.vstack([sphere, 0.8 * sphere + [1.0, 0.02, 0.01]])
    mesh = spectral_tv.Mesh(vertices, np.vstack([triangles, triangles + len(sphere)]))
    found = spectral_tv.self_intersections(mesh)
    # The circle is where x² − (x − 1)² = 1 − 0.64: all of the faces are near it.
    x = vertices[mesh.triangles[found], 0].mean(axis=1)
    assert len(found) > 40
    assert np.abs(x - 0.68).max() < 0.1
    apart = np.where(np.arange(len(vertices)) < len(sphere), 0.0, 1.5)[:, np.newaxis] * [1, 0, 0]
    assert len(spectral_tv.self_intersections(mesh, apart)) == 0
    np.testing.assert_array_equal(spectral_tv.self_intersections(mesh, 0 * apart), found)


def test_neighbours_do_not_cross():
    for vertices, triangles in (icosphere(4), torus(2.0, 0.7, 90, 40)):
        mesh = spectral_tv.Mesh(vertices, triangles)
        assert len(spectral_tv.self_intersections(mesh)) == 0
        # Nor where they are not joined.
        soup = spectral_tv.Mesh(
            vertices[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3)
        )
        assert len(spectral_tv.self_intersections(soup)) == 0


@pytest.mark.parametrize("size", [2.0**-200, 1e-9, 3.0, 2.0**150])
def test_sizes_and_distances_make_no_difference(size):
    vertices, triangles = torus(1.0, 0.7, 40, 16)
    mesh = spectral_tv.Mesh(vertices, triangles)
    squeeze = -1.2 * vertices * [1, 0, 0] * (vertices[:, :1] > 0)
    expected = spectral_tv.self_intersections(mesh, squeeze)
    assert len(expected) > 0
    scaled = spectral_tv.Mesh(size * vertices, triangles)
    np.testing.assert_array_equal(spectral_tv.self_intersections(scaled, size * squeeze), expected)
