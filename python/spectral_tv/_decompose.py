"""Splitting a shape into bands."""

from typing import Literal, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_tv import _native
from spectral_tv._native import Decomposition, Job, Mesh
from spectral_tv._options import (
    DEFAULTS,
    METHODS,
    STEPS,
    DecomposeOptions,
    Method,
    Progress,
)
from spectral_tv._results import Estimate
from spectral_tv._work import spelled, starting, waiting


@waiting
def decompose(
    mesh: Mesh,
    method: Method = "m1",
    times: ArrayLike | None = None,
    steps: int = STEPS,
    progress: Progress | None = None,
    **options: Unpack[DecomposeOptions],
) -> Job[Decomposition]:
    """Split the shape of a mesh into scales.

    Parameters
    ----------
    mesh : Mesh
    {method}
    times : (N+1,) array, optional
        Increasing from 0, length². Default: `steps` times, evenly spaced at first and then in
        log t, between the method's `default_scales`: those of "m1" end at hands and feet, those
        of "m2" at whole limbs, those of "m3" at plates and muscles. For "lb" from half the last
        1/λ on. None for "displacement".
    steps : int
        The number of steps N, if no times are given.
    {progress}
    {options}

    Returns
    -------
    Decomposition

    Raises
    ------
    MeshError
        If an argument is of the wrong shape, not finite, or out of range; says where.
    MemoryError
        If the work takes more than is available, before it starts.
    """
    asked = {"method": method, "times": times, "steps": steps, **options}
    return _native.start_decompose(mesh, asked)


start_decompose = starting(decompose)


@spelled
def estimate(
    mesh: Mesh | int,
    method: Method = "m1",
    times: ArrayLike | None = None,
    steps: int = STEPS,
    **options: Unpack[DecomposeOptions],
) -> Estimate:
    """Estimate what `decompose` takes with the same arguments.

    `decompose` itself refuses work that does not fit. The first call of `estimate` times a small
    flow, for some hundredths of a second. If an accuracy decides on the steps, the estimate is for
    the first two flows, the least that it takes.

    Parameters
    ----------
    mesh : Mesh or int
        A mesh, or the number of vertices of one that has twice as many triangles.
    method, times, steps
        As `decompose` takes them.
    {options}

    Returns
    -------
    Estimate

    Raises
    ------
    MeshError
        If an argument cannot be read.
    """
    asked = {"method": method, "times": times, "steps": steps, **options}
    return _native.estimate(mesh, asked)


def default_base_time(base: Literal["limbs"] | None = None) -> float:
    """How far "m3" and "displacement" smooth their base where `base_time` is not given.

    Parameters
    ----------
    base : "limbs", optional
        As `decompose` takes it.

    Returns
    -------
    float
        t/area: features of the size ℓ vanish from the base at a time of the order of ℓ².

    Raises
    ------
    MeshError
        If there is no such base.
    """
    return _native.default_base_time({"method": "m3", "base": base})


def default_scales(
    method: Method,
    eigenpairs: int = DEFAULTS["eigenpairs"],
    base: Literal["limbs"] | None = None,
) -> tuple[float, float]:
    """The default scales of a method relative to the area: the time from which steps are spaced
    in log t, and the last time.

    Parameters
    ----------
    method : str
        As `decompose` takes it.
    eigenpairs : int
        Of a method that takes it: its finest scale is that of the last.
    base : "limbs", optional
        Of a method that takes it, as `decompose` does.

    Returns
    -------
    (float, float)
        t/area of the finest and the largest scale; see `graded_times`.

    Raises
    ------
    MeshError
        If there is no such method or base.
    """
    facts = METHODS.get(method)
    given = {"eigenpairs": eigenpairs, "base": base}
    own = {name: value for name, value in given.items() if facts and name in facts.options}
    return _native.default_scales({"method": method, **own})


def graded_times(finest: float, largest: float, steps: int = STEPS) -> NDArray[np.float64]:
    """Times for `decompose`: from 0, evenly spaced at first and from about `finest` on in log t.

    Parameters
    ----------
    finest, largest : float
        Times, length². Features of the size ℓ vanish at a time of the order of ℓ².
    steps : int
        Number of steps N.

    Returns
    -------
    (N+1,) array

    Raises
    ------
    MeshError
        If steps is 0 or 0 < finest < largest does not hold.
    """
    return _native.graded_times(finest, largest, steps)
