"""Generated animated meshes: a bumpy body with two horns that bends, with noise moving along it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from shapes import Mesh, Vertices, icosphere

HORNS = np.array([[0.8, 0.2, 0.55], [-0.8, 0.2, 0.55]])
HORNS /= np.linalg.norm(HORNS, axis=1, keepdims=True)


def body(directions: Vertices, time: float, *, bends: bool = True) -> Vertices:
    """Where the body is in the directions (V, 3) of its sphere at a time. From 0 to 1 it bends over
    and back, if it does at all."""
    rng = np.random.default_rng(0)
    radius = 1 + 0.12 * _waves(rng, directions, 5) + 0.06 * _waves(rng, directions, 11)
    radius += 0.06 * _waves(rng, directions, 28, 3 * np.pi * time)
    places = directions * radius[:, np.newaxis] * [0.6, 0.6, 1.6]
    for horn in HORNS:
        places += np.exp((directions @ horn - 1) / 0.035)[:, np.newaxis] * 0.9 * horn
    if not bends:
        return places
    curvature = 0.9 * np.sin(np.pi * time) + 1e-9
    x, y, z = places.T
    away = 1 / curvature - y
    angle = curvature * z
    return np.stack([x, 1 / curvature - away * np.cos(angle), away * np.sin(angle)], axis=1)


def frames(count: int, step: float, *, subdivisions: int = 4, bends: bool = True) -> list[Mesh]:
    """Frames with the same vertices, a step of time apart."""
    directions, triangles = icosphere(subdivisions)
    return [(body(directions, step * k, bends=bends), triangles) for k in range(count)]


def remeshed_frames(count: int, step: float, *, vertices: int = 2500) -> list[Mesh]:
    """The same with other vertices and triangles in each."""
    found = []
    for k in range(count):
        directions, triangles = _sampled_sphere(vertices + 17 * (k % 5), seed=k)
        found.append((body(directions, step * k), triangles))
    return found


def _waves(
    rng: np.random.Generator, directions: Vertices, frequency: float, phase: float = 0.0
) -> NDArray[np.float64]:
    """The mean of some plane waves."""
    normals = rng.normal(size=(8, 3))
    normals *= frequency / np.linalg.norm(normals, axis=1, keepdims=True)
    return np.sin(directions @ normals.T + rng.uniform(0, 2 * np.pi, 8) + phase).mean(axis=1)


def _sampled_sphere(count: int, seed: int) -> Mesh:
    """A unit sphere of points that are spread evenly but for chance, turned by chance."""
    from scipy.spatial import ConvexHull  # noqa: PLC0415 - Blender's Python lacks it

    rng = np.random.default_rng(1000 + seed)
    k = np.arange(count) + 0.5
    polar, around = np.arccos(1 - 2 * k / count), np.pi * (1 + 5**0.5) * k
    points = np.stack(
        [np.cos(around) * np.sin(polar), np.sin(around) * np.sin(polar), np.cos(polar)], axis=1
    )
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    points = points @ turn.T + 0.25 * (4 * np.pi / count) ** 0.5 * rng.normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    triangles = ConvexHull(points).simplices.astype(np.int64)
    p, q, r = np.moveaxis(points[triangles], 1, 0)
    is_inwards = np.sum(np.cross(q - p, r - p) * p, axis=1) < 0
    triangles[is_inwards] = triangles[is_inwards][:, ::-1]
    return points, triangles
