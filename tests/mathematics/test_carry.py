"""spectral_tv.carry: what is bound to a surface follows it, and stays outside."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from nearby import body
from scipy.spatial.transform import Rotation
from shapes import icosphere


def enclosed(points: np.ndarray, vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Which points a closed surface goes around, by its solid angle (Van Oosterom and Strackee)."""
    inside = np.empty(len(points), dtype=bool)
    for number, point in enumerate(points):
        a, b, c = np.moveaxis(vertices[triangles] - point, 1, 0)
        la, lb, lc = (np.linalg.norm(each, axis=1) for each in (a, b, c))
        above = np.einsum("ij,ij->i", a, np.cross(b, c))
        below = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
        inside[number] = abs(np.arctan2(above, below).sum()) > np.pi
    return inside


@pytest.fixture(scope="module")
def dressed():
    """A body with its bands, and a tight shirt of other vertices on part of it."""
    vertices, triangles = body(60, 30)
    mesh = spectral_tv.Mesh(vertices, triangles)
    split = spectral_tv.decompose(mesh, steps=12)
    bands = split.bands(split.band_edges(4))
    shirt, faces = body(32, 16, twist=0.1)
    sides = shirt[faces]
    normals = np.zeros(shirt.shape)
    across = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    for corner in faces.T:
        np.add.at(normals, corner, across)
    shirt = shirt + 0.012 * normals / np.linalg.norm(normals, axis=1, keepdims=True)
    shirt = shirt[(shirt[:, 0] > -0.3) & ~enclosed(shirt, vertices, triangles)]
    return mesh, bands, shirt


def test_nothing_outside_goes_inside_at_gains_up_to_one(dressed):
    mesh, bands, shirt = dressed
    carried = spectral_tv.carry(mesh, bands, shirt)
    assert not carried.inside.any()
    rng = np.random.default_rng(2)
    bare = 0
    for gains in [np.ones(4), np.eye(4)[3], *rng.uniform(0, 1, size=(2, 4))]:
        look = mesh.vertices + np.tensordot(gains, bands, 1)
        points = shirt + np.tensordot(gains, carried.displacements, 1)
        assert not enclosed(points, look, mesh.triangles).any()
        bare += enclosed(shirt, look, mesh.triangles).sum()
    assert bare > 20  # where it does not follow


def test_a_rigid_motion_takes_all_along_rigidly():
    vertices, triangles = icosphere(3)
    turn = Rotation.from_euler("xyz", [0.3, 0.2, -0.5])
    moved = turn.apply(vertices) + np.array([1, 2, 3]) - vertices
    points = 1.3 * icosphere(2)[0]
    carried = spectral_tv.carry(spectral_tv.Mesh(vertices, triangles), [moved], points)
    wanted = turn.apply(points) + np.array([1, 2, 3])
    np.testing.assert_allclose(points + carried.displacements[0], wanted, atol=2e-4)
    assert not carried.pushed.any()


def test_what_is_inside_stays_free_to_move():
    """Teeth and eyes are not pushed out."""
    vertices, triangles = icosphere(3)
    points = 0.8 * icosphere(1)[0]
    carried = spectral_tv.carry(spectral_tv.Mesh(vertices, triangles), [-0.5 * vertices], points)
    np.testing.assert_allclose(carried.displacements[0], -0.5 * points / 0.8, atol=0.02)
    assert not carried.pushed.any() and not carried.inside.any()


def test_what_makes_no_sense_is_refused():
    mesh = spectral_tv.Mesh(*icosphere(1))
    with pytest.raises(spectral_tv.MeshError, match="displacements must be finite"):
        spectral_tv.carry(mesh, np.zeros((1, 3, 3)), np.zeros((1, 3)))
    with pytest.raises(spectral_tv.MeshError, match="points must be finite"):
        spectral_tv.carry(mesh, np.zeros((1, 42, 3)), np.full((1, 3), np.nan))
