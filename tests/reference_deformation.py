"""Deformation in plain NumPy and SciPy, written to be read: what the fast library is compared with.

Conventions as in the module reference; K constraints. What is sought is always the displacement
d = S' - S, of shape (V, 3). Equation numbers, and Algorithm 1, are those of Brokman et al. 2024,
"Spectral Total-Variation Processing of Shapes", section "Shape Deformation".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from reference import Array, Operators, Triangles, total_variation
from scipy.sparse.linalg import splu

SPRING_PATCH = 0.01


@dataclass(frozen=True)
class Handles:
    """What is asked of a displacement, vertex by vertex.

    Attributes: fixed (V,), whether the displacement is given; asked (V, 3), the displacements c,
    0 where there is no constraint; springs (V,), the kappa of the penalty
    1/2 sum kappa |d - c|^2, 0 without a soft constraint; spread, how far apart the displacements
    asked for are.
    """

    fixed: NDArray[np.bool_]
    asked: Array
    springs: Array
    spread: float


def handles(
    ops: Operators, vertices: Array, indices: NDArray[np.int64], targets: Array, weights: Array
) -> Handles:
    """Constraints that take the vertices `indices` (K,), no two of them the same, to `targets`
    (K, 3), exactly where the weight is 1.

    A weight w < 1 is a spring of kappa = w / (1 - w) * M / (0.01 sqrt(area) spread): a patch of
    area a that hangs on a cut of length p is in balance where it stays behind by
    (1 - w) / w * p / sqrt(area) * 0.01 area / a of the spread.
    """
    asked = np.zeros_like(vertices)
    asked[indices] = targets - vertices[indices]
    spread = _diameter(asked[indices])
    exact = weights == 1.0
    fixed = np.zeros(len(vertices), dtype=bool)
    fixed[indices[exact]] = True
    springs = np.zeros(len(vertices))
    soft = indices[~exact]
    firmness = weights[~exact] / (1.0 - weights[~exact])
    size = np.sqrt(ops.face_areas.sum())
    springs[soft] = firmness * ops.vertex_areas[soft] / (SPRING_PATCH * size * spread)
    return Handles(fixed, asked, springs, spread)


def energy(ops: Operators, asked_for: Handles, d: Array, softness: float = 0.0) -> float:
    """TV(d) plus the penalty of soft constraints.

    With softness, TV's |grad d| = n counts as (n^2 / g + g) / 2 beyond g = spread / softness: the
    reversed Huber function (Owen 2007), which is convex and once differentiable.
    """
    penalty = 0.5 * asked_for.springs @ ((d - asked_for.asked) ** 2).sum(axis=1)
    if softness == 0.0:
        return total_variation(ops, d) + float(penalty)
    n, g = ops.gradient_norm(d), asked_for.spread / softness
    return float(ops.face_areas @ np.where(n <= g, n, 0.5 * (n**2 / g + g)) + penalty)


def harmonic(ops: Operators, asked_for: Handles) -> Array:
    """The displacement of least 1/2 int |grad d|^2, and springs of the same force: those against
    TV times spread / sqrt(area)."""
    ones = np.ones_like(ops.face_areas)
    scale = asked_for.spread / np.sqrt(ops.face_areas.sum())
    return _least(ops.laplacian(ones), asked_for, scale)


def biharmonic(ops: Operators, asked_for: Handles) -> Array:
    """The displacement of least 1/2 int |Laplacian of d|^2, and springs, over area^(3/2)."""
    ones = np.ones_like(ops.face_areas)
    return _least(
        _bilaplacian(ops, ones), asked_for, asked_for.spread / ops.face_areas.sum() ** 1.5
    )


def algorithm_1(ops: Operators, asked_for: Handles, tolerance: float, most: int) -> Array:
    """Algorithm 1: repeat d <- argmin |M^-1/2 L(w) d|^2, w = 1 / sqrt(|grad d|^2 + epsilon^2) of
    the last d, from the harmonic displacement on, until nothing moves by more than tolerance
    times the spread. epsilon is a thousandth of the mean |grad d|."""
    area = ops.face_areas.sum()
    d = harmonic(ops, asked_for)
    for _ in range(most):
        epsilon = 1e-3 * total_variation(ops, d) / area
        weights = 1.0 / np.hypot(ops.gradient_norm(d), epsilon)
        scale = 1.0 / (asked_for.spread * np.sqrt(area))
        last, d = d, _least(_bilaplacian(ops, weights), asked_for, scale)
        if np.abs(d - last).max() <= tolerance * asked_for.spread:
            break
    return d


def reweighted(
    ops: Operators,
    asked_for: Handles,
    softness: float = 0.0,
    iterations: int = 100,
    shrinkage: float = 0.8,
    smallest: float = 1e-5,
) -> Array:
    """The displacement of least energy, by iteratively reweighted least squares.

    Each iteration solves L(w) d + springs = 0 at the free vertices, w = Psi'(n) / n of the last
    d, where n = sqrt(|grad d|^2 + epsilon^2): 1 / n for TV, at least 1 / g with softness. epsilon
    shrinks from the mean |grad d| to `smallest` times that. Returns the best of all iterates.
    """
    area = ops.face_areas.sum()
    g = asked_for.spread / softness if softness else np.inf
    best = d = harmonic(ops, asked_for)
    mean = total_variation(ops, d) / area
    for iteration in range(iterations):
        epsilon = mean * max(shrinkage**iteration, smallest)
        weights = 1.0 / np.minimum(np.hypot(ops.gradient_norm(d), epsilon), g)
        d = _least(ops.laplacian(weights), asked_for, 1.0)
        if energy(ops, asked_for, d, softness) < energy(ops, asked_for, best, softness):
            best = d
    return best


def as_rigid_as_possible(
    ops: Operators,
    vertices: Array,
    triangles: Triangles,
    asked_for: Handles,
    tolerance: float,
    most: int,
) -> Array:
    """As-rigid-as-possible deformation (Sorkine & Alexa 2007), "spokes and rims" (Chao et al.
    2010): least sum over vertices v, faces around v and their edges e of w |e' - R_v e|^2, w half
    the cotangent opposite to e in that face. From the harmonic displacement on, until nothing
    moves by more than tolerance times the spread."""
    start, end = triangles[:, [1, 2, 0]], triangles[:, [2, 0, 1]]
    edges = vertices[end] - vertices[start]
    cotangents = _half_cotangents(vertices, triangles)
    laplacian = ops.laplacian(np.ones_like(ops.face_areas))
    scale = asked_for.spread / np.sqrt(ops.face_areas.sum())
    d = harmonic(ops, asked_for)
    for _ in range(most):
        moved = edges + d[end] - d[start]
        of_faces = np.einsum("fe,fei,fej->fij", cotangents, moved, edges)
        of_vertices = np.zeros((len(vertices), 3, 3))
        for corner in triangles.T:
            np.add.at(of_vertices, corner, of_faces)
        rotations = _nearest_rotations(of_vertices)[triangles].mean(axis=1)
        turned = np.einsum("fe,fij,fej->fei", cotangents, rotations, edges)
        forces = np.zeros_like(vertices)
        np.add.at(forces, end, turned)
        np.add.at(forces, start, -turned)
        last, d = d, _least(laplacian, asked_for, scale, forces - laplacian @ vertices)
        if np.abs(d - last).max() <= tolerance * asked_for.spread:
            break
    return d


def _diameter(points: Array) -> float:
    """Diameter of the smallest ball around points (K, 3), where two of them span it."""
    distances = np.linalg.norm(points[:, None] - points[None], axis=2)
    diameter = float(distances.max())
    i, j = np.unravel_index(distances.argmax(), distances.shape)
    centre = (points[i] + points[j]) / 2.0
    if np.linalg.norm(points - centre, axis=1).max() > (0.5 + 1e-9) * diameter:
        raise NotImplementedError("the smallest ball is not spanned by two points")
    return diameter


def _least(
    matrix: sp.csc_array, asked_for: Handles, scale: float, forces: Array | None = None
) -> Array:
    """Minimise 1/2 <d, matrix d> + 1/2 sum scale kappa |d - c|^2 - <forces, d> with d = c where
    fixed."""
    springs = scale * asked_for.springs
    system = (matrix + sp.diags_array(springs)).tocsr()
    right = springs[:, None] * asked_for.asked + (0.0 if forces is None else forces)
    free, fixed = np.flatnonzero(~asked_for.fixed), np.flatnonzero(asked_for.fixed)
    d = asked_for.asked.copy()
    known = system[free][:, fixed] @ d[fixed]
    d[free] = splu(system[free][:, free].tocsc()).solve(right[free] - known)
    return d


def _bilaplacian(ops: Operators, weights: Array) -> sp.csc_array:
    """L(w) M^-1 L(w)."""
    laplacian = ops.laplacian(weights)
    return (laplacian @ sp.diags_array(1.0 / ops.vertex_areas) @ laplacian).tocsc()


def _half_cotangents(vertices: Array, triangles: Triangles) -> Array:
    """Half the cotangent of the angle at each corner, (F, 3)."""
    corners = vertices[triangles]
    forward = np.roll(corners, -1, axis=1) - corners
    backward = np.roll(corners, 1, axis=1) - corners
    crosses = np.linalg.norm(np.cross(forward, backward), axis=2)
    return 0.5 * np.sum(forward * backward, axis=2) / crosses


def _nearest_rotations(matrices: Array) -> Array:
    """The rotation R of greatest trace(R^T A) for each A, (N, 3, 3)."""
    u, _, v = np.linalg.svd(matrices)
    u[:, :, 2] *= np.linalg.det(u @ v)[:, None]
    return u @ v
