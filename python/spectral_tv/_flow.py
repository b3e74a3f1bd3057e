"""Flows of functions and of shapes."""

from typing import Annotated, Literal, TypeAlias, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_tv import _native
from spectral_tv._native import Flow, Job, Mesh
from spectral_tv._options import DEFAULTS, Progress, Solver, StepOptions
from spectral_tv._work import starting, waiting

Operator: TypeAlias = (
    Annotated[Literal["tv"], "u_t ∈ −∂NETV(u) (Brokman et al. 2024, Eq. 20)."]
    | Annotated[Literal["heat"], "u_t = Δu (Eq. 12)."]
)
Elements: TypeAlias = Annotated[
    Annotated[
        Literal["vertices"],
        "continuous, with an unknown per vertex; better for smooth functions, but a set fades 2 to "
        "7 % too fast.",
    ]
    | Annotated[
        Literal["edges"],
        "Crouzeix–Raviart, with an unknown per edge; sets fade at their true rates. The steps are "
        "exact, and take two to three times as long.",
    ],
    "The elements that the function is made of while it flows. Default: `suiting_elements` of the "
    'values for a TV flow, unless the scheme is given as another than "exact"; else vertices.',
]


@waiting
def flow(
    mesh: Mesh,
    values: ArrayLike,
    times: ArrayLike,
    operator: Operator = "tv",
    exact: bool = False,
    progress: Progress | None = None,
    *,
    elements: Elements | None = None,
    **options: Unpack[StepOptions],
) -> Job[Flow]:
    """Flow a function on the mesh, in the metric of the mesh.

    Parameters
    ----------
    mesh : Mesh
    values : (V,) or (V, C) array
        The function f; the C channels of a TV flow are coupled.
    times : (N+1,) array
        Increasing, from 0. In the unit (of the values) × length for "tv", length² for others;
        both are length² where the values are lengths.
    {operator}
    exact : bool
        Whether every step is a proximal step, solved to the gap `tolerance`. Eigenfunctions then
        decay in a straight line down to extinction.
    {progress}
    {elements}
    {options}

    Returns
    -------
    Flow

    Raises
    ------
    MeshError
        If an argument is of the wrong shape, not finite, or out of range; says where.
    MemoryError
        If the work takes more than is available, before it starts.
    """
    if exact:
        options["scheme"] = "exact"
    return _native.start_flow(mesh, values, times, operator, elements, options)


start_flow = starting(flow)


@waiting
def conformal_flow(
    mesh: Mesh,
    time: float,
    steps: int = 10,
    progress: Progress | None = None,
    *,
    solver: Solver = DEFAULTS["solver"],
) -> Job[NDArray[np.float64]]:
    """Conformalized mean curvature flow (Kazhdan, Solomon and Ben-Chen 2012), neither rescaled nor
    recentred: the smooth base that M3 uses.

    Parameters
    ----------
    mesh : Mesh
    time : float
        How far to flow, length²; 5e-3 of the area swallows limbs.
    steps : int
        Number of equal steps.
    {progress}
    {solver}

    Returns
    -------
    (V, 3) array
        The smoothed positions.

    Raises
    ------
    MeshError
        If time or steps are not positive.
    """
    return _native.start_conformal_flow(mesh, time, steps, solver)
