"""What a rig found in a pose is."""

import numpy as np
import pytest
import spectral_tv
from scipy.spatial.transform import Rotation
from shapes import dumbbell

BEND = Rotation.from_rotvec([np.radians(60), 0, 0])


@pytest.fixture(scope="module")
def bent():
    vertices, triangles = dumbbell()
    mesh = spectral_tv.Mesh(vertices, triangles)
    ends = [vertices[:, 2] < -0.6, vertices[:, 2] > 0.6]
    handles = [np.flatnonzero(end) for end in ends]
    targets = np.vstack([vertices[handles[0]], BEND.apply(vertices[handles[1]])])
    posed = spectral_tv.pose(mesh, np.concatenate(handles), targets)
    return mesh, posed, spectral_tv.rig(mesh, posed)


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
    turned = Rotation.from_quat(np.roll(rig.rotations, -1, axis=1))
    moved = [
        turn.apply(mesh.vertices) + shift
        for turn, shift in zip(turned, rig.translations, strict=True)
    ]
    skinned = np.einsum("vp,pvi->vi", rig.weights, np.array(moved))
    size = np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    np.testing.assert_allclose(skinned, posed.vertices, atol=0.05 * size)


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
