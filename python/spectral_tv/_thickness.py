"""How thick a shape is."""

import numpy as np
from numpy.typing import NDArray

from spectral_tv import _native
from spectral_tv._native import Job, Mesh
from spectral_tv._options import Progress
from spectral_tv._work import starting, waiting


@waiting
def thickness(mesh: Mesh, progress: Progress | None = None) -> Job[NDArray[np.float64]]:
    """How thick the shape is at each vertex: the radius of the largest inscribed ball that reaches
    it (the local thickness of Hildebrand and Rüegsegger 1997).

    A closed surface has the thickness of its solid. On sheets, and on closed shells of two wide
    layers, balls on either side count, so that a sleeve is as thick as an arm. It is measured once
    for a mesh.

    Parameters
    ----------
    mesh : Mesh
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
    return _native.start_thickness(mesh)


start_thickness = starting(thickness)
