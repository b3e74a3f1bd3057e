"""Gradients and areas of a triangle mesh in NumPy and SciPy."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp


def hats_and_areas(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The gradients of the hat functions of each face's corners, (F, 3, 3), and the face areas."""
    corners = vertices[triangles]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    normals = np.cross(opposite[:, 0], opposite[:, 1])
    double = np.linalg.norm(normals, axis=1)
    return np.cross(normals[:, None], opposite) / (double**2)[:, None, None], double / 2


def gradient_and_areas(
    vertices: np.ndarray, triangles: np.ndarray
) -> tuple[sp.csr_array, np.ndarray]:
    """G (3F, V) and the face areas."""
    hats, areas = hats_and_areas(vertices, triangles)
    faces = len(triangles)
    rows = np.broadcast_to(3 * np.arange(faces)[:, None, None] + np.arange(3), (faces, 3, 3))
    columns = np.broadcast_to(triangles[:, :, None], (faces, 3, 3))
    entries = (hats.ravel(), (rows.ravel(), columns.ravel()))
    return sp.csr_array(entries, shape=(3 * faces, len(vertices))), areas


def face_normals(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Normals as long as twice the area, (F, 3)."""
    a, b, c = (vertices[corner] for corner in triangles.T)
    return np.cross(b - a, c - a)


def to_vertices(triangles: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """The sum of the values (F,) of the faces around each of `count` vertices, (V,)."""
    return np.bincount(triangles.ravel(), np.repeat(values, 3), count)
