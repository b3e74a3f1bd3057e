"""Surfaces in about the same place with other vertices, and how far they are from one another."""

from __future__ import annotations

import numpy as np
from shapes import torus

# Points whose distances are worked out at once, and triangles that are tried for each.
AT_ONCE, TRIED = 256, 24


def body(around: int, along: int, twist: float = 0.0, bumps: float = 0.04) -> tuple:
    """A lopsided torus with bumps, and vertices that lie elsewhere for each ``twist``."""
    _, triangles = torus(1.0, 0.4, around, along)
    u, v = np.meshgrid(*(2 * np.pi * np.arange(count) / count for count in (around, along)))
    u, v = u.T.ravel(), v.T.ravel()
    u, v = u + twist * np.sin(v + 1), v + twist * np.cos(2 * u)
    radius = 0.4 + 0.1 * np.sin(u) + 0.06 * np.cos(2 * u + 1)
    radius = radius + bumps * np.sin(5 * u) * np.cos(3 * v + 1)
    ring = 1 + radius * np.cos(v)
    vertices = np.column_stack([ring * np.cos(u), ring * np.sin(u), radius * np.sin(v)])
    return vertices, triangles


def distances(points: np.ndarray, vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """How far points are from a surface, by the triangles whose middles are nearest."""
    corners = vertices[triangles]
    middles = corners.mean(axis=1)
    sizes = (middles**2).sum(axis=1)
    found = np.full(len(points), np.inf)
    for first in range(0, len(points), AT_ONCE):
        some = points[first : first + AT_ONCE]
        squares = sizes - 2 * some @ middles.T
        for near in np.argpartition(squares, TRIED, axis=1)[:, :TRIED].T:
            away = _to_triangle(some, corners[near])
            found[first : first + AT_ONCE] = np.minimum(found[first : first + AT_ONCE], away)
    return found


def _to_triangle(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """How far each point is from a triangle of its own."""
    found = np.full(len(points), np.inf)
    for k in range(3):
        begin, along = corners[:, k], corners[:, (k + 1) % 3] - corners[:, k]
        share = np.einsum("ij,ij->i", points - begin, along) / np.einsum("ij,ij->i", along, along)
        near = begin + share.clip(0, 1)[:, np.newaxis] * along
        found = np.minimum(found, np.linalg.norm(points - near, axis=1))
    sides = corners[:, 1:] - corners[:, :1]
    shares = np.linalg.pinv(sides.transpose(0, 2, 1)) @ (points - corners[:, 0])[:, :, np.newaxis]
    inside = (shares[:, :, 0] >= 0).all(axis=1) & (shares[:, :, 0].sum(axis=1) <= 1)
    foot = corners[:, 0] + (sides.transpose(0, 2, 1) @ shares)[:, :, 0]
    return np.where(inside, np.linalg.norm(points - foot, axis=1), found)
