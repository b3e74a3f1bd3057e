"""What a rig found in a pose is."""

import numpy as np
import pytest
import spectral_tv
from scipy.spatial.transform import Rotation
from shapes import dumbbell, icosphere

BEND = Rotation.from_rotvec([np.radians(60), 0, 0])


@pytest.fixture(scope="module")
def straight():
    return spectral_tv.Mesh(*dumbbell())


@pytest.fixture(scope="module")
def bent(straight):
    posed = bend(straight, BEND)
    return straight, posed, spectral_tv.rig(straight, posed)


def bend(mesh, turn):
    """The pose of a dumbbell whose upper ball is turned about the middle."""
    vertices = mesh.vertices
    handles = [np.flatnonzero(vertices[:, 2] * side > 0.6) for side in (-1, 1)]
    targets = np.vstack([vertices[handles[0]], turn.apply(vertices[handles[1]])])
    return spectral_tv.pose(mesh, np.concatenate(handles), targets)


def carried(mesh, rig):
    """Where the weights of a rig carry a mesh."""
    turned = Rotation.from_quat(np.roll(rig.rotations, -1, axis=1))
    moved = [
        turn.apply(mesh.vertices) + shift
        for turn, shift in zip(turned, rig.translations, strict=True)
    ]
    return np.einsum("vp,pvi->vi", rig.weights, np.array(moved))


def test_a_bent_dumbbell_is_two_bones_with_a_joint_in_the_neck(bent):
    mesh, _, rig = bent
    assert len(rig.parents) == 2
    root = int(np.flatnonzero(rig.parents == -1)[0])
    arm = 1 - root
    assert rig.parents[arm] == root
    size = np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    np.testing.assert_allclose(rig.heads[arm], 0, atol=0.05 * size)
    assert rig.tails[arm][2] > 0.6
    turned = Rotation.from_quat(np.roll(rig.rotations[arm], -1))
    assert (turned * BEND.inv()).magnitude() < np.radians(2)


def test_its_weights_carry_the_mesh_to_its_pose(bent):
    mesh, posed, rig = bent
    np.testing.assert_allclose(rig.weights.sum(axis=1), 1, atol=1e-12)
    assert (rig.weights >= 0).all()
    inside = rig.labels >= 0
    assert (rig.weights[inside, rig.labels[inside]] == 1).all()
    size = np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    np.testing.assert_allclose(carried(mesh, rig), posed.vertices, atol=0.05 * size)


@pytest.mark.parametrize("degrees", [5, 10, 15, 30, 90])
def test_weak_bends_have_joints_too(straight, degrees):
    turn = Rotation.from_rotvec([np.radians(degrees), 0, 0])
    posed = bend(straight, turn)
    rig = spectral_tv.rig(straight, posed)
    assert sorted(rig.parents) in ([-1, 0], [-1, 1])
    size = np.linalg.norm(np.ptp(straight.vertices, axis=0))
    np.testing.assert_allclose(carried(straight, rig), posed.vertices, atol=0.03 * size)
    root, arm = np.argsort(rig.parents)
    np.testing.assert_allclose(rig.heads[arm], 0, atol=0.05 * size)
    halves = straight.vertices[:, 2] * [[-1], [1]] > 0.6
    assert {*rig.labels[halves[0]]} | {*rig.labels[halves[1]]} == {root, arm}


def test_a_neck_that_bends_along_all_of_its_length_parts_its_ends(straight):
    """The faces beside the axis that it bends about are hardly strained, and join nothing."""
    z = straight.vertices[:, 2]
    pinned, pulled = np.flatnonzero(z < -0.9), np.flatnonzero(z > 1.8)
    handles = np.concatenate([pinned, pulled])
    targets = straight.vertices[handles]
    targets[len(pinned) :, 0] += 1
    bodies = np.repeat([-1, 0], [len(pinned), len(pulled)])
    posed = spectral_tv.pose(straight, handles, targets, bodies=bodies)
    rig = spectral_tv.rig(straight, posed)
    assert len(rig.parents) == 2
    assert rig.labels[pinned[0]] != rig.labels[pulled[0]]
    size = np.linalg.norm(np.ptp(straight.vertices, axis=0))
    np.testing.assert_allclose(carried(straight, rig), posed.vertices, atol=0.03 * size)


@pytest.mark.parametrize("radius", [0.03, 0.3])
def test_parts_that_are_not_connected_are_of_the_piece_that_moves_alike(straight, radius):
    """Small ones too, such as eyes in a head."""
    vertices, triangles = icosphere(2)
    count = len(straight.vertices)
    mesh = spectral_tv.Mesh(
        np.vstack([straight.vertices, radius * vertices + [0, 0, 1.4]]),
        np.vstack([straight.triangles, triangles + count]),
    )
    rig = spectral_tv.rig(mesh, bend(mesh, BEND))
    assert len(rig.parents) == 2
    (eye,) = np.unique(rig.labels[count:])
    assert eye == rig.labels[np.argmax(straight.vertices[:, 2])]
    assert (rig.weights[count:, eye] == 1).all()
    still = spectral_tv.rig(mesh, bend(mesh, Rotation.identity()))
    np.testing.assert_array_equal(still.parents, [-1])


def test_a_rigid_motion_is_one_bone_and_other_meshes_are_refused(bent):
    mesh, _, _ = bent
    everywhere = np.arange(0, len(mesh.vertices), 3)
    posed = spectral_tv.pose(mesh, everywhere, BEND.apply(mesh.vertices[everywhere]))
    rig = spectral_tv.rig(mesh, posed)
    np.testing.assert_array_equal(rig.parents, [-1])
    np.testing.assert_array_equal(rig.labels, 0)
    other = spectral_tv.Mesh(mesh.vertices[:3], [[0, 1, 2]])
    with pytest.raises(spectral_tv.MeshError, match="displacement must be 3 finite numbers"):
        spectral_tv.rig(other, posed)
