"""A proximal step of TV by accelerated primal–dual iteration, as Fumero et al. 2020 take it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, eigsh

CHECK = 20
MOST_ITERATIONS = 20_000


class PrimalDual:
    """Chambolle and Pock 2011, Algorithm 2, on one mesh; what steps share is worked out once."""

    def __init__(
        self,
        gradient: sp.csr_array,
        areas: np.ndarray,
        mass: sp.csr_array,
        solve: Callable[[np.ndarray], np.ndarray],
    ) -> None:
        """Take G (3F, N), the face areas, the mass matrix M (N, N), and M⁻¹."""
        self.gradient, self.areas, self.mass, self.solve = gradient, areas, mass, solve
        self.adjoint = (gradient.T @ sp.diags_array(np.repeat(areas, 3))).tocsr()
        inverse = LinearOperator(mass.shape, matvec=solve, dtype=float)
        laplacian = self.adjoint @ gradient
        (self.largest,) = 1.01 * eigsh(
            laplacian, k=1, M=mass, Minv=inverse, tol=1e-2, return_eigenvectors=False
        )

    def step(self, data: np.ndarray, tau: float, tolerance: float) -> tuple[np.ndarray, float, int]:
        """argmin ½‖u − û‖²_M + τ TV(u) for `data` û (N,).

        Returns u, the duality gap relative to τ TV(û), and the number of iterations.
        """
        scale = tau * self.variation(data)
        primal = dual = 1 / (tau * np.sqrt(self.largest))
        state = overshot = data
        field = np.zeros(3 * len(self.areas))
        for iteration in range(1, MOST_ITERATIONS + 1):
            field = _clipped(field + dual * tau * (self.gradient @ overshot))
            divergence = self.solve(tau * (self.adjoint @ field))
            last, state = state, (state - primal * divergence + primal * data) / (1 + primal)
            momentum = 1 / np.sqrt(1 + 2 * primal)
            primal, dual = momentum * primal, dual / momentum
            overshot = state + momentum * (state - last)
            if iteration % CHECK == 0:
                gap = self._gap(state, data, tau, field) / scale
                if gap <= tolerance:
                    break
        return state, gap, iteration

    def variation(self, values: np.ndarray) -> float:
        """TV of values (N,)."""
        return float(self.areas @ np.linalg.norm((self.gradient @ values).reshape(-1, 3), axis=1))

    def _gap(self, state: np.ndarray, data: np.ndarray, tau: float, field: np.ndarray) -> float:
        off = state - data + self.solve(tau * (self.adjoint @ field))
        aligned = float((self.adjoint @ field) @ state)
        return 0.5 * float(off @ (self.mass @ off)) + tau * (self.variation(state) - aligned)


def _clipped(field: np.ndarray) -> np.ndarray:
    vectors = field.reshape(-1, 3)
    norms = np.linalg.norm(vectors, axis=1, keepdims=True)
    return (vectors / np.maximum(norms, 1)).ravel()
