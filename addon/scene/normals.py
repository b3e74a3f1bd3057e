"""Normals of the vertices of triangles."""

from __future__ import annotations

from spectral_tv.later import np


def vertex_normals(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Normals (N, 3) of vertices (N, 3), by the areas of their triangles; 0 where there is none."""
    one, two, three = (vertices[corner] for corner in triangles.T)
    across = np.cross(two - one, three - one)
    found = np.column_stack(
        [
            sum(np.bincount(corner, axis, len(vertices)) for corner in triangles.T)
            for axis in across.T
        ]
    )
    lengths = np.linalg.norm(found, axis=1, keepdims=True)
    return found / np.where(lengths > 0, lengths, 1)
