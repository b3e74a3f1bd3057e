"""Finding a rig in a pose."""

from spectral_tv import _native
from spectral_tv._native import Job, Mesh
from spectral_tv._options import Progress
from spectral_tv._results import Pose, Rig
from spectral_tv._work import starting, waiting


@waiting
def rig(mesh: Mesh, posed: Pose, progress: Progress | None = None) -> Job[Rig]:
    """Find the pieces of a pose that move rigidly, and the joints between them.

    A face is of a piece if it is hardly strained and hardly turns, measured against the largest
    bend of the pose: weak bends have joints too. Two pieces that touch are one unless they turn
    against one another by 5° or more. Pieces smaller than 0.4 % of the area count as joints. A pose
    that does not bend is one piece. Parts that are not connected are of one piece where they move
    alike; small ones are of the piece that moves most like them. The piece that moves least is the
    root. Weights are harmonic in joints.

    Parameters
    ----------
    mesh : Mesh
        The mesh that was posed.
    posed : Pose
    {progress}

    Returns
    -------
    Rig

    Raises
    ------
    MeshError
        If the pose is one of another mesh.
    MemoryError
        If the work takes more than is available, before it starts.
    """
    return _native.start_rig(mesh, posed.vertices, posed.rotations)


start_rig = starting(rig)
