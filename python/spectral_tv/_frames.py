"""How a surface is turned against another one, vertex by vertex."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]

# Edges over which what is around a vertex is gathered.
ROUNDS = 2


@dataclass(frozen=True)
class Links:
    """The edges of a mesh of N vertices, each in both directions.

    Those of vertex v lead to ``ends[starts[v]:starts[v + 1]]``.
    """

    starts: NDArray[np.int64]
    ends: NDArray[np.int64]

    @classmethod
    def of(cls, triangles: NDArray[np.int64], count: int) -> "Links":
        """The edges of triangles (F, 3) among ``count`` vertices."""
        pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        pairs = pairs[pairs[:, 0] != pairs[:, 1]]
        both = np.concatenate([pairs, pairs[:, ::-1]])
        begins, ends = np.divmod(np.unique(both[:, 0] * count + both[:, 1]), count)
        starts = np.concatenate([[0], np.cumsum(np.bincount(begins, minlength=count))])
        return cls(starts, ends)

    @property
    def begins(self) -> NDArray[np.int64]:
        """Where each edge begins, as ``ends``."""
        return np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))

    def leaving(self, vertices: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The edges of some vertices: places in ``ends``, and which of these each one leaves."""
        counts = self.starts[vertices + 1] - self.starts[vertices]
        owners = np.repeat(np.arange(len(vertices)), counts)
        firsts = np.cumsum(counts) - counts
        return self.starts[vertices][owners] + np.arange(len(owners)) - firsts[owners], owners

    def gathered(self, values: Numbers) -> Numbers:
        """Sums of the values of edges (2E, C) over those that leave a vertex, (N, C)."""
        count, begins = len(self.starts) - 1, self.begins
        return np.column_stack([np.bincount(begins, each, count) for each in values.T])

    def spread(self, values: Numbers, rounds: int) -> Numbers:
        """Sums (N, C) of values of vertices with those of their neighbours, so many times."""
        for _ in range(rounds):
            values = values + self.gathered(values[self.ends])
        return values


def vertex_normals(points: Numbers, triangles: NDArray[np.int64]) -> Numbers:
    """Unit normals of vertices, means over the triangles by area, (N, 3); 0 where there is none."""
    one, two, three = (points[corners] for corners in triangles.T)
    across = np.cross(two - one, three - one)
    count = len(points)
    sums = np.column_stack(
        [np.bincount(triangles.ravel(), np.repeat(each, 3), count) for each in across.T]
    )
    return _unit(sums.astype(np.float64))


def turns(
    links: Links,
    triangles: NDArray[np.int64],
    before: Numbers,
    after: Numbers,
    known: NDArray[np.bool_],
) -> Numbers:
    """The rotation of the surroundings of every vertex from ``before`` to ``after``, (N, 3, 3).

    Both are places (N, 3) of the vertices of ``triangles`` (F, 3); those that are not ``known``
    (N,) do not count. The normal is taken to the normal, each a mean over ROUNDS edges around. Then
    the edges are turned in the plane across it to where they fit best.
    """
    counting = triangles[known[triangles].all(axis=1)]
    one, other = (
        _unit(links.spread(vertex_normals(each, counting), ROUNDS)) for each in (before, after)
    )
    tilts = _tilts(one, other)
    begins, ends = links.begins, links.ends
    were, are = before[ends] - before[begins], after[ends] - after[begins]
    were = np.einsum("eij,ej->ei", tilts[begins], were)
    normals, counts = other[begins], known[begins] & known[ends]
    were, are = (each - _dot(each, normals)[:, np.newaxis] * normals for each in (were, are))
    across, along = _dot(np.cross(were, are), normals), _dot(were, are)
    sums = np.column_stack([across, along]) * counts[:, np.newaxis]
    sums = links.spread(links.gathered(sums), ROUNDS)
    return _around(other, np.arctan2(sums[:, 0], sums[:, 1])) @ tilts


def _tilts(one: Numbers, other: Numbers) -> Numbers:
    """The least rotations that take unit vectors (N, 3) to others; none where one is 0."""
    axes = np.cross(one, other)
    cosines = _dot(one, other)
    is_there = ((one != 0).any(axis=1) & (other != 0).any(axis=1)) & (cosines > -1 + 1e-9)
    bends = _crossing(np.where(is_there[:, np.newaxis], axes, 0))
    shares = 1 / np.where(is_there, 1 + cosines, 1)
    tilts: Numbers = np.eye(3) + bends + shares[:, np.newaxis, np.newaxis] * (bends @ bends)
    return tilts


def _around(axes: Numbers, angles: Numbers) -> Numbers:
    """Rotations about unit vectors (N, 3); none about 0."""
    bends = _crossing(axes)
    sines, rest = np.sin(angles), 1 - np.cos(angles)
    found: Numbers = np.eye(3) + sines[:, np.newaxis, np.newaxis] * bends
    found += rest[:, np.newaxis, np.newaxis] * (bends @ bends)
    return found


def _crossing(vectors: Numbers) -> Numbers:
    """The matrices (N, 3, 3) of the cross products with vectors (N, 3)."""
    crossed: Numbers = np.cross(vectors[:, np.newaxis, :], np.eye(3)).transpose(0, 2, 1)
    return crossed


def _dot(one: Numbers, other: Numbers) -> Numbers:
    found: Numbers = np.einsum("ij,ij->i", one, other)
    return found


def _unit(vectors: Numbers) -> Numbers:
    """Vectors (N, 3) of length 1; 0 stays 0."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)


def rotation_of(products: Numbers) -> Numbers:
    """The rotation R that makes the trace of Rᵀ M largest, for M of (3, 3) (Kabsch 1976)."""
    left, _, right = np.linalg.svd(products)
    left[:, 2] *= np.sign(np.linalg.det(left @ right))
    return left @ right
