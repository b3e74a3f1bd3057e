"""Open edges that lie on one another: files with a UV seam or flat shading tear surfaces there."""

import numpy as np


def open_vertices(triangles: np.ndarray) -> np.ndarray:
    """Vertices of the edges that belong to a single triangle, in order."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64), axis=1)
    stride = int(triangles.max(initial=0)) + 1
    keys, count = np.unique(edges[:, 0] * stride + edges[:, 1], return_counts=True)
    single = keys[count == 1]
    return np.unique([single // stride, single % stride])


def close(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Take vertices on open edges that are at exactly the same place as one.

    Returns the vertices to keep, and for every vertex (V,) its index among them. Vertices inside
    a surface stay their own, so that surfaces which merely touch are not joined.
    """
    place = np.arange(len(vertices))
    candidates = open_vertices(triangles)
    # −0 and 0 are the same place.
    _, first, which = np.unique(
        vertices[candidates] + 0.0, axis=0, return_index=True, return_inverse=True
    )
    place[candidates] = candidates[first[which.ravel()]]
    kept, place = np.unique(place, return_inverse=True)
    return kept, place
