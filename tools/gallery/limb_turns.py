"""Limbs, heads and tails that are turned in the figures of poses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import spectral_tv
from scipy.spatial.transform import Rotation

from .page import Shape

Vector = tuple[float, float, float]
# Of the height: what stands on the ground is held.
FEET = 0.06


@dataclass(frozen=True)
class Part:
    """What of a shape is pulled, and how: it turns about an axis through a place.

    Places are in the bounding box, from (0, 0, 0) to (1, 1, 1): x to the right, z up, seen from the
    front. Angles are in degrees.
    """

    title: str
    is_in: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
    centre: Vector
    axis: Vector
    degrees: float


PARTS = {
    "man": Part("arm", lambda x, _y, z: (x > 0.92) & (z > 0.4), (0.7, 0.5, 0.78), (0, -1, 0), 90),
    "dragon": Part(
        "tail", lambda x, _y, z: (x < 0.09) & (z < 0.5), (0.2, 0.7, 0.12), (0, -1, 0), 70
    ),
    "armadillo": Part(
        "hand", lambda x, _y, z: (x > 0.88) & (z > 0.5), (0.68, 0.5, 0.72), (0, -1, 0), 60
    ),
    "cheburashka": Part(
        "head", lambda x, _y, z: (z > 0.9) & (abs(x - 0.5) < 0.2), (0.5, 0.5, 0.58), (0, 1, 0), 40
    ),
    "michael0": Part("forearm", lambda x, _y, _z: x > 0.93, (0.74, 0.4, 0.8), (0, -1, 0), 90),
}


class LimbTurn:
    """A shape that stands on its feet, and a part of which is turned.

    The part is a free body of which the way of its centre is given, or it is turned along.
    """

    def __init__(self, name: str, shape: Shape, part: Part, *, is_turned: bool = False) -> None:
        """Look for the feet and for the part."""
        self.name, self.shape, self.part, self.is_turned = name, shape, part, is_turned
        self.mesh = shape.mesh
        low, size = shape.vertices.min(axis=0), np.ptp(shape.vertices, axis=0)
        x, y, z = ((shape.vertices - low) / size).T
        pulled = np.flatnonzero(part.is_in(x, y, z))
        held = np.setdiff1d(np.flatnonzero(z < FEET), pulled)
        self.indices = np.concatenate([held, pulled])
        self.is_pulled = np.arange(len(self.indices)) >= len(held)
        self.bodies = np.where(self.is_pulled & (not is_turned), 0, -1)
        self.centre = low + size * part.centre

    def targets(self, share: float = 1.0) -> np.ndarray:
        """Where the feet and the part are after a share of the turn, (K, 3)."""
        axis = np.array(self.part.axis) / np.linalg.norm(self.part.axis)
        turn = Rotation.from_rotvec(np.radians(share * self.part.degrees) * axis)
        rest = self.shape.vertices[self.indices]
        turned = turn.apply(rest - self.centre) + self.centre
        if not self.is_turned:
            middles = rest[self.is_pulled].mean(axis=0), turned[self.is_pulled].mean(axis=0)
            turned = rest + middles[1] - middles[0]
        return np.where(self.is_pulled[:, None], turned, rest)

    def poser(self) -> spectral_tv.Poser:
        """What follows the part."""
        return spectral_tv.Poser(self.mesh, self.indices, bodies=self.bodies)

    def posed(self, share: float = 1.0) -> spectral_tv.Pose:
        """The pose for a share of the turn, from rest at once."""
        targets = self.targets(share)
        return spectral_tv.pose(self.mesh, self.indices, targets, bodies=self.bodies)

    def deformed(self, algorithm: str, share: float = 1.0) -> np.ndarray:
        """The deformation by an algorithm of `spectral_tv.deform`, (V, 3)."""
        targets = self.targets(share)
        return spectral_tv.deform(self.mesh, self.indices, targets, algorithm=algorithm).vertices
