"""A surface taken to another one as a whole, by iterated closest points."""

from collections.abc import Callable
from itertools import product

import numpy as np
from numpy.typing import NDArray

from spectral_tv._frames import rotation_of
from spectral_tv._native import Mesh, Nearest

Numbers = NDArray[np.float64]
# Of points and normals, (S, 3), the nearest places of the source that face as these, (S, 3), and
# how far they are, (S,), infinity where there is none.
Search = Callable[[Numbers, Numbers], tuple[Numbers, Numbers]]

# Samples of the target that beginnings are tried with, and that the best of them is refined with.
FEW, MANY = 400, 2000
# Rounds of either.
TRIED, REFINED = 12, 100
# The share of the samples that counts: the others may have nothing to go to.
COUNTING = 0.8
# Places that move less, relative to the size, have settled.
SETTLED = 1e-7
# How much better another beginning has to be than that where the surfaces are.
BETTER = 0.8


def fitted(
    nearest: Nearest, source: Mesh, target: Mesh, normals: Numbers, scales: bool
) -> tuple[Numbers, float]:
    """What takes the source to the target, (4, 4), and the median distance of the samples then.

    ``normals`` (N, 3) are those of the target's vertices; ``scales`` says whether it may scale.
    """
    corners = source.vertices[source.triangles]

    def search(points: Numbers, normals: Numbers) -> tuple[Numbers, Numbers]:
        faces, weights, distances = nearest.find(points, normals, np.inf)
        return np.einsum("nk,nkj->nj", weights, corners[faces]), distances

    points, areas = target.vertices, target.vertex_areas
    random = np.random.default_rng(0)
    count = min(MANY, np.count_nonzero(areas))
    chosen = random.choice(len(points), count, False, areas / areas.sum())
    few = chosen[:FEW]
    tried = [
        _refined(search, points[few], normals[few], start, scales, TRIED)
        for start in _starts(source, target, scales)
    ]
    best = min(tried[1:], key=lambda each: each[1])
    best = best if best[1] < BETTER * tried[0][1] else tried[0]
    return _refined(search, points[chosen], normals[chosen], best[0], scales, REFINED)


def _starts(source: Mesh, target: Mesh, scales: bool) -> list[Numbers]:
    """Where to begin: as they are, then with the same middle, then also with the same axes."""
    (own, own_axes), (other, other_axes) = _axes(source), _axes(target)
    size = np.sqrt(target.area / source.area) if scales else 1.0
    found = [np.eye(4), _motion(size * np.eye(3), own, other)]
    for signs in product((1, -1), repeat=2):
        flips = np.diag([*signs, signs[0] * signs[1]])
        turn = other_axes @ flips @ own_axes.T
        found.append(_motion(size * turn, own, other))
    return found


def _axes(mesh: Mesh) -> tuple[Numbers, Numbers]:
    """The middle of a surface, and its principal axes as the columns of a rotation."""
    points, areas = mesh.vertices, mesh.vertex_areas / mesh.area
    middle = areas @ points
    away = points - middle
    _, axes = np.linalg.eigh(away.T @ (areas[:, np.newaxis] * away))
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    return middle, axes


def _motion(matrix: Numbers, own: Numbers, other: Numbers) -> Numbers:
    """The affine map (4, 4) of a matrix that takes one point to another."""
    motion = np.eye(4)
    motion[:3, :3], motion[:3, 3] = matrix, other - matrix @ own
    return motion


def _refined(
    search: Search, points: Numbers, normals: Numbers, motion: Numbers, scales: bool, rounds: int
) -> tuple[Numbers, float]:
    """A motion after so many rounds, and the median distance of the points then."""
    size = np.linalg.norm(points - points.mean(axis=0), axis=1).max()
    deviation = np.inf
    for _ in range(rounds):
        back = np.linalg.inv(motion)
        there = points @ back[:3, :3].T + back[:3, 3]
        places, away = search(there, normals @ motion[:3, :3])
        away *= np.cbrt(np.linalg.det(motion[:3, :3]))
        deviation = float(np.median(away))
        counts = away <= np.quantile(away, COUNTING)
        counts &= np.isfinite(away)
        if np.count_nonzero(counts) < 3:
            break
        before, motion = motion, _closest(places[counts], points[counts], scales)
        moved = places @ (motion - before)[:3, :3].T + (motion - before)[:3, 3]
        if np.linalg.norm(moved[counts], axis=1).max() <= SETTLED * size:
            break
    return motion, deviation


def _closest(places: Numbers, points: Numbers, scales: bool) -> Numbers:
    """The motion that takes places nearest to points, by least squares (Umeyama 1991)."""
    own, other = places.mean(axis=0), points.mean(axis=0)
    away = places - own
    products = (points - other).T @ away
    turn = rotation_of(products)
    spread = np.sum(away**2)
    size = np.sum(turn * products) / spread if scales and spread > 0 else 1.0
    return _motion(max(size, 1e-3) * turn, own, other)
