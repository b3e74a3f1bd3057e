"""Exaggerating several poses alike (caricature)."""

from collections.abc import Sequence
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from spectral_tv import _native
from spectral_tv._native import Job, Mesh
from spectral_tv._options import STEPS, Method, Progress, ShapeOptions
from spectral_tv._work import starting, waiting


@waiting
def caricature(
    meshes: Sequence[Mesh],
    band: tuple[float, float],
    gain: float = 2.0,
    smooth: float = 0.0,
    method: Method = "m3",
    steps: int = STEPS,
    keep_limbs: float = 0.0,
    progress: Progress | None = None,
    **options: Unpack[ShapeOptions],
) -> Job[list[NDArray[np.float64]]]:
    """Exaggerate one band of several shapes alike, and remove the finest detail (Brokman et al.
    2024, the figures of the armadillo).

    Each shape is decomposed by itself, over the method's default times. The times and the filter
    are relative to its area, so they are the same for all poses and sizes of one shape.

    Parameters
    ----------
    meshes : sequence of Mesh
        They need not have vertices or triangles in common.
    band : (float, float)
        Where the band begins and ends, t/area; see `default_scales`.
    gain : float
        What the band is multiplied by.
    smooth : float
        Detail that vanishes before this t/area, and is not in the band, is removed.
    {method}
    steps : int
        Number of steps of each flow.
    keep_limbs : float
        As in `Decomposition.bands`; 0: off.
    {progress}
    {options}

    Returns
    -------
    list of (V, 3) arrays
        The positions of each mesh.

    Raises
    ------
    MeshError
        If an argument is out of range.
    """
    asked = {"method": method, "steps": steps, **options}
    return _native.start_caricature(meshes, band, gain, smooth, keep_limbs, asked)


start_caricature = starting(caricature)
