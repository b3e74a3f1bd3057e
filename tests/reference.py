"""The method in plain NumPy and SciPy, written to be read: what the fast library is compared with.

Conventions: V vertices, F triangles, C channels, N time steps. Functions are piecewise linear,
one value per vertex, of shape (V,) or (V, C). Equation numbers are those of Brokman et al. 2024,
"Spectral Total-Variation Processing of Shapes". Triangles must have positive area, and every
vertex must belong to one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh, splu

Array = NDArray[np.float64]
Triangles = NDArray[np.int64]

AREA_FLOOR = 1e-8
WEIGHT_FLOOR = 1e-4


class Operators:
    """Gradient, areas and weighted Laplacians of a triangle mesh, all in its initial metric.

    Attributes: gradient, sparse (3F, V), whose rows 3f, 3f + 1, 3f + 2 are x, y, z of the gradient
    on face f; face_areas (F,); vertex_areas (V,), a third of the areas of the faces around.
    """

    def __init__(self, vertices: Array, triangles: Triangles) -> None:
        self.face_areas = face_areas(vertices, triangles)
        self.vertex_areas = vertex_areas(vertices, triangles)
        self.gradient = _gradient(vertices, triangles)

    def laplacian(self, weights: Array) -> sp.csc_array:
        """L(w) = G^T diag(A w) G, sparse (V, V), for weights (F,): minus the weighted divergence.

        The weak form of the p-Laplacian of Brokman et al. 2024, Eq. 11.
        """
        face_weights = sp.diags_array(np.repeat(self.face_areas * weights, 3))
        return (self.gradient.T @ face_weights @ self.gradient).tocsc()

    def gradient_norm(self, u: Array) -> Array:
        """|grad u| on each face, (F,): the norm over all channels of u together."""
        return np.linalg.norm(self.face_gradients(u), axis=(1, 2))

    def face_gradients(self, u: Array) -> Array:
        """The gradient of each channel of u on each face, (F, 3, C)."""
        return (self.gradient @ u).reshape(len(self.face_areas), 3, -1)

    def solve(self, masses: Array, weights: Array, right_hand_side: Array) -> Array:
        """Solve (diag(masses) + L(weights)) u = right_hand_side."""
        return splu(sp.diags_array(masses, format="csc") + self.laplacian(weights)).solve(
            right_hand_side
        )


def face_areas(vertices: Array, triangles: Triangles) -> Array:
    """Triangle areas, (F,)."""
    return np.linalg.norm(_double_area_normals(vertices, triangles), axis=1) / 2.0


def vertex_areas(vertices: Array, triangles: Triangles) -> Array:
    """Lumped (barycentric) vertex areas, (V,)."""
    thirds = np.repeat(face_areas(vertices, triangles) / 3.0, 3)
    return np.bincount(triangles.ravel(), thirds, len(vertices)).astype(np.float64)


def vertex_normals(vertices: Array, triangles: Triangles) -> Array:
    """Unit normals, (V, 3): the mean of the normals of the faces around, weighted by area."""
    normals = np.zeros_like(vertices)
    for corner in triangles.T:
        np.add.at(normals, corner, _double_area_normals(vertices, triangles))
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def total_variation(ops: Operators, u: Array) -> float:
    """TV(u) = sum over faces of A |grad u| (Brokman et al. 2024, Eq. 13, for smooth u)."""
    return float(ops.face_areas @ ops.gradient_norm(u))


def semi_implicit_flow(
    ops: Operators, f: Array, times: Array, epsilon: float, kind: Literal["heat", "tv"]
) -> Array:
    """States (N + 1, V[, C]) of u_t = -p(u) at the times (N + 1,), the weights lagging a step.

    Each step solves (M + dt L(w)) u_next = M u, with w = 1 for "heat" and
    w = 1 / sqrt(|grad u|^2 + epsilon^2) for "tv" (Brokman et al. 2024, Eqs. 49 and 54, or 57 for
    a scalar f): all channels share the weights.
    """
    states = [f]
    for dt in np.diff(times):
        u = states[-1]
        weights = _tv_weights(ops, u, epsilon) if kind == "tv" else np.ones_like(ops.face_areas)
        states.append(ops.solve(ops.vertex_areas, dt * weights, _times(ops.vertex_areas, u)))
    return np.array(states)


def bdf2_extrapolated_flow(ops: Operators, f: Array, times: Array, epsilon: float) -> Array:
    """States (N + 1, V[, C]) of the TV flow (Brokman et al. 2024, Eq. 49) by variable-step BDF2.

    The weights are taken at the extrapolated state u + r (u - u_previous), r = dt / dt_previous.
    The first step is a lagged backward Euler step.
    """
    states = list(semi_implicit_flow(ops, f, times[:2], epsilon, "tv"))
    for k in range(1, len(times) - 1):
        ratio = (times[k + 1] - times[k]) / (times[k] - times[k - 1])
        extrapolated = states[k] + ratio * (states[k] - states[k - 1])
        weights = _tv_weights(ops, extrapolated, epsilon)
        states.append(_bdf2_step(ops, states[k - 1], states[k], times[k - 1 : k + 2], weights))
    return np.array(states)


def conformal_flow(
    vertices: Array,
    triangles: Triangles,
    times: Array,
    p: float,
    area_floor: float = AREA_FLOOR,
    weight_floor: float = WEIGHT_FLOOR,
) -> Array:
    """Shapes (N + 1, V, 3) of the conformalized P-Laplace flow, with lagged weights and areas.

    Each step solves (M_t + dt L(w)) u_next = M_t u with M_t the vertex areas of the current shape,
    w = |grad u|^(p - 2), and the gradient of the initial metric: p = 3 is Brokman et al. 2024,
    Eq. 56; p = 2 is the conformalized mean curvature flow of Kazhdan et al. 2012. Areas and
    weights are kept above the given fractions of the initial ones.
    """
    ops = Operators(vertices, triangles)
    least_areas = area_floor * ops.vertex_areas
    least_weights = weight_floor * ops.gradient_norm(vertices) ** (p - 2.0)
    shapes = [vertices]
    for dt in np.diff(times):
        shape = shapes[-1]
        areas = np.maximum(vertex_areas(shape, triangles), least_areas)
        weights = np.maximum(ops.gradient_norm(shape) ** (p - 2.0), least_weights)
        shapes.append(ops.solve(areas, dt * weights, _times(areas, shape)))
    return np.array(shapes)


def proximal_step(
    ops: Operators, f: Array, tau: float, tolerance: float, max_iterations: int = 100_000
) -> tuple[Array, float]:
    """Minimise 1/2 |u - f|_M^2 + tau TV(u); return u, of f's shape, and its relative gap.

    An exact implicit step of length tau of the TV flow (Brokman et al. 2024, Eq. 20), by the
    accelerated primal-dual iteration of Chambolle & Pock 2011, Algorithm 2, on the saddle point
    of 1/2 |u - f|_M^2 + tau <z, grad u>_A over all z with |z| <= 1 on each face. The gap is
    relative to tau TV(f), and 0 where TV(f) is 0.
    """
    scale = tau * total_variation(ops, f)
    if scale == 0.0:
        return f.copy(), 0.0
    dual_step = primal_step = 1.0 / (tau * np.sqrt(_largest_eigenvalue(ops)))
    u = overshot = f
    z = np.zeros_like(ops.face_gradients(f))
    for iteration in range(1, max_iterations + 1):
        z = _project_to_unit_balls(z + dual_step * tau * ops.face_gradients(overshot))
        slope = tau * _codifferential(ops, z, f.shape)
        previous, u = u, (u - primal_step * slope + primal_step * f) / (1.0 + primal_step)
        momentum = 1.0 / np.sqrt(1.0 + 2.0 * primal_step)
        primal_step, dual_step = momentum * primal_step, dual_step / momentum
        overshot = u + momentum * (u - previous)
        if iteration % 20 == 0:
            gap = _proximal_gap(ops, f, tau, u, z) / scale
            if gap <= tolerance:
                return u, gap
    raise RuntimeError(f"gap {gap:.1e} after {max_iterations} iterations")


def spectral_transform(times: Array, states: Array) -> tuple[Array, Array]:
    """Components phi (N - 1, V[, C]) at times 1 ... N - 1, and the residual (V[, C]).

    The discrete phi = t u_tt (Brokman et al. 2024, Eq. 50): the velocities p are the difference
    quotients between states, phi_k = t_k (p_{k-1} - p_k), and the residual is u_N + t_N p_{N-1};
    their sum is states[0] for any states and times, with times[0] = 0.
    """
    t = times.reshape((-1,) + (1,) * (states.ndim - 1))
    velocities = (states[:-1] - states[1:]) / np.diff(t, axis=0)
    phi = t[1:-1] * (velocities[:-1] - velocities[1:])
    return phi, states[-1] + t[-1] * velocities[-1]


def filtered(
    times: Array, phi: Array, residual: Array, response: Callable[[Array], Array]
) -> Array:
    """sum over k of H(t_k) phi_k + residual, (V[, C]) (Brokman et al. 2024, Eq. 53)."""
    return np.tensordot(response(times[1:-1]), phi, axes=1) + residual


def band(times: Array, phi: Array, lower: float, upper: float) -> Array:
    """Sum of the components with lower <= t_k < upper, (V[, C]) (Eq. 53, without residual)."""
    inside = (lower <= times[1:-1]) & (times[1:-1] < upper)
    return phi[inside].sum(axis=0)


def spectrum(ops: Operators, phi: Array) -> Array:
    """S(t_k) = sum over vertices of M |phi_k|, (N - 1,): the L1 norm of Eq. 50's components."""
    magnitude = np.abs(phi) if phi.ndim == 2 else np.linalg.norm(phi, axis=2)
    return magnitude @ ops.vertex_areas


