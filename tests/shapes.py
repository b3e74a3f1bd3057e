"""Generated triangle meshes for the tests.

Every function but `ends` returns vertices, float64 of shape (V, 3), and triangles, int64 of shape
(F, 3), with all triangles oriented outwards (for the flat grid: towards +z).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Vertices = NDArray[np.float64]
Triangles = NDArray[np.int64]
Indices = NDArray[np.int64]
Mesh = tuple[Vertices, Triangles]

# Where tan z = z: |z| of the bottlenecks of sinc_surface, and their radius.
SINC_NECK = 4.493409
SINC_NECK_RADIUS = 0.4 + np.sin(SINC_NECK) / SINC_NECK


def icosphere(subdivisions: int, radius: float = 1.0) -> Mesh:
    """Sphere of 10 * 4^subdivisions + 2 vertices, by repeated splitting of an icosahedron."""
    vertices, triangles = _icosahedron()
    for _ in range(subdivisions):
        vertices, triangles = _split_triangles(vertices, triangles)
        vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
    return radius * vertices, triangles


def bumpy_sphere(subdivisions: int, amplitude: float = 0.1, seed: int = 0) -> Mesh:
    """Unit sphere with radial detail at wavelengths from its diameter to about a tenth of it.

    The radius is 1 + amplitude * (sum of random plane waves), each wave's height falling with its
    frequency; the sum of the heights is 1, so the radius stays within 1 -+ amplitude.
    """
    rng = np.random.default_rng(seed)
    sphere, triangles = icosphere(subdivisions)
    frequencies = np.repeat([3.0, 6.0, 12.0, 24.0], 4)
    directions = rng.normal(size=(len(frequencies), 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    phases = rng.uniform(0.0, 2.0 * np.pi, len(frequencies))
    heights = frequencies**-0.5
    heights /= heights.sum()
    waves = np.sin(sphere @ (directions * frequencies[:, None]).T + phases)
    return sphere * (1.0 + amplitude * waves @ heights)[:, None], triangles


def torus(major: float, minor: float, n_major: int, n_minor: int) -> Mesh:
    """Torus about the z axis; vertex i * n_minor + j is at angle i around z, j around the tube."""
    around, tube = np.meshgrid(_angles(n_major), _angles(n_minor), indexing="ij")
    distance = major + minor * np.cos(tube)
    vertices = np.stack(
        [distance * np.cos(around), distance * np.sin(around), minor * np.sin(tube)], axis=-1
    )
    return vertices.reshape(-1, 3), _lattice_triangles(n_major, n_minor, True, True)


def grid(nx: int, ny: int, width: float = 1.0, height: float = 1.0) -> Mesh:
    """Open flat rectangle in z = 0 of nx by ny vertices; vertex i * ny + j is at x_i, y_j."""
    x, y = np.meshgrid(np.linspace(0.0, width, nx), np.linspace(0.0, height, ny), indexing="ij")
    vertices = np.stack([x, y, np.zeros_like(x)], axis=-1)
    return vertices.reshape(-1, 3), _lattice_triangles(nx, ny, False, False)


def cylinder_open(
    radius: float = 1.0, height: float = 2.0, n_around: int = 48, n_along: int = 24
) -> Mesh:
    """Cylinder about the z axis without its two discs: an open surface with two boundary loops."""
    angle, z = np.meshgrid(
        _angles(n_around), np.linspace(-height / 2.0, height / 2.0, n_along), indexing="ij"
    )
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)
    return vertices.reshape(-1, 3), _lattice_triangles(n_around, n_along, True, False)


def dumbbell(
    ball_radius: float = 1.0,
    neck_radius: float = 0.25,
    neck_length: float = 1.0,
    n_around: int = 48,
    n_along: int = 96,
) -> Mesh:
    """Two balls on the z axis joined by a thin cylindrical neck: a closed surface of revolution.

    n_along counts the rings of n_around vertices between the two poles.
    """
    opening = np.arcsin(neck_radius / ball_radius)
    polar = np.linspace(0.0, np.pi - opening, 400)
    centre = neck_length / 2.0 + ball_radius * np.cos(opening)
    upper = np.column_stack([ball_radius * np.sin(polar), centre + ball_radius * np.cos(polar)])
    return _revolve(np.vstack([upper, upper[::-1] * [1.0, -1.0]]), n_around, n_along)


def sinc_surface(n_around: int = 48, n_along: int = 192) -> Mesh:
    """Tube about the z axis whose radius is 0.4 + sin(z)/z, open at z = -9.5 and 9.5.

    Its bottlenecks are at SINC_NECK on both sides of a large bulge (Brokman et al. 2024, the
    figures of the sinc). Vertex i * n_along + j is at angle i and, from below, on ring j.
    """
    angle, z = np.meshgrid(_angles(n_around), np.linspace(-9.5, 9.5, n_along), indexing="ij")
    radius = 0.4 + np.sinc(z / np.pi)
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)
    return vertices.reshape(-1, 3), _lattice_triangles(n_around, n_along, True, False)


def ends(vertices: Vertices, share: float = 0.08) -> tuple[Indices, Indices]:
    """The given share of the vertices that is lowest, and that which is highest, along z."""
    low, high = np.quantile(vertices[:, 2], [share, 1.0 - share])
    return np.flatnonzero(vertices[:, 2] < low), np.flatnonzero(vertices[:, 2] > high)


def _icosahedron() -> Mesh:
    golden = (1.0 + np.sqrt(5.0)) / 2.0
    rectangle = np.array([[0, s, t * golden] for s in (-1.0, 1.0) for t in (-1.0, 1.0)])
    vertices = np.vstack([np.roll(rectangle, shift, axis=1) for shift in range(3)])
    edge = np.linalg.norm(vertices[:, None] - vertices[None], axis=2) < 2.1
    triangles = np.array(
        [(a, b, c) for a in range(12) for b in range(a) for c in range(b)
         if edge[a, b] and edge[b, c] and edge[c, a]]
    )  # fmt: skip
    inwards = np.linalg.det(vertices[triangles]) < 0.0
    triangles[inwards] = triangles[inwards][:, ::-1]
    return vertices / np.linalg.norm(vertices[0]), triangles


def _split_triangles(vertices: Vertices, triangles: Triangles) -> Mesh:
    """Split each triangle in four at its edges' midpoints."""
    halfedges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, edge_of = np.unique(halfedges, axis=0, return_inverse=True)
    midpoints = vertices[edges].mean(axis=1)
    a, b, c = triangles.T
    ab, bc, ca = (len(vertices) + edge_of.reshape(-1, 3)).T
    quarters = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1)
    return np.vstack([vertices, midpoints]), quarters.reshape(-1, 3)


