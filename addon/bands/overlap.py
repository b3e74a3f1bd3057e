"""Which components of a flow lie in which bands, of the same flow or of another one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

# Edges are kept in single precision.
ROUNDING = 1e-6


@dataclass(frozen=True)
class Overlap:
    """How many components new bands (J,) share with old ones (I,): ``counts`` (J, I).

    ``sizes`` (J,) are the numbers of components of the new ones, also of those in no old band.
    """

    counts: np.ndarray
    sizes: np.ndarray

    @classmethod
    def of(
        cls,
        old: Sequence[tuple[float, float]],
        new: Sequence[tuple[float, float]],
        times: np.ndarray,
    ) -> Overlap:
        """That of bands between two times each; ``times`` (N,) are those of the components."""
        before, after = (_members(bands, times).astype(int) for bands in (old, new))
        return cls(after @ before.T, after.sum(axis=1))

    @property
    def parts(self) -> np.ndarray:
        """Which part of every new band lies in every old one, (J, I)."""
        return self.counts / np.maximum(self.sizes, 1)[:, np.newaxis]

    def successor(self, old: int) -> int | None:
        """The new band that holds most of an old one."""
        column = self.counts[:, old]
        return int(column.argmax()) if column.any() else None

    def equal(self, new: int) -> int | None:
        """The old band that holds just the components of a new one, if there is one."""
        row = self.counts[new]
        old = int(row.argmax())
        is_all = row[old] == self.sizes[new] == self.counts[:, old].sum() > 0
        return old if is_all else None


def _members(bands: Sequence[tuple[float, float]], times: np.ndarray) -> np.ndarray:
    """Which components each band holds, (K, N)."""
    starts = np.array([start for start, _ in bands]) * (1 - ROUNDING)
    band = np.searchsorted(starts, times, side="right") - 1
    inside = times < bands[-1][1] * (1 + ROUNDING)
    return (band == np.arange(len(bands))[:, np.newaxis]) & inside


def aligned(
    edges: Sequence[float], others: Sequence[float], times: Sequence[np.ndarray]
) -> list[float]:
    """Edges of bands, each in the place of the one of ``others`` that means the same.

    ``times`` are those of the components of both flows. An edge lies somewhere between two
    components. So two edges mean the same if one flow has at most one component between them, and
    no other edge is nearer.
    """
    found = list(edges)
    own, wanted = np.log(edges[1:]), np.log(others[1:])  # the first of both is 0
    apart = np.abs(own[:, np.newaxis] - wanted)
    for place, row in enumerate(apart, start=1):
        nearest = int(row.argmin())
        between = sorted((edges[place], others[nearest + 1]))
        few = min(((each > between[0]) & (each < between[1])).sum() for each in times) <= 1
        if few and int(apart[:, nearest].argmin()) == place - 1:
            found[place] = others[nearest + 1]
    return found


def overlap_of_flows(
    edges: Sequence[float], others: Sequence[float], times: Sequence[np.ndarray]
) -> Overlap:
    """The overlap of new bands, between ``others``, with those of another flow, between ``edges``.

    ``times`` are those of the components of the former flow and of the new one.
    """
    if len(edges) == len(others) == 2:  # all there is, whatever the sizes
        return Overlap(np.ones((1, 1), dtype=int), np.ones(1, dtype=int))
    old = pairwise(aligned(edges, others, times))
    return Overlap.of([*old], [*pairwise(others)], times[1])
