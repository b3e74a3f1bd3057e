"""Deforming a mesh."""

from typing import Literal

from numpy.typing import ArrayLike

from spectral_tv import _native
from spectral_tv._native import Job, Mesh
from spectral_tv._options import Progress
from spectral_tv._results import Deformation
from spectral_tv._work import starting, waiting

Algorithm = Literal["convex", "paper", "harmonic", "biharmonic", "arap"]


@waiting
def deform(
    mesh: Mesh,
    indices: ArrayLike,
    targets: ArrayLike,
    weights: ArrayLike | None = None,
    softness: float = 0.0,
    tolerance: float = 1e-3,
    algorithm: Algorithm = "convex",
    progress: Progress | None = None,
) -> Job[Deformation]:
    """Move some vertices of a mesh, and have the surface follow in rigid pieces, the stretch going
    to its bottlenecks: the displacement of least total variation (Brokman et al. 2024, section
    "Shape Deformation").

    Parameters
    ----------
    mesh : Mesh
    indices : (K,) array of integers, or (V,) array of bools
        The constrained vertices, with those that stay where they are; or True for each of them.
    targets : (K, 3) array
        Where they go.
    weights : (K,) array, optional
        In (0, 1]: 1, the default, is an exact constraint; less is a spring. See `Deformer`.
    softness : float
        Width of the stretched zone, a length; for "convex" only.
    tolerance : float
        Relative duality gap to reach, in (0, 1). "paper" and "arap" end where no vertex moves by
        more than this part of the movement.
    algorithm : {"convex", "paper", "harmonic", "biharmonic", "arap"}
        "convex": the problem itself, by primal-dual Newton. "paper": Algorithm 1 of Brokman et al.
        The others minimise something else, for comparison.
    progress : callable, optional
        Called with the fraction done; an exception it raises ends the work.

    Returns
    -------
    Deformation

    Raises
    ------
    MeshError
        If an argument is of the wrong shape, not finite, or out of range; if there are no
        constraints, two exact targets of a vertex differ, or no vertex is left to move.
    MemoryError
        If the work takes more than is available, before it starts.
    """
    return _native.start_deform(mesh, indices, targets, weights, softness, tolerance, algorithm)


start_deform = starting(deform)
