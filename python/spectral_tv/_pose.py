"""Posing a mesh."""

from numpy.typing import ArrayLike

from spectral_tv import _native
from spectral_tv._native import Job, Mesh
from spectral_tv._options import Progress
from spectral_tv._results import Pose
from spectral_tv._work import starting, waiting

JOINT_SOFTNESS: float = _native._POSING["joint_softness"]
STIFFNESS: float = _native._POSING["stiffness"]
STILLNESS: float = _native._POSING["stillness"]
TOLERANCE: float = _native._POSING["tolerance"]


@waiting
def pose(
    mesh: Mesh,
    indices: ArrayLike,
    targets: ArrayLike,
    weights: ArrayLike | None = None,
    bodies: ArrayLike | None = None,
    joint_softness: float = JOINT_SOFTNESS,
    stiffness: float = STIFFNESS,
    stillness: float = STILLNESS,
    tolerance: float = TOLERANCE,
    progress: Progress | None = None,
) -> Job[Pose]:
    """Move some vertices of a mesh, and have the surface follow in rigid pieces that turn, with
    joints at its bottlenecks: pull a hand, and the arm bends at the elbow.

    `deform` moves its pieces without turning them. This one minimizes the total variation of a
    field of rigid motions, one at each vertex, beside what moving away from rest costs. The energy
    is not convex: the pose is the stationary one that is found from rest. `Pose` says what its
    decrement proves.

    Parameters
    ----------
    mesh : Mesh
    indices : (K,) array of integers, or (V,) array of bools
        The constrained vertices, with those that stay where they are; or True for each of them.
    targets : (K, 3) array
        Where they go.
    weights : (K,) array, optional
        In (0, 1]: 1, the default, is an exact constraint; less is a spring. See `Deformer`.
    bodies : (K,) array of integers, optional
        −1, the default: the vertex goes to its target. Vertices with the same other number are one
        rigid body that turns freely: its centre, the mean of its vertices, goes to the mean of
        their targets. Soft ones are pulled along with it.
    joint_softness : float
        How wide and soft joints are, from 0 to 1e6; 0 folds them as sharply as the mesh allows.
    stiffness : float
        What turning costs, as a length relative to the diagonal of the bounding box, from 0 to 1e6.
    stillness : float
        What moving away from rest costs, from 0 to 1e6. With 0 the body leans after its limbs.
    tolerance : float
        Decrement to reach, in (0, 1).
    {progress}

    Returns
    -------
    Pose

    Raises
    ------
    MeshError
        If an argument is of the wrong shape, not finite, or out of range; if there are no
        constraints, two exact targets of a vertex differ, a vertex is in two bodies, or no vertex
        is left to move.
    MemoryError
        If the work takes more than is available, before it starts.
    """
    parameters = {
        "joint_softness": joint_softness,
        "stiffness": stiffness,
        "stillness": stillness,
    }
    return _native.start_pose(mesh, indices, targets, weights, bodies, parameters, tolerance)


start_pose = starting(pose)