def directional(vertices: Array, triangles: Triangles, base: Array) -> tuple[Array, Array]:
    """Height f (V,) over a smooth base (V, 3) and unit directions d (V, 3); vertices = base + f d.

    f = a |S - base| and d = a (S - base) / |S - base|, with the sign a such that d points to the
    outside of the base (Brokman et al. 2024, section on directional shape TV, before Eq. 57).
    Where S and the base coincide d is the base's normal.
    """
    normals = vertex_normals(base, triangles)
    offset = vertices - base
    distance = np.linalg.norm(offset, axis=1)
    sign = np.where(np.sum(offset * normals, axis=1) < 0.0, -1.0, 1.0)
    direction = normals.copy()
    apart = distance > 0.0
    direction[apart] = (sign / np.where(apart, distance, 1.0))[apart, None] * offset[apart]
    return sign * distance, direction


def _double_area_normals(vertices: Array, triangles: Triangles) -> Array:
    a, b, c = (vertices[corner] for corner in triangles.T)
    return np.cross(b - a, c - a)


def _gradient(vertices: Array, triangles: Triangles) -> sp.csr_array:
    """On a face with unit normal n, the hat function of a corner has gradient n x e / 2A, e being
    the opposite edge, counter-clockwise."""
    double_normals = _double_area_normals(vertices, triangles)
    double_areas = np.linalg.norm(double_normals, axis=1, keepdims=True)
    rows = np.arange(3 * len(triangles)).reshape(-1, 3)
    shape = (3 * len(triangles), len(vertices))
    gradient = sp.csr_array(shape)
    for corner in range(3):
        start, end = triangles[:, (corner + 1) % 3], triangles[:, (corner + 2) % 3]
        hats = np.cross(double_normals, vertices[end] - vertices[start]) / double_areas**2
        columns = np.repeat(triangles[:, corner], 3)
        gradient += sp.csr_array((hats.ravel(), (rows.ravel(), columns)), shape=shape)
    return gradient


