"""Meshes with triangles of every kind, and sets on them whose perimeter is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, Delaunay
from shapes import Mesh, Vertices, dumbbell, grid, icosphere, torus

# Of the torus and of the dumbbell.
MAJOR, MINOR, NECK = 2.0, 0.6, 0.25


@dataclass(frozen=True)
class KnownSet:
    """A set of vertices of a mesh, and the length of its boundary.

    Attributes
    ----------
    mesh : Mesh
        Vertices (V, 3) and triangles (F, 3).
    members : array
        Whether each vertex is in the set, (V,) bool.
    perimeter : float
        In length.
    """

    mesh: Mesh
    members: NDArray[np.bool_]
    perimeter: float


def cap(mesh: Mesh, angle: float) -> KnownSet:
    """A cap of the unit sphere of this polar angle."""
    return KnownSet(mesh, mesh[0][:, 2] > np.cos(angle), 2 * np.pi * np.sin(angle))


def complement(known: KnownSet) -> KnownSet:
    """What is not in a set."""
    return KnownSet(known.mesh, ~known.members, known.perimeter)


def sleeve(mesh: Mesh, half_angle: float = 0.9) -> KnownSet:
    """A sleeve of the torus around its tube."""
    vertices = mesh[0]
    around = np.abs(np.arctan2(vertices[:, 1], vertices[:, 0]))
    return KnownSet(mesh, around < half_angle, 2 * 2 * np.pi * MINOR)


def disc(mesh: Mesh, radius: float = 0.2528) -> KnownSet:
    """A disc in the middle of the unit square, with no vertices of a lattice on its border."""
    distance = np.hypot(*(mesh[0][:, :2] - 0.5).T)
    return KnownSet(mesh, distance < radius, 2 * np.pi * radius)


def half_dumbbell(mesh: Mesh) -> KnownSet:
    """One half of a dumbbell, cut at its neck."""
    return KnownSet(mesh, mesh[0][:, 2] > 0, 2 * np.pi * NECK)


def regular_sphere(vertices: int) -> Mesh:
    """Of 2 562 vertices, 10 242, 40 962."""
    return icosphere(round(np.log((vertices - 2) / 10) / np.log(4)))


def jittered_sphere(vertices: int) -> Mesh:
    """The same, every vertex moved by a quarter of an edge or so."""
    points, triangles = regular_sphere(vertices)
    return _on_sphere(points + 0.25 * _edge(points) * _noise(points.shape)), triangles


def delaunay_sphere(vertices: int) -> Mesh:
    """Random points and their Delaunay triangles: needles, and vertices of 3 to 12 triangles."""
    points = _on_sphere(_noise((vertices, 3)))
    return points, _outwards(points, ConvexHull(points).simplices)


def decimated_sphere(vertices: int) -> Mesh:
    """What is left of a mesh with four times the vertices if most are taken out at random."""
    points, _ = regular_sphere(4 * vertices)
    kept = np.random.default_rng(0).permutation(len(points))[:vertices]
    return points[kept], _outwards(points[kept], ConvexHull(points[kept]).simplices)


def jittered_torus(vertices: int) -> Mesh:
    """Angles moved by a quarter of a cell."""
    around = round(np.sqrt(vertices * MAJOR / MINOR))
    count = around, vertices // around
    _, triangles = torus(MAJOR, MINOR, *count)
    lattice = np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), axis=-1).reshape(-1, 2)
    angles = (lattice + 0.25 * _noise(lattice.shape)) * 2 * np.pi / count
    distance = MAJOR + MINOR * np.cos(angles[:, 1])
    first, second = angles.T
    points = [distance * np.cos(first), distance * np.sin(first), MINOR * np.sin(second)]
    return np.stack(points, axis=1), triangles


def half_sphere(vertices: int) -> Mesh:
    """The upper half of the unit sphere, open at the equator: random points, Delaunay triangles of
    their projection that keeps areas."""
    rng = np.random.default_rng(0)
    rim = round(2 * np.sqrt(np.pi * vertices / 2))
    angles = np.concatenate(
        [np.arange(rim) * 2 * np.pi / rim, rng.random(vertices - rim) * 2 * np.pi]
    )
    inner = 1 - 1 / np.sqrt(vertices)
    radii = np.concatenate([np.ones(rim), inner * np.sqrt(rng.random(vertices - rim))])
    flat = radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    across = np.sqrt(2 - radii**2)[:, None] * flat
    points = np.column_stack([across, 1 - radii**2])
    return points, Delaunay(flat).simplices.astype(np.int64)


def half_cap(mesh: Mesh, angle: float = 0.8) -> KnownSet:
    """Half a cap, around a point of the border of the half sphere: the border is no boundary."""
    return KnownSet(mesh, mesh[0][:, 0] > np.cos(angle), np.pi * np.sin(angle))


def regular_square(vertices: int) -> Mesh:
    """Squares cut along parallel diagonals."""
    count = round(np.sqrt(vertices))
    return grid(count, count)


def random_square(vertices: int) -> Mesh:
    """Random points in the unit square and their Delaunay triangles."""
    rng = np.random.default_rng(0)
    side = np.linspace(0, 1, round(np.sqrt(vertices)))
    ends = np.zeros_like(side)
    border = [np.column_stack(each) for each in (
        (side, ends), (side, ends + 1), (ends, side), (ends + 1, side))]  # fmt: skip
    flat = np.unique(np.vstack([*border, rng.random((vertices - 4 * len(side) + 4, 2))]), axis=0)
    triangles = Delaunay(flat).simplices.astype(np.int64)
    return np.column_stack([flat, np.zeros(len(flat))]), triangles


def stretched_square(vertices: int) -> Mesh:
    """Cells that are eight times as long as wide."""
    count = round(np.sqrt(vertices / 8))
    return grid(count, 8 * count)


def squeezed_dumbbell(vertices: int) -> Mesh:
    """Narrow triangles at the neck, where vertices are moved along it by a third of an edge."""
    around = round(np.sqrt(vertices / 2))
    points, triangles = dumbbell(n_around=around, n_along=2 * around)
    heights = np.unique(points[:, 2].round(9))
    spacing = np.diff(heights[np.abs(heights) < 0.4]).mean()
    at_neck = np.abs(points[:, 2]) < 0.4
    moved = spacing * np.clip(_noise((len(points),)) / 3, -0.45, 0.45)
    points[:, 2] += np.where(at_neck, moved, 0)
    return points, triangles


#: Every set with what its mesh is made by, by name.
SETS: dict[str, tuple[Callable[[Mesh], KnownSet], Callable[[int], Mesh]]] = {
    **{
        f"cap of {angle}, {kind}": (lambda mesh, angle=angle: cap(mesh, angle), sphere)
        for kind, sphere in (
            ("regular", regular_sphere), ("jittered", jittered_sphere),
            ("Delaunay", delaunay_sphere), ("decimated", decimated_sphere),
        )
        for angle in (0.5, 1.0, 1.5)
    },
    "complement of the cap of 1.0, regular": (lambda mesh: complement(cap(mesh, 1)),
                                              regular_sphere),
    "complement of the cap of 1.0, jittered": (lambda mesh: complement(cap(mesh, 1)),
                                               jittered_sphere),
    "sleeve of the torus, jittered": (sleeve, jittered_torus),
    "disc, regular": (disc, regular_square),
    "disc, Delaunay": (disc, random_square),
    "disc, cells of 8:1": (disc, stretched_square),
    "cap of 1.0, half sphere": (lambda mesh: cap(mesh, 1), half_sphere),
    "half a cap of 0.8, half sphere": (half_cap, half_sphere),
    "half of the dumbbell, squeezed": (half_dumbbell, squeezed_dumbbell),
}  # fmt: skip


def _noise(shape: tuple[int, ...]) -> NDArray[np.float64]:
    return np.random.default_rng(0).normal(size=shape)


def _on_sphere(points: Vertices) -> Vertices:
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def _edge(points: Vertices) -> float:
    """About the length of an edge between points all over the unit sphere."""
    return float(np.sqrt(8 * np.pi / np.sqrt(3) / len(points)))


def _outwards(points: Vertices, triangles: NDArray[np.int32]) -> NDArray[np.int64]:
    turned = triangles.astype(np.int64)
    inwards = np.linalg.det(points[turned]) < 0
    turned[inwards] = turned[inwards][:, ::-1]
    return turned
