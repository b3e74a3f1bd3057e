"""libigl's as-rigid-as-possible deformation."""

from __future__ import annotations

import igl
import numpy as np

# Iterations that are made at a time while it is looked whether they still change something.
AT_A_TIME = 10
MOST_ITERATIONS = 10_000


class Arap:
    """A mesh whose constrained vertices are moved; it goes on from its last shape."""

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray, indices: np.ndarray) -> None:
        """Take vertices (V, 3), triangles (F, 3), and what vertices (K,) are constrained."""
        self.rest, self.shape = vertices, vertices
        self.triangles, self.indices = triangles.astype(np.int64), indices.astype(np.int32)
        self.diagonal = np.linalg.norm(np.ptp(vertices, axis=0))
        self.data = igl.ARAPData()

    def prepare(self) -> None:
        """Factorize, and go back to rest."""
        self.data = igl.ARAPData()
        self.data.energy = igl.ARAP_ENERGY_TYPE_SPOKES_AND_RIMS
        igl.arap_precomputation(self.rest, self.triangles, 3, self.indices, self.data)
        self.shape = self.rest

    def iterate(self, targets: np.ndarray, iterations: int) -> None:
        """Go on for some iterations."""
        self.data.max_iter = iterations
        self.shape = igl.arap_solve(targets, self.data, self.shape)

    def settle(self, targets: np.ndarray, movement: float) -> int:
        """Go on until ten iterations move no vertex by more than that part of the diagonal.

        Returns the number of iterations.
        """
        for count in range(AT_A_TIME, MOST_ITERATIONS + 1, AT_A_TIME):
            before = self.shape
            self.iterate(targets, AT_A_TIME)
            if np.linalg.norm(self.shape - before, axis=1).max() <= movement * self.diagonal:
                return count
        raise RuntimeError(f"still moving after {MOST_ITERATIONS} iterations")
