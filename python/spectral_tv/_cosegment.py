"""Labelling the same parts of several shapes (co-segmentation)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from spectral_tv import _native
from spectral_tv._native import Decomposition, Job
from spectral_tv._options import Progress
from spectral_tv._work import starting, waiting


@waiting
def cosegment(
    decompositions: Sequence[Decomposition],
    segments: int = 6,
    seed: int = 0,
    progress: Progress | None = None,
) -> Job[list[NDArray[np.int64]]]:
    """Label the parts of one shape in several poses, or of several shapes, alike.

    K-means of the vertices' spectra under the earth mover's distance, over all shapes together
    (Brokman et al. 2024, figure "co-segmentation").

    Parameters
    ----------
    decompositions : sequence of Decomposition
        Best of method "m2". The shapes need not have vertices or triangles in common.
    segments : int
        Number of labels.
    seed : int
        Of the random starts.
    {progress}

    Returns
    -------
    list of (V,) int64 arrays
        Labels from 0, the largest segment, one array per decomposition.

    Raises
    ------
    MeshError
        If there are no decompositions, or segments is 0 or larger than the number of vertices.
    """
    return _native.start_cosegment(decompositions, segments, seed)


start_cosegment = starting(cosegment)
