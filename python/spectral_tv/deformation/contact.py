"""What goes wrong with the faces of a posed surface: they cross one another, or turn over."""

from __future__ import annotations

from collections.abc import Generator
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.steps import Step
from spectral_tv.later import np
from spectral_tv.notes import note

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Contact:
    """How many triangles pass through others, but do not at rest, and how many are turned over."""

    crossing: int = 0
    turned_over: int = 0

    def note(self, where: str = "") -> None:
        """Note them; ``where`` says of what, after a noun."""
        if self.crossing:
            note(
                f"{_triangles(self.crossing, 'passes', 'pass')} through others{where}, unlike at "
                "rest: the surface runs into itself. Move the handles less far, or add one between"
            )
        if self.turned_over:
            note(
                f"{_triangles(self.turned_over, 'is', 'are')} turned over{where}: the joint is "
                "bent further than its faces allow. A higher Joint Softness spreads the bend"
            )


class Rest:
    """A surface at rest, against which poses are looked at."""

    def __init__(self, mesh: spectral_tv.Mesh) -> None:
        """Take the mesh; what crosses at rest is found when it is asked for."""
        self._mesh = mesh
        self._crossing: NDArray[Any] | None = None

    def look(self, pose: Any, start: float, end: float) -> Generator[Step, Any, Contact]:
        """Look at a pose; progress goes from ``start`` to ``end``."""
        shift = pose.vertices - self._mesh.vertices
        found = yield spectral_tv.start_self_intersections(self._mesh, shift), (start + end) / 2
        if not len(found):
            return Contact(0, _turned_over(self._mesh, pose))
        if self._crossing is None:
            self._crossing = yield spectral_tv.start_self_intersections(self._mesh), end
        new = np.setdiff1d(found, np.asarray(self._crossing))
        return Contact(len(new), _turned_over(self._mesh, pose))


def _turned_over(mesh: spectral_tv.Mesh, pose: Any) -> int:
    """Faces that look the other way than the rotation of their corners says."""
    faces = mesh.triangles
    corners = pose.rotations[faces]
    # A quaternion and its negative are the same rotation.
    signs = np.where((corners * corners[:, :1]).sum(axis=2) < 0, -1.0, 1.0)
    mean = (signs[..., np.newaxis] * corners).sum(axis=1)
    rest, posed = (_normals(points[faces]) for points in (mesh.vertices, pose.vertices))
    turned = _turned(mean, rest)
    is_flat = np.linalg.norm(rest, axis=1) <= 1e-5 * _longest(mesh.vertices[faces]) ** 2
    return int(np.count_nonzero(((turned * posed).sum(axis=1) < 0) & ~is_flat))


def _normals(corners: NDArray[Any]) -> NDArray[Any]:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _longest(corners: NDArray[Any]) -> NDArray[Any]:
    """The longest edge of each face."""
    edges = corners - np.roll(corners, 1, axis=1)
    return np.linalg.norm(edges, axis=2).max(axis=1)


def _turned(quaternions: NDArray[Any], vectors: NDArray[Any]) -> NDArray[Any]:
    """Vectors turned by quaternions w, x, y, z, and longer by the squares of their norms."""
    scalar, vector = quaternions[:, :1], quaternions[:, 1:]
    twice = 2 * np.cross(vector, vectors)
    norm = (quaternions**2).sum(axis=1, keepdims=True)
    return norm * vectors + scalar * twice + np.cross(vector, twice)


def _triangles(count: int, one: str, several: str) -> str:
    return f"1 triangle {one}" if count == 1 else f"{count} triangles {several}"