def _angles(count: int) -> NDArray[np.float64]:
    return np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)


def _lattice_triangles(rows: int, columns: int, wrap_rows: bool, wrap_columns: bool) -> Triangles:
    """Two triangles per cell of a lattice of rows by columns vertices, wrapped where asked."""
    index = np.arange(rows * columns).reshape(rows, columns)
    index = np.pad(index, ((0, wrap_rows), (0, wrap_columns)), mode="wrap")
    corners = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    a, b, c, d = (corner.ravel() for corner in corners)
    return np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3)


def _revolve(profile: NDArray[np.float64], n_around: int, n_along: int) -> Mesh:
    """Revolve a profile of (distance, z) points, from the upper pole to the lower, about z."""
    length = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1)))
    samples = np.linspace(0.0, length[-1], n_along + 2)[1:-1]
    distance, z = (np.interp(samples, length, column) for column in profile.T)
    angle = _angles(n_around)
    rings = np.stack(
        [
            np.outer(np.cos(angle), distance),
            np.outer(np.sin(angle), distance),
            np.broadcast_to(z, (n_around, n_along)),
        ],
        axis=-1,
    )
    poles = np.array([[0.0, 0.0, profile[0, 1]], [0.0, 0.0, profile[-1, 1]]])
    upper, lower = n_around * n_along, n_around * n_along + 1
    first = np.arange(n_around) * n_along
    last = first + n_along - 1
    side = _lattice_triangles(n_around, n_along, True, False)[:, ::-1]
    upper_fan = np.column_stack([np.full(n_around, upper), first, np.roll(first, -1)])
    lower_fan = np.column_stack([np.full(n_around, lower), np.roll(last, -1), last])
    vertices = np.vstack([rings.reshape(-1, 3), poles])
    return vertices, np.vstack([side, upper_fan, lower_fan])
