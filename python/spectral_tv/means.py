"""Means of values that come together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from spectral_tv.later import np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def means(
    places: NDArray[np.int64],
    values: NDArray[np.float64],
    count: int,
    weights: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """The means (count, C) of values (N, C), each at one of the places (N,); 0 where none is.

    ``weights`` (N,) are equal if not given.
    """
    weights = np.ones(len(places)) if weights is None else weights
    total = np.bincount(places, weights, count)
    sums = [np.bincount(places, weights * channel, count) for channel in values.T]
    found: NDArray[np.float64] = np.column_stack(sums)
    return found / np.where(total > 0, total, 1)[:, np.newaxis]
