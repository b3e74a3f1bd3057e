"""How far handles turn where that has no effect.

Total variation shifts the pieces at a handle, and does not turn them. Pose turns them with their
handle, unless they are free to turn.
"""

from __future__ import annotations

import math

import bpy
from spectral_tv.deformation.settings import ALGORITHMS, TURNING, label_of
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from .constraints import SpectralTVConstraint, deformation_of, identified

# Degrees, and the part of a size, below which nobody sees it.
NOTICED, NOTICED_GROWTH = 5.0, 0.03


def counting(obj: bpy.types.Object, algorithm: str) -> list[int]:
    """Identifiers of the constraints of ``obj`` whose turns have no effect."""
    found = identified(obj).items()
    if algorithm == "POSE":
        return [owner for owner, constraint in found if constraint.is_free]
    return [] if algorithm in TURNING else [owner for owner, _ in found]


def of_handles(obj: bpy.types.Object) -> float:
    """The largest angle, in degrees, by which a handle of ``obj`` was seen turned since its rest.

    It is for drawing: nothing is evaluated, and what cannot be told counts as 0.
    """
    constraints = identified(obj)
    counts = counting(obj, deformation_of(obj).algorithm)
    return max([0.0, *(of_handle(constraints[owner]) for owner in counts)])


def of_handle(constraint: SpectralTVConstraint) -> float:
    """The same for one handle."""
    if constraint.kind != "OBJECT":
        return 0.0
    try:
        return _angle(constraint.motion(None)[:3, :3])
    except Refusal:
        return 0.0


def of_points(owners: np.ndarray, before: np.ndarray, after: np.ndarray) -> float:
    """The largest angle, in degrees, by which one of several sets of points turned.

    ``owners`` (K,) tells the sets apart; ``before`` and ``after`` are their points, (K, 3).
    """
    angles = [0.0]
    for owner in np.unique(owners):
        one, other = (points[owners == owner] for points in (before, after))
        one, other = one - one.mean(axis=0), other - other.mean(axis=0)
        angles.append(_angle(other.T @ one))
    return max(angles)


def growth_of_points(owners: np.ndarray, before: np.ndarray, after: np.ndarray) -> float:
    """The largest factor by which one of several sets of points grew, or shrank; as `of_points`."""
    factors = [1.0]
    for owner in np.unique(owners):
        one, other = (
            np.linalg.norm(points - points.mean(axis=0))
            for points in (before[owners == owner], after[owners == owner])
        )
        if one > 0 and np.isfinite(other):
            factors.append(max(other / one, one / max(other, 1e-9 * one)))
    return max(factors)


def told_growth(factor: float) -> str | None:
    """Say that pieces that are free to turn do not grow with their handles; None if none grows."""
    if factor < 1 + NOTICED_GROWTH:
        return None
    return (
        f"handles are scaled by up to {factor:.3g}, but what they move is free to turn, and keeps "
        "its size: Turn with Handle has it grow with them"
    )


def told(angle: float, algorithm: str) -> str | None:
    """Say that pieces do not turn as their handles do; None where they do, or nothing turns."""
    if angle < NOTICED:
        return None
    if algorithm == "POSE":
        return (
            f"handles are turned by up to {angle:.0f}°, but what they move is free to turn: "
            "Turn with Handle has it turn with them"
        )
    if algorithm in TURNING:
        return None
    labels = " and ".join(label_of(each) for each, *_ in ALGORITHMS if each in TURNING)
    return (
        f"handles are turned by up to {angle:.0f}°: {label_of(algorithm)} moves the pieces at them "
        f"without turning them, {labels} turn them"
    )


def _angle(matrix: np.ndarray) -> float:
    """The angle, in degrees, of the rotation nearest to a matrix; 0 where several are."""
    if not np.isfinite(matrix).all():
        return 0.0
    left, sizes, right = np.linalg.svd(matrix)
    sign = np.sign(np.linalg.det(left @ right))
    # Points on a line, or reflected, say nothing of one direction or all.
    if not sizes[1] > 1e-6 * sizes[0] or (sign < 0 and sizes[1] - sizes[2] < 1e-6 * sizes[0]):
        return 0.0
    rotation = left @ np.diag([1.0, 1.0, sign]) @ right
    return math.degrees(math.acos(np.clip((np.trace(rotation) - 1) / 2, -1, 1)))
