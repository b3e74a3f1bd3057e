"""Deforming a mesh."""

from typing import Annotated, Literal, TypeAlias

from numpy.typing import ArrayLike

from spectral_tv import _native
from spectral_tv._native import Job, Mesh
from spectral_tv._options import Progress
from spectral_tv._results import Deformation
from spectral_tv._work import starting, waiting

Algorithm: TypeAlias = (
    Annotated[Literal["convex"], "the problem itself, by primal-dual Newton."]
    | Annotated[Literal["paper"], "Algorithm 1 of Brokman et al."]
    | Annotated[Literal["harmonic"], "least ∫|∇d|² in its place, for comparison."]
    | Annotated[Literal["biharmonic"], "least ∫|Δd|², for comparison."]
    | Annotated[Literal["arap"], "as rigid as possible (Sorkine and Alexa 2007), for comparison."]
)


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
    {algorithm}
    {progress}

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
