"""What a displacement does to faces, by definition: a face and a pair at a time, exactly."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
Point = list[Fraction]
Triangle = list[Point]


def normals(vertices: Numbers, triangles: NDArray[np.int64]) -> Numbers:
    """The normal of each face, twice its area long, (F, 3)."""
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    return np.cross(b - a, c - a)


def lengths(vertices: Numbers, triangles: NDArray[np.int64]) -> Numbers:
    """The lengths of the edges of each face, (F, 3)."""
    corners = vertices[triangles]
    return np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)


def counted(vertices: Numbers, triangles: NDArray[np.int64]) -> tuple[Numbers, NDArray[np.bool_]]:
    """The lengths of edges that count, (F, 3), and whether the face has a normal, (F,)."""
    edges = lengths(vertices, triangles)
    longest = edges.max(axis=1)
    normal = np.linalg.norm(normals(vertices, triangles), axis=1)
    return np.maximum(edges, 1e-5 * longest[:, np.newaxis]), normal >= 1e-5 * longest**2


def takes_part(vertices: Numbers, triangles: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether a face has three corners, and is more than a point, (F,)."""
    a, b, c = triangles.T
    longest = lengths(vertices, triangles).max(axis=1)
    return (a != b) & (b != c) & (c != a) & (longest > 0)


def cross(one: Triangle, other: Triangle) -> bool:
    """Whether a point inside one of two triangles is in the other."""
    return _is_inside(one, other) or _is_inside(other, one)


def _is_inside(one: Triangle, other: Triangle) -> bool:
    """Whether a point inside `one` is in the other."""
    normal = _normal(one)
    if _is_zero(normal) or _is_zero(_normal(other)):
        return False
    heights = [_dot(normal, _minus(corner, one[0])) for corner in other]
    part = _part_between(other, heights) if any(heights) else other
    walls = [(one[k], _cross(normal, _minus(one[(k + 1) % 3], one[k]))) for k in range(3)]
    # What of `other` is in the plane of `one`: nothing, a point, a segment, or all of it.
    for wall, inwards in walls:
        part = _beyond(part, [_dot(inwards, _minus(point, wall)) for point in part])
    if not any(heights):
        return len(part) > 2 and not _is_zero(_area(part))
    centre = [sum(axis, Fraction(0)) / max(len(part), 1) for axis in zip(*part, strict=True)]
    return bool(part) and all(_dot(inwards, _minus(centre, wall)) > 0 for wall, inwards in walls)


def _part_between(corners: Triangle, heights: list[Fraction]) -> list[Point]:
    """Where a triangle meets the plane that its corners have these heights over."""
    points = [corner for corner, height in zip(corners, heights, strict=True) if height == 0]
    for k in range(3):
        low, high = heights[k], heights[(k + 1) % 3]
        if low * high < 0:
            points.append(_between(corners[k], corners[(k + 1) % 3], low, high))
    return points


def _beyond(points: list[Point], heights: list[Fraction]) -> list[Point]:
    """The part of a convex polygon, a segment or a point that is not below a wall."""
    kept = []
    for k, (point, height) in enumerate(zip(points, heights, strict=True)):
        following = (k + 1) % len(points)
        if height >= 0:
            kept.append(point)
        if height * heights[following] < 0:
            kept.append(_between(point, points[following], height, heights[following]))
    return kept


def _between(one: Point, other: Point, low: Fraction, high: Fraction) -> Point:
    """Where the height is 0 between two points."""
    share = low / (low - high)
    return [p + share * (q - p) for p, q in zip(one, other, strict=True)]


def _area(points: list[Point]) -> Point:
    fans = [_normal([points[0], points[k], points[k + 1]]) for k in range(1, len(points) - 1)]
    return [sum(axis, Fraction(0)) for axis in zip(*fans, strict=True)]


def _normal(corners: Triangle) -> Point:
    return _cross(_minus(corners[1], corners[0]), _minus(corners[2], corners[0]))


def _minus(a: Point, b: Point) -> Point:
    return [p - q for p, q in zip(a, b, strict=True)]


def _cross(a: Point, b: Point) -> Point:
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def _dot(a: Point, b: Point) -> Fraction:
    return sum((p * q for p, q in zip(a, b, strict=True)), Fraction(0))


def _is_zero(a: Point) -> bool:
    return not any(a)
