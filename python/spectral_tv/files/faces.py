"""Faces of a file that no surface can have."""

import numpy as np
from numpy.typing import NDArray

from spectral_tv.dataclass import dataclass


@dataclass(frozen=True)
class Faces:
    """The faces of a file: how many corners each has, and the vertices of all corners, from 0.

    ``count`` tells how many vertices there are; other numbers refer to none.
    """

    sizes: NDArray[np.int64]
    corners: NDArray[np.int64]
    count: int

    def are_outside(self) -> NDArray[np.bool_]:
        """Which faces (F,) refer to a vertex that is not there."""
        owner = np.repeat(np.arange(len(self.sizes)), self.sizes)
        found = np.zeros(len(self.sizes), dtype=bool)
        found[owner[(self.corners < 0) | (self.corners >= self.count)]] = True
        return found

    def only(self, wanted: NDArray[np.bool_]) -> "Faces":
        """Some of the faces."""
        return Faces(self.sizes[wanted], self.corners[np.repeat(wanted, self.sizes)], self.count)

    def faults(self) -> list[str]:
        """What is wrong with how many of them, as the user reads it; faces count from 0."""
        total = len(self.sizes)
        owner = np.repeat(np.arange(total), self.sizes)
        outside = self.are_outside()
        small = (self.sizes < 3) & ~outside
        order = np.lexsort((self.corners, owner))  # each face by itself, its corners in order
        inner = self.corners[order]
        repeated = np.zeros(total, dtype=bool)
        repeated[owner[1:][(owner[1:] == owner[:-1]) & (inner[1:] == inner[:-1])]] = True
        repeated &= ~outside & ~small
        told = []
        for bad, what in (
            (outside, "to a vertex that is not there"),
            (small, "fewer than 3 corners"),
            (repeated, "a vertex twice"),
            (self._doubles(inner, outside | small | repeated), "the vertices of another face"),
        ):
            if bad.any():
                number = int(bad.sum())
                verb = ("refers" if number == 1 else "refer") if bad is outside else "has"
                verb = "have" if verb == "has" and number > 1 else verb
                told.append(f"{number} {verb} {what} (the first is face {bad.argmax()})")
        return told

    def _doubles(self, inner: NDArray[np.int64], bad: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Which faces have the vertices of one before them; those of ``bad`` are not compared."""
        found = np.zeros(len(self.sizes), dtype=bool)
        starts = np.cumsum(self.sizes) - self.sizes
        for size in np.unique(self.sizes[~bad]):
            mine = np.flatnonzero((self.sizes == size) & ~bad)
            rows = inner[starts[mine][:, np.newaxis] + np.arange(size)]
            order = np.lexsort((mine, *rows.T))
            same = (rows[order][1:] == rows[order][:-1]).all(axis=1)
            found[mine[order[1:][same]]] = True
        return found
