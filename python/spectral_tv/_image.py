"""Splitting an image into bands."""

from typing import Annotated, Literal, TypeAlias, Unpack

from numpy.typing import ArrayLike

from spectral_tv import _native
from spectral_tv._native import Flow, Job
from spectral_tv._options import STEPS, Progress, StepOptions
from spectral_tv._work import starting, waiting

Metric: TypeAlias = (
    Annotated[Literal["flat"], "the plane's, which is spectral TV of images."]
    | Annotated[
        Literal["surface"],
        "that of the image's graph (x, y, s f), which is spectral ATV (Brokman et al. 2024, "
        "Sec. 9.3): on it steep places have more area and change more slowly, so that strong "
        "detail outlasts faint detail by more.",
    ]
)


@waiting
def decompose_image(
    image: ArrayLike,
    metric: Metric = "flat",
    times: ArrayLike | None = None,
    steps: int = STEPS,
    progress: Progress | None = None,
    *,
    height: float = 32.0,
    **options: Unpack[StepOptions],
) -> Job[Flow]:
    """Split an image into bands by spectral TV, all channels together.

    The total variation of a cell of pixels is the mean over its four corners of √(dx² + dy²). So
    turning or mirroring the image changes nothing. Lengths are in pixels.

    Parameters
    ----------
    image : (H, W) or (H, W, C) array of numbers
        Row by row, in any unit and encoding; the values are taken as they are. The C channels are
        coupled; to keep colors, decompose the luminance and add what it changes to all channels.
    {metric}
    times : (N+1,) array, optional
        Increasing from 0, value × pixel. In the plane a disc of the radius r that stands out by h
        is gone at t = h r/2. Default: `steps` times, evenly spaced at first and then in log t.
        They go from the time at which a spot a tenth of a pixel wide is gone, to the time at
        which one a quarter of the shorter side wide is gone. Both spots stand out by the image's
        whole contrast.
    steps : int
        The number of steps N, where no times are given.
    {progress}
    height : float
        How high the graph of "surface" is from the least to the greatest value, in pixels.
    {options}

    Returns
    -------
    Flow
        Its `states` are (N+1, H, W, C), its `bands` (K, H, W, C), its `residual` and what `filter`
        returns (H, W, C); without C where the image is (H, W).

    Raises
    ------
    MeshError, MemoryError
        As `flow` does.
    """
    return _native.start_decompose_image(image, metric, times, steps, height, options)


start_decompose_image = starting(decompose_image)
