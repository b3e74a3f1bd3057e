"""The paper's semi-implicit steps in SciPy: what one would write without this library.

The gradient and the solver's analysis are computed once, and a step takes one factorization. The
plain version computes its matrix as a product of matrices. The careful versions map face weights to
the entries of the matrix; the map is computed once.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.sparse as sp

from .direct import Cholmod, Direct, Pardiso
from .operators import face_normals, gradient_and_areas, hats_and_areas, to_vertices

SMOOTHING = 1e-3
AREA_FLOOR, WEIGHT_FLOOR = 1e-8, 1e-4
BASE_TIME, BASE_STEPS = 5e-3, 10


# Who does the steps: with which solver, and whether matrices are products.
WAYS: dict[str, tuple[type[Direct], bool]] = {
    "plain": (Cholmod, True),
    "careful": (Cholmod, False),
    "pardiso": (Pardiso, False),
}


def lagged_steps(
    vertices: np.ndarray,
    triangles: np.ndarray,
    times: np.ndarray,
    method: str,
    who: str,
    lengths: np.ndarray | None = None,
) -> np.ndarray:
    """Run M1, M2 or M3, its base included.

    Parameters
    ----------
    vertices : (V, 3) array
    triangles : (F, 3) array of integers
    times : (N+1,) array, increasing from 0, length²
    method : "m1", "m2" or "m3"
    who : of `WAYS`
    lengths : (V,) array, optional
        What M3 begins with instead of the distances from its base, which is made all the same.

    Returns
    -------
    (N+1, V, 3) array of shapes, or (N+1, V) of the distances from M3's base
    """
    solver_type, plain = WAYS[who]
    solver = Steps(vertices, triangles, solver_type(), plain=plain)
    if method == "m2":
        return collected(solver.conformal(times, p=3), vertices, times)
    values = vertices
    if method == "m3":
        base_times = np.linspace(0, BASE_TIME * solver.areas.sum(), BASE_STEPS + 1)
        *_, base = solver.conformal(base_times, p=2)
        own = distances(vertices, triangles, base)
        values = own if lengths is None else lengths
    return collected(solver.total_variation(values, times), values, times)


def collected(flow: Iterator[np.ndarray], values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """All states of a flow from `values` in one array, without a second copy of them."""
    states = np.empty((len(times), *values.shape))
    for place, state in zip(states, flow, strict=True):
        place[...] = state
    return states


class Steps:
    """Flows on one mesh."""

    def __init__(
        self, vertices: np.ndarray, triangles: np.ndarray, solver: Direct, *, plain: bool
    ) -> None:
        """Work out what all steps share."""
        self.solver, self.plain = solver, plain
        self.vertices, self.triangles = vertices, triangles
        self.gradient, self.areas = gradient_and_areas(vertices, triangles)
        self.masses = to_vertices(triangles, self.areas / 3, len(vertices))
        self.masses[self.masses == 0] = self.masses.mean()
        if not plain:
            self.system, self.entries, self.diagonal = self._pattern()

    def total_variation(self, values: np.ndarray, times: np.ndarray) -> Iterator[np.ndarray]:
        """Yield the states of NETV from values (V,) or (V, 3) (Brokman et al., Eqs. 49, 57)."""
        epsilon = SMOOTHING * (self.areas @ self._norms(values)) / self.areas.sum()
        yield values
        for dt in np.diff(times):
            weights = 1 / np.hypot(self._norms(values), epsilon)
            values = self._step(self.masses, dt * weights, values)
            yield values

    def conformal(self, times: np.ndarray, p: int) -> Iterator[np.ndarray]:
        """Yield shapes (V, 3) of the conformalized P-Laplace flow (Eq. 56)."""
        shape = self.vertices
        yield shape
        for dt in np.diff(times):
            areas = np.linalg.norm(face_normals(shape, self.triangles), axis=1) / 2
            masses = to_vertices(self.triangles, areas / 3, len(shape))
            masses = np.maximum(masses, AREA_FLOOR * self.masses)
            weights = np.ones(len(areas))
            if p == 3:
                weights = np.maximum(self._norms(shape), WEIGHT_FLOOR)
            shape = self._step(masses, dt * weights, shape)
            yield shape

    def _norms(self, values: np.ndarray) -> np.ndarray:
        gradients = (self.gradient @ values).reshape(len(self.areas), -1)
        return np.linalg.norm(gradients, axis=1)

    def _step(self, masses: np.ndarray, weights: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Solve (M + L(w)) u⁺ = M u."""
        if self.plain:
            weighting = sp.diags_array(np.repeat(self.areas * weights, 3))
            stiffness = self.gradient.T @ weighting @ self.gradient
            self.system = sp.csc_matrix(sp.diags_array(masses) + stiffness)
        else:
            self.system.data = self.entries @ weights
            self.system.data[self.diagonal] += masses
        return self.solver.solve(self.system, (masses * values.T).T)

    def _pattern(self) -> tuple[sp.csc_matrix, sp.csr_array, np.ndarray]:
        """The matrix, what turns weights (F,) into its entries, and where its diagonal is."""
        count, faces = len(self.vertices), len(self.areas)
        rows = np.repeat(self.triangles, 3, axis=1).ravel()
        columns = np.tile(self.triangles, (1, 3)).ravel()
        keys, place = np.unique(columns.astype(np.int64) * count + rows, return_inverse=True)
        starts = np.searchsorted(keys, np.arange(count + 1) * count)
        shape = (count, count)
        pattern = (np.zeros(len(keys)), (keys % count).astype(np.int32), starts.astype(np.int32))
        hats, areas = hats_and_areas(self.vertices, self.triangles)
        stiffness = np.einsum("fix,fjx,f->fij", hats, hats, areas)
        entries = (stiffness.ravel(), (place.ravel(), np.repeat(np.arange(faces), 9)))
        diagonal = np.searchsorted(keys, np.arange(count) * (count + 1))
        return (
            sp.csc_matrix(pattern, shape=shape),
            sp.csr_array(entries, shape=(len(keys), faces)),
            diagonal,
        )


def distances(vertices: np.ndarray, triangles: np.ndarray, base: np.ndarray) -> np.ndarray:
    """M3's distances from its base (V,), positive on the side to which the base's normal points."""
    normals = np.zeros_like(base)
    of_faces = face_normals(base, triangles)
    for axis in range(3):
        normals[:, axis] = to_vertices(triangles, of_faces[:, axis], len(base))
    offset = vertices - base
    outside = np.einsum("vx,vx->v", offset, normals) >= 0
    return np.where(outside, 1, -1) * np.linalg.norm(offset, axis=1)
