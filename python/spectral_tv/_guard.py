"""What a displacement does to the faces of a mesh, and how much of it is safe."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_tv import _native
from spectral_tv._native import Job, Mesh
from spectral_tv._options import Progress
from spectral_tv._results import Folds, SafeDisplacement
from spectral_tv._work import starting, waiting

#: How many times its length an edge may become, where nothing else is asked for.
STRETCH: float = _native._STRETCH


def folds(mesh: Mesh, displacement: ArrayLike, stretch: float = STRETCH) -> Folds:
    """Find the faces that fold or stretch where the vertices of a mesh move.

    A face folds where its normal turns by over 90° against the mesh as it is. It is stretched where
    an edge becomes longer than the limit allows; edges may become shorter. Takes some nanoseconds a
    face, so that it can follow a slider: the displacement of several bands is
    ``np.tensordot(gains, bands, 1)``.

    A face that is lower than 1e-5 of its longest edge, such as one with no area, has no normal that
    counts, and cannot fold. An edge that is shorter than that counts as if it were so long. A face
    that repeats an index, or is no larger than a point, takes no part.

    Parameters
    ----------
    mesh : Mesh
        The shape that the displacement starts from.
    displacement : (V, 3) array
        By what each vertex moves, a length.
    stretch : float
        How many times its length an edge may become; above 1.

    Returns
    -------
    Folds

    Raises
    ------
    MeshError
        If the displacement is not of this mesh or not finite, or stretch is not above 1.
    """
    return _native.folds(mesh, displacement, stretch)


@waiting
def safe_displacement(
    mesh: Mesh,
    displacement: ArrayLike,
    stretch: float = STRETCH,
    progress: Progress | None = None,
) -> Job[SafeDisplacement]:
    """Clamp a displacement where it would fold or stretch faces.

    Each vertex keeps a share of its displacement. Where a face nearly folds, or an edge reaches the
    limit, its corners keep less; from there the share rises to 1 along the edges, over 0.03 of the
    root of the area. `folds` of the result, with the same limit, finds a safe gain of at least 1.

    It is for what exaggerates a shape: bands at gains above 0. It is of no use for what smooths
    one, such as bands at a gain of −1: clamped parts of what is taken away stay as shreds. It does
    not keep distant parts from meeting; `self_intersections` tells where they do.

    Parameters
    ----------
    mesh : Mesh
        The shape that the displacement starts from.
    displacement : (V, 3) array
        By what each vertex is to move, a length.
    stretch : float
        How many times its length an edge may become; above 1.
    progress : callable, optional
        Called with the fraction done; an exception it raises ends the work.

    Returns
    -------
    SafeDisplacement

    Raises
    ------
    MeshError
        If the displacement is not of this mesh or not finite, or stretch is not above 1.
    MemoryError
        If the work takes more than is available, before it starts.
    """
    return _native.start_safe_displacement(mesh, displacement, stretch)


start_safe_displacement = starting(safe_displacement)


@waiting
def self_intersections(
    mesh: Mesh, displacement: ArrayLike | None = None, progress: Progress | None = None
) -> Job[NDArray[np.int64]]:
    """Find the faces of a mesh that cross other faces of it.

    Two faces cross if a point inside one is in the other, inside it or on its border. So those do
    not count that merely touch at their borders: neighbours, faces whose corners lie at the same
    places without being joined, and faces whose edges lie on one another. Faces that share a corner
    or an edge count if they meet beyond it, and so do faces that lie on one another. A face with no
    area crosses nothing. It is decided by exact arithmetic, without any tolerance.

    Parameters
    ----------
    mesh : Mesh
    displacement : (V, 3) array, optional
        By what each vertex moves before, a length.
    progress : callable, optional
        Called with the fraction done; an exception it raises ends the work.

    Returns
    -------
    (K,) int64 array
        The faces, in order.

    Raises
    ------
    MeshError
        If the displacement is not of this mesh or not finite.
    MemoryError
        If the work takes more than is available, before it starts.
    """
    return _native.start_self_intersections(mesh, displacement)


start_self_intersections = starting(self_intersections)
