"""How thick a shape is."""

import numpy as np
from numpy.typing import NDArray

from spectral_tv import _native
from spectral_tv._native import Job, Mesh
from spectral_tv._options import Progress
from spectral_tv._work import starting, waiting


@waiting
def thickness(
    mesh: Mesh, before: Mesh | None = None, progress: Progress | None = None
) -> Job[NDArray[np.float64]]:
    """How thick the shape is at each vertex: the radius of the largest inscribed ball that reaches
    it (the local thickness of Hildebrand and Rüegsegger 1997).

    A closed surface has the thickness of its solid. On sheets, and on closed shells of two wide
    layers, balls on either side count, so that a sleeve is as thick as an arm. It is measured once
    for a mesh.

    The balls at a vertex are others after the least motion, so what is measured flickers over the
    frames of an animation. With `before` it does not, and bands of
    `mesh.with_thickness(thickness(mesh, before))` keep limbs as those of the frame before do.

    Parameters
    ----------
    mesh : Mesh
    before : Mesh, optional
        The same shape a moment earlier, with the thickness that it had. Vertices that stay keep
        theirs. If the triangles are others, a vertex has that of the nearest point of `before`, by
        nine tenths, unless that is farther away than the shape is thick.
    {progress}

    Returns
    -------
    (N,) array
        Lengths; 0 in no triangle.

    Raises
    ------
    MemoryError
        If the work does not fit into what is available.
    """
    return _native.start_thickness(mesh, before)


start_thickness = starting(thickness)
