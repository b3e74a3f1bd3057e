"""Meshes to measure on: generated, or read from a file. Vertices (V, 3) and triangles (F, 3)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

Shape = tuple[np.ndarray, np.ndarray]


def bumpy_sphere(frequency: int) -> Shape:
    """A sphere of 10 frequency² + 2 vertices with detail."""
    vertices, triangles = sphere(frequency)
    waves = sum(np.sin(k * vertices[:, axis]) / k for axis in range(3) for k in (5, 11, 23))
    return vertices * (1 + 0.1 * waves)[:, None], triangles


def sphere(frequency: int) -> Shape:
    """An icosahedron, each edge cut into `frequency` parts, blown up to radius 1."""
    golden = (1 + np.sqrt(5)) / 2
    rectangle = np.array([[0, s, t * golden] for s in (-1, 1) for t in (-1, 1)])
    corners = np.vstack([np.roll(rectangle, shift, axis=1) for shift in range(3)])
    near = np.linalg.norm(corners[:, None] - corners, axis=2) < 2.1
    faces = np.array(
        [(i, j, k) for i in range(12) for j in range(i) for k in range(j)
         if near[i, j] and near[j, k] and near[k, i]]
    )  # fmt: skip
    inwards = np.linalg.det(corners[faces]) < 0
    faces[inwards] = faces[inwards][:, ::-1]
    # The points of a face: i steps along one edge, j along the other.
    i, j = (index.ravel() for index in np.mgrid[: frequency + 1, : frequency + 1])
    inside = i + j <= frequency
    number = np.cumsum(inside).reshape(frequency + 1, -1) - 1
    i, j = i[inside], j[inside]
    weights = np.stack([frequency - i - j, i, j], axis=1) / frequency
    points = (weights @ corners[faces]).reshape(-1, 3)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[:-1, 1:], number[1:, 1:]
    row, column = np.mgrid[:frequency, :frequency]
    up, down = row + column < frequency, row + column < frequency - 1
    pattern = np.vstack(
        [np.stack([a[up], b[up], c[up]], axis=1), np.stack([b[down], d[down], c[down]], axis=1)]
    )
    triangles = (pattern + len(i) * np.arange(20)[:, None, None]).reshape(-1, 3)
    # Faces share the points of their edges.
    keys = np.round(points * (8 * frequency)).astype(np.int64) @ [1, 1 << 20, 1 << 40]
    _, first, same = np.unique(keys, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    vertices = points[np.sort(first)]
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), rank[same][triangles]


def pinched_sphere(frequency: int) -> Shape:
    """Two bumpy halves with a neck between them."""
    vertices, triangles = bumpy_sphere(frequency)
    waist = 1 - 0.7 * np.exp(-((vertices[:, 2:] / 0.3) ** 2))
    return vertices * np.hstack([waist, waist, np.full_like(waist, 1.5)]), triangles


def bumpy_torus(size: int) -> Shape:
    """A torus of about `size` vertices with detail."""
    minor = round(np.sqrt(size / 2))
    major = 2 * minor
    around, tube = np.meshgrid(np.arange(major), np.arange(minor), indexing="ij")
    u, v = 2 * np.pi * around / major, 2 * np.pi * tube / minor
    waves = sum(np.sin(k * u) * np.cos((k // 2 + 1) * v) / k for k in (5, 11, 23, 47))
    radius = 0.5 * (1 + 0.2 * waves)
    distance = 1.2 + radius * np.cos(v)
    shape = [distance * np.cos(u), distance * np.sin(u), radius * np.sin(v)]
    index = around * minor + tube
    right, up = np.roll(index, -1, axis=0), np.roll(index, -1, axis=1)
    corner = np.roll(right, -1, axis=1)
    triangles = np.concatenate(
        [np.stack([index, right, corner], axis=-1), np.stack([index, corner, up], axis=-1)]
    )
    return np.stack(shape, axis=-1).reshape(-1, 3), triangles.reshape(-1, 3)


def read(path: Path) -> Shape:
    """The first mesh of a file, as Blender reads it."""
    import bpy  # noqa: PLC0415 - it loads for a second and takes memory

    bpy.ops.wm.read_factory_settings(use_empty=True)
    getattr(bpy.ops.wm, f"{path.suffix[1:].lower()}_import")(filepath=str(path))
    mesh = bpy.context.object.data
    mesh.calc_loop_triangles()
    vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    triangles = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.vertices.foreach_get("co", vertices)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    return vertices.reshape(-1, 3).astype(float), triangles.reshape(-1, 3)
