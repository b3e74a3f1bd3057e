"""Direct solvers that a user of Python can install; those that can analyse a pattern once."""

from __future__ import annotations

import os
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu


class Direct(Protocol):
    """Solves systems with symmetric positive definite matrices of one pattern."""

    def solve(self, system: sp.csc_matrix, right: np.ndarray) -> np.ndarray:
        """Solve for (V,) or (V, C) right sides."""


class SuperLU:
    """SciPy's own solver, in its mode for symmetric matrices."""

    def solve(self, system: sp.csc_matrix, right: np.ndarray) -> np.ndarray:
        """Factorize and solve."""
        ordering = "MMD_AT_PLUS_A"
        options = {"SymmetricMode": True}
        factor = splu(system, permc_spec=ordering, diag_pivot_thresh=0.0, options=options)
        return factor.solve(right)


class Cholmod:
    """CHOLMOD, supernodal, by scikit-sparse; its threads are those of the BLAS."""

    def __init__(self) -> None:
        """Begin without an analysis."""
        from sksparse.cholmod import analyze  # noqa: PLC0415 - loads a BLAS

        self._analyze, self._factor = analyze, None

    def solve(self, system: sp.csc_matrix, right: np.ndarray) -> np.ndarray:
        """Factorize and solve."""
        self._factor = self._factor or self._analyze(system)
        self._factor.cholesky_inplace(system)
        return self._factor(right)


class Pardiso:
    """MKL's Pardiso by pypardiso, on all processors."""

    ANALYSIS, FACTORIZATION, SOLUTION = 11, 22, 33
    # Of MKL's settings, by their numbers from 1: they are given here; nested dissection by threads;
    # factorization by threads at two levels.
    SETTINGS = ((1, 1), (2, 3), (24, 1))
    POSITIVE_DEFINITE = 2

    def __init__(self) -> None:
        """Begin without an analysis."""
        # MKL's own choice is a thread for two logical processors.
        os.environ.setdefault("MKL_NUM_THREADS", str(os.cpu_count()))
        from pypardiso import PyPardisoSolver  # noqa: PLC0415 - loads MKL

        self._solver = PyPardisoSolver(mtype=self.POSITIVE_DEFINITE)
        for number, value in self.SETTINGS:
            self._solver.iparm[number - 1] = value
        self._upper: np.ndarray | None = None

    def solve(self, system: sp.csc_matrix, right: np.ndarray) -> np.ndarray:
        """Factorize and solve."""
        right = np.asfortranarray(right)
        if self._upper is None:
            # The columns of a symmetric matrix are its rows.
            rows = np.repeat(np.arange(system.shape[0]), np.diff(system.indptr))
            self._upper = system.indices >= rows
            starts = np.append(0, np.cumsum(self._upper))[system.indptr]
            parts = (system.data[self._upper], system.indices[self._upper], starts)
            self._matrix = sp.csr_matrix(parts, shape=system.shape)
            self._do(self.ANALYSIS, right)
        else:
            self._matrix.data = system.data[self._upper]
        self._do(self.FACTORIZATION, right)
        return self._do(self.SOLUTION, right)

    # Nothing public of it keeps the analysis.
    def _do(self, phase: int, right: np.ndarray) -> np.ndarray:
        self._solver.set_phase(phase)
        return self._solver._call_pardiso(self._matrix, right)
