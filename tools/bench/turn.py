"""A task for poses: one end of a mesh is held, the other is turned."""

from __future__ import annotations

import numpy as np
import spectral_tv

LOW, HIGH = 0.05, 0.07
DEGREES = 60


class Turn:
    """A mesh that is held at one end of its longest axis, and turned about its middle at the other.

    The end that is turned is a handle, which is either *free*, where the way of its centre is given
    and the pose finds how it turns, or else *turned* along.
    """

    def __init__(
        self, name: str, vertices: np.ndarray, triangles: np.ndarray, *, is_free: bool
    ) -> None:
        """Hold the lowest 5 % of the vertices, and take the highest 7 % as the handle."""
        self.name, self.vertices, self.triangles = name, vertices, triangles
        self.is_free = is_free
        self.axis = int(np.ptp(vertices, axis=0).argmax())
        along = vertices[:, self.axis]
        low, high = np.quantile(along, [LOW, 1 - HIGH])
        self.indices = np.flatnonzero((along < low) | (along > high))
        self.is_handle = along[self.indices] > high
        self.rest = vertices[self.indices]
        self.middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
        self.diagonal = float(np.linalg.norm(np.ptp(vertices, axis=0)))

    @property
    def way(self) -> str:
        """How the handle is moved."""
        return "free" if self.is_free else "turned"

    def targets(self, part: float = 1.0) -> np.ndarray:
        """The targets of a pose for a part of the turn, (K, 3)."""
        angle = np.radians(DEGREES * part)
        turn = np.eye(3)
        one, other = (self.axis + 1) % 3, (self.axis + 2) % 3
        turn[[one, other], [one, other]] = 1.0
        turn[[self.axis, one], [self.axis, one]] = np.cos(angle)
        turn[self.axis, one], turn[one, self.axis] = -np.sin(angle), np.sin(angle)
        turned = (self.rest - self.middle) @ turn.T + self.middle
        return np.where(self.is_handle[:, None], turned, self.rest)

    def poser(self) -> spectral_tv.Poser:
        """What poses the mesh."""
        bodies = np.where(self.is_handle, 0, -1) if self.is_free else None
        mesh = spectral_tv.Mesh(self.vertices, self.triangles)
        return spectral_tv.Poser(mesh, self.indices, bodies=bodies)

    def motion(self, targets: np.ndarray) -> np.ndarray:
        """The rigid motion of the handle to `targets` (K, 3), as a matrix (4, 4)."""
        before, after = self.rest[self.is_handle], targets[self.is_handle]
        centres = before.mean(axis=0), after.mean(axis=0)
        left, _, right = np.linalg.svd((after - centres[1]).T @ (before - centres[0]))
        left[:, 2] *= np.linalg.det(left @ right)
        motion = np.eye(4)
        motion[:3, :3] = left @ right
        motion[:3, 3] = centres[1] - motion[:3, :3] @ centres[0]
        return motion

    def distance(self, one: np.ndarray, other: np.ndarray) -> float:
        """The largest distance of a vertex in one shape (V, 3) and another, over the diagonal."""
        return float(np.linalg.norm(one - other, axis=1).max()) / self.diagonal
