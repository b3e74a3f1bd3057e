"""Crouzeix–Raviart elements in the plainest form, and their proximal step as a cone programme."""

from __future__ import annotations

from dataclasses import dataclass

import clarabel
import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from shapes import Triangles, Vertices

Numbers = NDArray[np.float64]


def kappa(lengths: Numbers) -> float:
    """4 ∫ L dφ / ∫ (p² + q² + r²)/(2 L) dφ of a triangle, by brute force."""
    a, b, c = lengths
    x = (b**2 + c**2 - a**2) / (2 * c)
    corners = np.array([[0, 0], [c, 0], [x, np.sqrt(b**2 - x**2)]])
    angles = (np.arange(20_000) + 0.5) * np.pi / 20_000
    normals = np.stack([np.cos(angles), np.sin(angles)])
    widths = np.abs((corners - np.roll(corners, 1, axis=0)) @ normals)
    widest = widths.max(axis=0)
    return float(4 * widest.sum() / ((widths**2).sum(axis=0) / (2 * widest)).sum())


@dataclass(frozen=True)
class EdgeElements:
    """S, D, A, H and where edges are.

    Attributes
    ----------
    edges : array
        The edges opposite to the corners of each triangle, (F, 3).
    sample : sparse matrix
        S, (E, V).
    gradient : sparse matrix
        D, (3 F, E): three components in space for each triangle.
    areas : array
        A, (F,).
    mass : sparse matrix
        H, (E, E).
    """

    edges: NDArray[np.int64]
    sample: sparse.csr_matrix
    gradient: sparse.csr_matrix
    areas: Numbers
    mass: sparse.csr_matrix

    def total_variation(self, values: Numbers) -> float:
        """TV of values on edges."""
        vectors = (self.gradient @ values).reshape(-1, 3)
        return float(self.areas @ np.linalg.norm(vectors, axis=1))


def edge_elements(vertices: Vertices, triangles: Triangles) -> EdgeElements:
    """The elements of a mesh without degenerate triangles."""
    sides = np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    ends, edges = np.unique(sides, axis=0, return_inverse=True)
    edges = edges.reshape(-1, 3)
    corners = vertices[triangles]
    along = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]  # the edge opposite to each corner
    normals = np.cross(along[:, 2], -along[:, 1])
    areas = np.linalg.norm(normals, axis=1) / 2
    hats = np.cross(normals[:, None], along) / (4 * areas[:, None, None] ** 2)
    count, faces = len(ends), len(triangles)
    rows = np.repeat(3 * np.arange(faces), 9) + np.tile(np.arange(3), 3 * faces)
    entries = (-2 * hats).reshape(-1), (rows, np.repeat(edges, 3))
    masses = np.bincount(edges.ravel(), np.repeat(areas / 3, 3), count)
    mass = sparse.diags(masses).tolil()
    for triangle, area, lengths in zip(edges, areas, np.linalg.norm(along, axis=2), strict=True):
        coupling = kappa(lengths) * area / 12
        for i, j in ((0, 1), (1, 2), (2, 0)):
            a, b = triangle[i], triangle[j]
            mass[a, a] += coupling
            mass[b, b] += coupling
            mass[a, b] -= coupling
            mass[b, a] -= coupling
    halves = np.full(2 * count, 0.5), (np.repeat(np.arange(count), 2), ends.ravel())
    return EdgeElements(
        edges,
        sparse.csr_matrix(halves, shape=(count, len(vertices))),
        sparse.csr_matrix(entries, shape=(3 * faces, count)),
        areas,
        mass.tocsr(),
    )


def proximal_step(elements: EdgeElements, data: Numbers, tau: float) -> Numbers:
    """argmin ½‖w − data‖²_H + τ TV(w), by an interior-point method for second-order cones."""
    faces, count = len(elements.areas), len(data)
    # Unknowns w and n; (n_f, D_f w) in a cone for each triangle f.
    order = np.arange(4 * faces).reshape(faces, 4)
    rows = np.empty(4 * faces, dtype=np.int64)
    rows[order[:, 0]] = np.arange(faces)
    rows[order[:, 1:].ravel()] = faces + np.arange(3 * faces)
    cones = sparse.block_diag([sparse.eye(faces), elements.gradient], format="csr")[rows]
    cones = sparse.hstack([cones[:, faces:], cones[:, :faces]], format="csc")
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_rel = settings.tol_gap_abs = settings.tol_feas = 1e-10
    solution = clarabel.DefaultSolver(
        sparse.block_diag([elements.mass, sparse.csc_matrix((faces, faces))], format="csc"),
        np.concatenate([-(elements.mass @ data), tau * elements.areas]),
        -cones,
        np.zeros(4 * faces),
        [clarabel.SecondOrderConeT(4)] * faces,
        settings,
    ).solve()
    assert str(solution.status) == "Solved"
    return np.array(solution.x[:count])


def interpolate(elements: EdgeElements, triangles: Triangles, values: Numbers) -> Numbers:
    """The function on vertices that stands for values on edges, by Zalesak's limiter."""
    count = triangles.max() + 1

    def gather(parts: Numbers) -> Numbers:
        return np.bincount(triangles.ravel(), parts.ravel(), count)

    w, third = values[elements.edges], elements.areas[:, None] / 3
    areas = gather(np.repeat(third, 3, axis=1))
    beside = (w[:, [1, 2, 0]] + w[:, [2, 0, 1]]) / 2
    low, corrections = gather(third * beside), third * (beside - w)
    most, least = np.full(count, -np.inf), np.full(count, np.inf)
    np.maximum.at(most, triangles, w.max(axis=1)[:, None])
    np.minimum.at(least, triangles, w.min(axis=1)[:, None])
    tiny = 1e-300
    up = np.minimum(1, (areas * most - low) / (gather(np.maximum(corrections, 0)) + tiny))
    down = np.minimum(1, (low - areas * least) / (gather(np.maximum(-corrections, 0)) + tiny))
    room = np.where(corrections >= 0, up[triangles], down[triangles])
    share = room.min(axis=1, keepdims=True)
    return (low + gather(share * corrections)) / areas