def _times(weights: Array, u: Array) -> Array:
    """weights (V,) times u (V,) or (V, C), vertex by vertex."""
    return (weights * u.T).T


def _tv_weights(ops: Operators, u: Array, epsilon: float) -> Array:
    return 1.0 / np.sqrt(ops.gradient_norm(u) ** 2 + epsilon**2)


def _bdf2_step(ops: Operators, oldest: Array, old: Array, times: Array, weights: Array) -> Array:
    """One step to times[2] from the states at times[0] and times[1].

    u_t at times[2] is the derivative of the parabola through the three states; its coefficients
    are the derivatives of the three Lagrange polynomials there.
    """
    t0, t1, t2 = times
    oldest_coefficient = (t2 - t1) / ((t0 - t1) * (t0 - t2))
    old_coefficient = (t2 - t0) / ((t1 - t0) * (t1 - t2))
    new_coefficient = 1.0 / (t2 - t0) + 1.0 / (t2 - t1)
    known = -(oldest_coefficient * oldest + old_coefficient * old)
    return ops.solve(new_coefficient * ops.vertex_areas, weights, _times(ops.vertex_areas, known))


def _codifferential(ops: Operators, z: Array, shape: tuple[int, ...]) -> Array:
    """M^-1 G^T A z of face vectors z (F, 3, C): minus the divergence, of the given shape."""
    weighted = (ops.face_areas[:, None, None] * z).reshape(ops.gradient.shape[0], -1)
    return _times(1.0 / ops.vertex_areas, ops.gradient.T @ weighted).reshape(shape)


def _project_to_unit_balls(z: Array) -> Array:
    return z / np.maximum(1.0, np.linalg.norm(z, axis=(1, 2), keepdims=True))


def _largest_eigenvalue(ops: Operators) -> float:
    """A bound just above the largest eigenvalue of M^-1 L(1)."""
    scaling = sp.diags_array(ops.vertex_areas**-0.5)
    symmetric = scaling @ ops.laplacian(np.ones_like(ops.face_areas)) @ scaling
    start = np.ones(len(ops.vertex_areas)) + np.cos(np.arange(len(ops.vertex_areas)))
    (largest,) = eigsh(symmetric, k=1, tol=1e-3, v0=start, return_eigenvectors=False)
    return 1.01 * float(largest)


def _proximal_gap(ops: Operators, f: Array, tau: float, u: Array, z: Array) -> float:
    """Primal energy of u less dual energy of z: |u - u_z|_M^2 / 2 + tau (TV(u) - <z, grad u>_A),
    u_z being f less tau times the codifferential of z."""
    from_dual = f - tau * _codifferential(ops, z, f.shape)
    distance = np.sum(_times(ops.vertex_areas, (u - from_dual) ** 2)) / 2.0
    aligned = ops.face_areas @ np.sum(z * ops.face_gradients(u), axis=(1, 2))
    return float(distance + tau * (total_variation(ops, u) - aligned))
