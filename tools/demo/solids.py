"""Solids that blend into a figure, given by their signed distances."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from mathutils import Euler

MIRROR = np.array([-1.0, 1.0, 1.0])


@dataclass(frozen=True)
class Chain:
    """A polyline thickened by a radius that varies linearly along each segment."""

    points: np.ndarray
    radii: np.ndarray

    def distance(self, at: np.ndarray) -> np.ndarray:
        """Signed distances (N,) of the points `at` (N, 3), negative inside."""
        nearest = np.full(len(at), np.inf, dtype=at.dtype)
        for start, end, r0, r1 in zip(
            self.points[:-1], self.points[1:], self.radii[:-1], self.radii[1:], strict=True
        ):
            axis = (end - start).astype(at.dtype)
            offset = at - start.astype(at.dtype)
            along = np.clip(offset @ axis / (axis @ axis), 0, 1)
            gap = np.linalg.norm(offset - along[:, None] * axis, axis=1)
            np.minimum(nearest, gap - (r0 + (r1 - r0) * along), out=nearest)
        return nearest

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner, each (3,), of a box around the solid."""
        reach = self.radii[:, None]
        return (self.points - reach).min(axis=0), (self.points + reach).max(axis=0)

    def mirrored(self) -> Chain:
        """The solid reflected in the plane x = 0."""
        return Chain(self.points * MIRROR, self.radii)


@dataclass(frozen=True)
class Ellipsoid:
    """An ellipsoid; the columns of `axes` (3, 3) are its unit directions."""

    center: np.ndarray
    radii: np.ndarray
    axes: np.ndarray

    def distance(self, at: np.ndarray) -> np.ndarray:
        """First-order signed distances (N,) of the points `at` (N, 3), negative inside."""
        local = ((at - self.center) @ self.axes).astype(at.dtype) / self.radii.astype(at.dtype)
        level = np.linalg.norm(local, axis=1)
        slope = np.linalg.norm(local / self.radii.astype(at.dtype), axis=1)
        return level * (level - 1) / np.maximum(slope, 1e-6)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner, each (3,), of a box around the solid."""
        reach = np.linalg.norm(self.axes * self.radii, axis=1)
        return self.center - reach, self.center + reach

    def mirrored(self) -> Ellipsoid:
        """The solid reflected in the plane x = 0."""
        return Ellipsoid(
            self.center * MIRROR, self.radii, MIRROR[:, None] * self.axes * MIRROR[None, :]
        )


@dataclass(frozen=True)
class Part:
    """One solid of a figure: `blend` is the width of the fillet, `skin` names its surface."""

    solid: Chain | Ellipsoid
    blend: float
    skin: str = ""
    carve: bool = False

    def mirrored(self) -> Part:
        """The part reflected in the plane x = 0."""
        return replace(self, solid=self.solid.mirrored())

    def reach(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner, each (3,), of the box in which it can move the surface."""
        low, high = self.solid.bounds()
        pad = 1.5 * self.blend + 0.02
        return low - pad, high + pad

    def combine(self, field: np.ndarray, at: np.ndarray) -> np.ndarray:
        """The distances `field` (N,) at the points `at` (N, 3) with this part joined or carved."""
        sign = -1 if self.carve else 1
        field, own = sign * field, self.solid.distance(at)
        overlap = np.maximum(self.blend - np.abs(field - own), 0)
        return sign * (np.minimum(field, own) - overlap**2 / (4 * self.blend))


def ball(
    center: tuple[float, float, float],
    radii: tuple[float, float, float],
    blend: float,
    skin: str,
    *,
    axes: np.ndarray | None = None,
    carve: bool = False,
) -> Part:
    """An ellipsoid as a part, by default along the coordinate axes."""
    axes = np.eye(3) if axes is None else axes
    return Part(Ellipsoid(np.array(center), np.array(radii), axes), blend, skin, carve)


def tube(
    points: list[tuple[float, float, float]],
    radii: list[float],
    blend: float,
    skin: str,
    *,
    carve: bool = False,
) -> Part:
    """A tapered tube along the Catmull-Rom curve through `points`."""
    knots = np.column_stack([np.array(points, dtype=float), radii])
    padded = np.concatenate([2 * knots[:1] - knots[1:2], knots, 2 * knots[-1:] - knots[-2:-1]])
    t = np.linspace(0, 1, 5)[:-1, None]
    pieces = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:], strict=False):
        bend = (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * (b - c) + d - a) * t**3
        pieces.append(b + 0.5 * ((c - a) * t + bend))
    curve = np.concatenate([*pieces, knots[-1:]]) if len(points) > 2 else knots
    return Part(Chain(curve[:, :3], curve[:, 3]), blend, skin, carve)


def pair(part: Part) -> list[Part]:
    """The part and its mirror image."""
    return [part, part.mirrored()]


def turned(degrees: tuple[float, float, float]) -> np.ndarray:
    """Axes (3, 3) turned by X, Y, Z Euler angles."""
    return np.array(Euler(np.radians(degrees)).to_matrix())
