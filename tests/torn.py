"""Meshes whose surfaces belong together but are not joined, as files and readers hand them over."""

from __future__ import annotations

import numpy as np
from shapes import Mesh, Vertices, grid


def soup(mesh: Mesh) -> Mesh:
    """Every triangle with corners of its own, as in an STL file."""
    vertices, triangles = mesh
    return vertices[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3)


def noisy_soup(mesh: Mesh, noise: float, seed: int = 0) -> Mesh:
    """The same with the last digits of every corner rounded differently, by up to ``noise``."""
    vertices, triangles = soup(mesh)
    rng = np.random.default_rng(seed)
    return vertices + noise * rng.uniform(-1.0, 1.0, vertices.shape), triangles


def cube_of_sides() -> Mesh:
    """A cube of 24 vertices, four to a side, as readers of OBJ files make them of normals."""
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    corners = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    first = 4 * np.arange(6)[:, np.newaxis]
    triangles = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    return corners[np.ravel(sides)], triangles


def beside(mesh: Mesh, other: Mesh) -> Mesh:
    """Both as one."""
    return np.vstack([mesh[0], other[0]]), np.vstack([mesh[1], other[1] + len(mesh[0])])


def relief(vertices: Vertices) -> Vertices:
    """A plane with hills."""
    x, y = vertices[:, 0], vertices[:, 1]
    z = 0.1 * np.sin(6 * x) * np.cos(5 * y) + 0.05 * np.sin(17 * x + 1) * np.sin(13 * y)
    return np.column_stack([x, y, z])


def half_grids(rows: int, other_rows: int, gap: float) -> Mesh:
    """Two square grids with hills whose borders are ``gap`` apart at x = 1.

    The first has 9 by ``rows`` vertices, the other 9 by ``other_rows``; where these are more, they
    lie on the edges of the first. The first's border are its last vertices, the other's its first.
    """
    (first, triangles), (second, more) = grid(9, rows), grid(9, other_rows)
    first, second = relief(first), relief(second + np.array([1.0, 0.0, 0.0]))
    ours, theirs = first[-rows:], second[:other_rows]
    theirs[:, 2] = np.interp(theirs[:, 1], ours[:, 1], ours[:, 2])
    return beside((first, triangles), (second + np.array([gap, 0.0, 0.0]), more))


def canonical(labels: np.ndarray) -> np.ndarray:
    """The labels of a partition, each replaced by the first index that has it; -1 stays."""
    _, first, which = np.unique(labels, return_index=True, return_inverse=True)
    return np.where(labels < 0, -1, first[which.ravel()])


def open_edges(triangles: np.ndarray) -> np.ndarray:
    """Edges of one triangle only, (n, 2), of those that repeat no index."""
    a, b, c = triangles.T
    proper = triangles[(a != b) & (b != c) & (c != a)]
    edges = np.sort(proper[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    return edges[count == 1]
