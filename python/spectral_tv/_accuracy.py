"""Measuring how accurate bands are."""

from typing import Unpack

from numpy.typing import ArrayLike

from spectral_tv import _native
from spectral_tv._native import Job, Mesh
from spectral_tv._options import Progress, ShapeOptions, Stepped
from spectral_tv._results import Accuracy
from spectral_tv._work import starting, waiting


@waiting
def accuracy(
    mesh: Mesh,
    method: Stepped = "m1",
    steps: ArrayLike = (8, 16, 32),
    bands: int = 5,
    progress: Progress | None = None,
    *,
    scales: tuple[float, float] | None = None,
    refinement: int = 8,
    keep_limbs: float = 0.0,
    **options: Unpack[ShapeOptions],
) -> Job[Accuracy]:
    """Measure how the errors of a decomposition fall with the number of steps: of the all-pass
    filter, as in the paper's figure of the reconstruction error, and of the bands against a
    refined flow.

    The package's all-pass filter gives the shape back at any step, so its error says nothing about
    the flow. The error of the bands does.

    Parameters
    ----------
    mesh : Mesh
    {method}
    steps : (n,) array of integers
        The numbers of steps to compare, at least 2 each.
    bands : int
        Number of bands K.
    {progress}
    scales : (float, float), optional
        The finest and the largest scale, length²; see `graded_times`. Default: the method's.
    refinement : int
        How many times as many steps the refined flow has as the largest of `steps`; at least 2.
    keep_limbs : float
        As in `Decomposition.bands`; 0: off.
    {options}

    Returns
    -------
    Accuracy

    Raises
    ------
    MeshError
        If an argument is of the wrong shape or out of range, or the method takes no time steps.
    """
    asked = {"method": method, **options}
    return _native.start_accuracy(mesh, steps, bands, scales, refinement, keep_limbs, asked)


start_accuracy = starting(accuracy)
