"""Pieces of a mesh that no constraint holds."""

import numpy as np
import pytest
import spectral_tv
from scipy.spatial.distance import pdist
from scipy.spatial.transform import Rotation
from shapes import dumbbell, icosphere


@pytest.fixture(scope="module")
def scene():
    """A dumbbell with an eye on its upper ball and a loose vertex beside its lower one."""
    body, faces = dumbbell(n_around=24, n_along=48)
    eye, eye_faces = icosphere(1, 0.15)
    vertices = np.vstack(
        [body, eye + np.array([1.05, 0, body[:, 2].max() - 1]), [[1.2, 0, body[0, 2]]]]
    )
    vertices[-1] = [0, 0, body[:, 2].min() - 0.1]
    triangles = np.vstack([faces, eye_faces + len(body)])
    top = np.flatnonzero(body[:, 2] > 0.7)
    bottom = np.flatnonzero(body[:, 2] < -0.7)
    return spectral_tv.Mesh(vertices, triangles), vertices, bottom, top, len(body)


@pytest.mark.parametrize("algorithm", ["convex", "harmonic"])
def test_they_move_rigidly_with_the_nearest_surface(scene, algorithm):
    mesh, vertices, bottom, top, count = scene
    turn = Rotation.from_euler("xyz", [20, -10, 40], degrees=True).as_matrix()
    moved = vertices[top] @ turn.T + [0.5, 0, 0.3]
    result = spectral_tv.deform(
        mesh, np.r_[bottom, top], np.vstack([vertices[bottom], moved]), algorithm=algorithm
    )
    np.testing.assert_array_equal(result.unconstrained, np.arange(count, len(vertices)))
    np.testing.assert_allclose(result.vertices[-1], vertices[-1], atol=1e-12)
    eye = slice(count, -1)
    np.testing.assert_allclose(pdist(result.vertices[eye]), pdist(vertices[eye]), rtol=1e-9)
    np.testing.assert_allclose(
        result.vertices[eye], vertices[eye] @ turn.T + [0.5, 0, 0.3], atol=1e-6
    )


def test_they_come_along_where_everything_moves_alike(scene):
    mesh, vertices, bottom, _, _ = scene
    result = spectral_tv.deform(mesh, bottom, vertices[bottom] + [1, 2, 3])
    np.testing.assert_allclose(result.vertices, vertices + np.array([1, 2, 3]), atol=1e-12)
    assert result.total_variation == 0 and result.gap == 0


@pytest.mark.parametrize("stretch", [1.0, 2.5, 1e8])
def test_nothing_turns_them_about_a_line_of_nearest_points(stretch):
    # The nearest points all lie along x, which leaves the turn about it open.
    strip = np.array([[x, y, 0.0] for y in (0, 1) for x in range(5)])
    triangles = [[x, x + 1, x + 6] for x in range(4)] + [[x, x + 6, x + 5] for x in range(4)]
    piece = np.array([[0.0, -5, 0], [4, -5, 0], [2, -5, 0.1]])
    mesh = spectral_tv.Mesh(np.vstack([strip, piece]), [*triangles, [10, 11, 12]])
    ends = [0, 4, 5, 9]
    moved = strip[ends] * [stretch, 1, 1] + [0, 0, 3]
    result = spectral_tv.deform(mesh, ends, moved)
    middle = (result.vertices[[0, 2, 4]] - strip[[0, 2, 4]]).mean(axis=0)
    np.testing.assert_allclose(pdist(result.vertices[10:]), pdist(piece), rtol=1e-6)
    np.testing.assert_allclose(result.vertices[12], piece[2] + middle, rtol=1e-6)
