"""Things bound to a surface, which follow what displaces it."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_tv._frames import Links, turns, vertex_normals
from spectral_tv._native import Mesh, MeshError, Nearest
from spectral_tv._results import Numbers, _Result

#: How much of its height above the surface a point keeps at least.
KEPT = 0.1
#: How often points that would go inside are pushed out.
ROUNDS = 6


@dataclass(frozen=True, eq=False)
class Carried(_Result):
    """What displacements of a surface do to points bound to it, found by `carry`.

    Attributes
    ----------
    displacements : array
        By what each of K displacements moves the points, (K, N, 3), length.
    pushed : bool array
        Which points were pushed out, as they would have gone inside, (N,).
    inside : bool array
        Which points outside the surface go inside all the same at a gain of up to 1, (N,).
    inside_below : bool array
        Which do so at a gain of −1 of one displacement or of all, (N,).
    """

    displacements: Numbers = field(repr=False)
    pushed: NDArray[np.bool_] = field(repr=False)
    inside: NDArray[np.bool_] = field(repr=False)
    inside_below: NDArray[np.bool_] = field(repr=False)


@dataclass(frozen=True)
class _Surface:
    """A surface with places on it that are nearest to points."""

    vertices: Numbers
    triangles: NDArray[np.int64]

    def places(self, points: Numbers) -> tuple[NDArray[np.int64], Numbers, Numbers, Numbers]:
        """Of the nearest places the corners and their shares, (N, 3); heights of the points above
        them, (N,), below 0 inside; and unit normals, (N, 3)."""
        nearest = Nearest.of(self.vertices, self.triangles)
        faces, weights, _ = nearest.find(points, np.zeros(points.shape), np.inf)
        corners = self.triangles[faces]
        normals = vertex_normals(self.vertices, self.triangles)
        there = np.einsum("nk,nkj->nj", weights, normals[corners])
        there /= np.maximum(np.linalg.norm(there, axis=1, keepdims=True), 1e-300)
        away = points - np.einsum("nk,nkj->nj", weights, self.vertices[corners])
        heights = np.linalg.norm(away, axis=1) * np.sign(np.einsum("nj,nj->n", away, there))
        return corners, weights, heights, there


def carry(mesh: Mesh, displacements: ArrayLike, points: ArrayLike) -> Carried:
    """Have points follow displacements of a surface, as clothes follow a body.

    Each point is bound to the nearest place of the surface. It moves as that does, and is turned
    about it as the surface around is. A point outside keeps a tenth of its height at least where
    one displacement, some from the first on, some to the last, or all have gains up to 1: where it
    would go farther in, it is pushed out, along the normal of the displaced surface.

    Parameters
    ----------
    mesh : Mesh
        The surface of V vertices.
    displacements : (K, V, 3) array
        What is added to it at gains, such as its bands; lengths.
    points : (N, 3) array
        What follows.

    Returns
    -------
    Carried

    Raises
    ------
    MeshError
        If the displacements are not of the mesh or something is not finite.
    """
    moves, points = np.asarray(displacements, dtype=np.float64), np.array(points, dtype=np.float64)
    vertices, triangles = mesh.vertices, mesh.triangles
    if moves.ndim != 3 or moves.shape[1:] != vertices.shape or not np.isfinite(moves).all():
        raise MeshError(
            f"displacements must be finite, of the shape (K, {len(vertices)}, 3), not {moves.shape}"
        )
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise MeshError(f"points must be finite, of the shape (N, 3), not {points.shape}")
    corners, weights, heights, _ = _Surface(vertices, triangles).places(points)
    away = points - np.einsum("nk,nkj->nj", weights, vertices[corners])
    links, known = Links.of(triangles, len(vertices)), np.ones(len(vertices), dtype=bool)
    found = np.empty((len(moves), *points.shape))
    strengths = np.empty((len(moves), len(points)))
    for number, moved in enumerate(moves):
        turned = turns(links, triangles, vertices, vertices + moved, known)
        around = np.einsum("nk,nkij,nj->ni", weights, turned[corners], away)
        step = np.einsum("nk,nkj->nj", weights, moved[corners])
        found[number] = step + around - away
        strengths[number] = np.linalg.norm(step, axis=1)
    pushed = np.zeros(len(points), dtype=bool)
    for _ in range(ROUNDS):
        is_done = True
        for gains in _gains(len(moves)):
            low, normals = _low(vertices, triangles, moves, found, points, gains)
            lacking = np.where(heights > 0, KEPT * heights - low, 0)
            is_low = lacking > 0
            if not is_low.any():
                continue
            is_done = False
            pushed |= is_low
            # By those that move most there; the sum over them is what lacks.
            shares = gains[:, np.newaxis] * (strengths[:, is_low] + 1e-300)
            shares /= (gains[:, np.newaxis] * shares).sum(axis=0)
            found[:, is_low] += shares[:, :, np.newaxis] * (
                1.05 * lacking[is_low, np.newaxis] * normals[is_low]
            )
        if is_done:
            break
    # Where the last round pushed nothing, nothing is inside.
    above = [] if is_done else [*_gains(len(moves))]
    inside, below = (
        np.any(
            [
                np.zeros(len(points), dtype=bool),
                *(_low(vertices, triangles, moves, found, points, gains)[0] < 0 for gains in tried),
            ],
            axis=0,
        )
        for tried in (above, [*-np.eye(len(moves)), -np.ones(len(moves))])
    )
    return Carried(found, pushed, inside & (heights > 0), below & (heights > 0))


def _gains(count: int) -> Iterator[Numbers]:
    """The gains at which points are looked at: each alone, some from either end, all, and all by
    halves."""
    yield from np.eye(count)
    for number in range(2, count):
        yield (np.arange(count) < number).astype(float)
        yield (np.arange(count) >= count - number).astype(float)
    if count > 1:
        yield np.ones(count)
    yield np.full(count, 0.5)


def _low(
    vertices: Numbers,
    triangles: NDArray[np.int64],
    moves: Numbers,
    found: Numbers,
    points: Numbers,
    gains: Numbers,
) -> tuple[Numbers, Numbers]:
    """The heights of the points above the surface at some gains, (N,), and the normals there."""
    surface = _Surface(vertices + np.tensordot(gains, moves, 1), triangles)
    _, _, heights, normals = surface.places(points + np.tensordot(gains, found, 1))
    return heights, normals
