"""Eigensets of total variation, and eigenpairs of the Laplace–Beltrami operator."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_tv import _native
from spectral_tv._native import Job, Mesh
from spectral_tv._options import Progress
from spectral_tv._results import EigensetTest
from spectral_tv._work import starting, waiting


@waiting
def eigenset_test(
    mesh: Mesh,
    members: ArrayLike,
    progress: Progress | None = None,
    *,
    elements: Literal["vertices", "edges"] = "edges",
) -> Job[EigensetTest]:
    """Test whether a set of vertices is an eigenset of NETV.

    The indicator of an eigenset is, up to a constant, an eigenfunction. It fades in a straight line
    (Brokman et al. 2024). Three things are tested:

    - Under the exact flow the function keeps one value on the set and one off it.
    - The value on the set falls in a straight line, at the rate λ = per/area.
    - No superset has a smaller perimeter, relative to the area outside it. Only samples of
      supersets are tried, so a set that passes may still have such a superset.

    Parameters
    ----------
    mesh : Mesh
        Components wholly in the set or wholly outside are left out.
    members : (V,) array of bools or of floats, or (K,) array of integers
        The set: True or 0.5 and more for its vertices; or their indices, each once. Integers that
        are 0 or 1 at every vertex are taken as truth values.
    {progress}
    elements : str
        Those of the flow, see `flow`. On "vertices" it takes less time and memory, and rates are
        2 to 7 % too high. Perimeters are those of functions on edges in any case.

    Returns
    -------
    EigensetTest

    Raises
    ------
    MeshError
        If the members are not of this mesh, or name one vertex twice, or the set has no boundary.
    """
    return _native.start_eigenset_test(mesh, members, elements)


start_eigenset_test = starting(eigenset_test)


@waiting
def eigenpairs(
    mesh: Mesh, count: int, progress: Progress | None = None
) -> Job[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """The lowest eigenpairs of the Laplace–Beltrami operator, L u = λ M u with linear elements and
    lumped masses, by block Lanczos iteration on the inverse.

    Parameters
    ----------
    mesh : Mesh
    count : int
        Number of eigenpairs K; V if the mesh has no more. The time grows with the square of K,
        and memory holds about 2 K functions.
    {progress}

    Returns
    -------
    (K,) array
        The eigenvalues λ, rising from 0, 1/length². 0 comes once for each component of the mesh.
    (V, K) array
        The eigenfunctions, 1/length; Uᵀ diag(mesh.vertex_areas) U = 1 (a vertex in no triangle
        counts with the mean area).

    Raises
    ------
    MeshError
        If count is 0.
    MemoryError
        If the work takes more than is available, before it starts.
    """
    return _native.start_eigenpairs(mesh, count)
