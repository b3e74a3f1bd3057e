"""Reading the surface of an object, or of several that belong together."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import spectral_tv
from mathutils import Matrix, Vector
from spectral_tv.bands.joining import joined
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.means import means
from spectral_tv.notes import note

from .coordinates import basis_coordinates, triangles
from .mirroring import Copies, mirrored, single
from .modifiers import symmetries
from .places import linear_of

# Coordinates from here on are no places: Blender keeps an infinite one as its largest number.
NOWHERE = 1e37


@dataclass(frozen=True)
class Reading:
    """How a surface is read: how near corners are joined, in percent of its size, and whether
    faces are left out whose vertices have no finite place.
    """

    weld: float
    leaves_out: bool

    @classmethod
    def of_scene(cls) -> Reading:
        """What is chosen in the sidebar."""
        chosen = bpy.context.scene.spectral_tv
        return cls(chosen.weld, chosen.leaves_out)


@dataclass(frozen=True)
class Surface:
    """A shape of a mesh object as triangles in world scale, joined where corners belong together.

    ``mesh`` has the rotation and scale of the object applied, not its location; ``matrix``
    (3, 3) is what was applied, ``inverse`` takes displacements back to object space. ``place``
    (V,) tells where every vertex of the object is among those of the mesh, −1 for one that is
    left out. Of an object with Mirror modifiers the mesh has the other half too: ``copies``
    tells where. Several objects that are read together have one mesh.
    """

    mesh: spectral_tv.Mesh
    matrix: np.ndarray
    inverse: np.ndarray
    place: np.ndarray
    copies: Copies

    @classmethod
    def read(
        cls, obj: bpy.types.Object, shape: np.ndarray | None = None, reading: Reading | None = None
    ) -> Surface:
        """Read ``obj`` in a shape (V, 3) of its own, Basis if None; see `read_together`."""
        return cls.read_together([obj], [shape], reading)[0]

    @classmethod
    def read_together(
        cls,
        objects: Sequence[bpy.types.Object],
        shapes: Sequence[np.ndarray | None],
        reading: Reading | None = None,
    ) -> list[Surface]:
        """Read objects as one surface; polygons become the triangles that Blender draws.

        Without a ``reading`` that of the scene counts. Raises Refusal if an object's scale is
        zero along an axis or a vertex has no finite place, spectral_tv.MeshError if the mesh
        cannot be used.
        """
        parts = [
            _Part.read(obj, shape, objects[0]) for obj, shape in zip(objects, shapes, strict=True)
        ]
        return cls._joined(parts, reading or Reading.of_scene())

    @classmethod
    def read_mesh(cls, mesh: bpy.types.Mesh, matrix: Matrix, reading: Reading) -> Surface:
        """Read a mesh that an object with this matrix in the world would have."""
        return cls._joined([_Part.of_mesh(mesh, matrix)], reading)[0]

    @classmethod
    def read_arrays(
        cls, shape: np.ndarray, corners: np.ndarray, matrix: Matrix, reading: Reading
    ) -> Surface:
        """Read vertices (V, 3) and triangles (F, 3) of a mesh that such an object would have."""
        return cls._joined([_Part.of_arrays(shape, corners, matrix)], reading)[0]

    @classmethod
    def _joined(cls, parts: Sequence[_Part], reading: Reading) -> list[Surface]:
        firsts = np.cumsum([0, *(len(part.copies.positions) for part in parts)])
        positions = np.concatenate([part.positions for part in parts])
        corners = np.concatenate(
            [part.corners + first for part, first in zip(parts, firsts, strict=False)]
        )
        mesh = joined(positions, corners, reading.weld, reading.leaves_out)
        return [
            cls(
                mesh,
                part.matrix,
                np.linalg.inv(part.matrix),
                mesh.weld_map[part.copies.places[0] + first],
                Copies(
                    part.copies.turns,
                    part.copies.positions,
                    mesh.weld_map[part.copies.places + first],
                    part.copies.is_flipped,
                ),
            )
            for part, first in zip(parts, firsts, strict=False)
        ]

    def is_of(self, mesh: bpy.types.Mesh) -> bool:
        """Whether a mesh has its vertices at the places where they were read, in object space."""
        shape, places = basis_coordinates(mesh), self.copies.positions
        is_there = (np.abs(shape) < NOWHERE).all(axis=1)
        return len(shape) == len(self.place) and np.array_equal(shape[is_there], places[is_there])

    @property
    def metric(self) -> np.ndarray:
        """What lengths in object space are in the world, (3, 3)."""
        return self.matrix.T @ self.matrix

    def merge(self, values: np.ndarray) -> np.ndarray:
        """Values of the object's vertices (V, C) as those of the mesh's (N, C).

        Where several vertices are one, they are their means.
        """
        return self._gathered(np.broadcast_to(values, (len(self.copies.places), *values.shape)))

    def merge_vectors(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors in object space (V, 3) as those of the mesh's vertices in world scale, (N, 3)."""
        return self._gathered(self.copies.turned(vectors) @ self.matrix.T)

    def to_vertices(self, values: np.ndarray) -> np.ndarray:
        """Values at the mesh's vertices (N, …) as those of the object's, (V, …); 0 if left out."""
        found = np.zeros((len(self.place), *values.shape[1:]), dtype=values.dtype)
        is_there = self.place >= 0
        found[is_there] = values[self.place[is_there]]
        return found

    def to_object(self, displacements: np.ndarray) -> np.ndarray:
        """Displacements (K, N, 3) of the mesh's vertices as those of the object's, (K, V, 3).

        The halves of a mirrored object move alike, so that what is on a plane of symmetry stays.
        """
        found = np.zeros((len(displacements), len(self.place), 3))
        back = np.linalg.inv(self.copies.turns) @ self.inverse
        for places, turn in zip(self.copies.places, back, strict=True):
            is_there = places >= 0
            found[:, is_there] += (displacements @ turn.T)[:, places[is_there]]
        return found / len(self.copies.places)

    def _gathered(self, values: np.ndarray) -> np.ndarray:
        """Means (N, C) at the mesh's vertices of values (copies, V, C)."""
        is_there = self.copies.places >= 0
        return means(self.copies.places[is_there], values[is_there], len(self.mesh.vertex_areas))


def shape_of(surfaces: Sequence[Surface], shapes: Sequence[np.ndarray]) -> np.ndarray:
    """Shapes (V, 3) of objects that were read together as one of their mesh, (N, 3)."""
    moves = [
        shape - surface.copies.positions[: len(shape)]
        for surface, shape in zip(surfaces, shapes, strict=True)
    ]
    return surfaces[0].mesh.vertices + moves_of(surfaces, moves)


def moves_of(surfaces: Sequence[Surface], moves: Sequence[np.ndarray]) -> np.ndarray:
    """Displacements (V, 3) of objects that were read together as those of their mesh, (N, 3)."""
    found = np.zeros((len(surfaces[0].mesh.vertex_areas), 3))
    for surface, moved in zip(surfaces, moves, strict=True):
        mine = np.unique(surface.copies.places[surface.copies.places >= 0])
        # Where several meet, they move alike.
        found[mine] = surface.merge_vectors(moved)[mine]
    return found


def flattened(surface: Surface) -> np.ndarray:
    """The mesh of a surface pressed flat along the Z axis of its object, (N, 3)."""
    local = surface.mesh.vertices @ surface.inverse.T
    local[:, 2] = local[:, 2].min()
    return local @ surface.matrix.T


@dataclass(frozen=True)
class _Part:
    """One object of a surface: its copies, where they are in the world, and their triangles."""

    copies: Copies
    matrix: np.ndarray
    positions: np.ndarray
    corners: np.ndarray

    @classmethod
    def read(
        cls, obj: bpy.types.Object, shape: np.ndarray | None, origin: bpy.types.Object
    ) -> _Part:
        """An object in a shape of its own, or Basis; distances are from the object ``origin``."""
        corners = triangles(obj.data, shape)
        shape = basis_coordinates(obj.data) if shape is None else shape
        copies = mirrored(obj, _without_strays(shape, corners), symmetries(obj))
        shift = obj.matrix_world.translation - origin.matrix_world.translation
        return cls._placed(copies, corners, obj.matrix_world, shift)

    @classmethod
    def of_mesh(cls, mesh: bpy.types.Mesh, matrix: Matrix) -> _Part:
        """A mesh by itself."""
        return cls.of_arrays(basis_coordinates(mesh), triangles(mesh), matrix)

    @classmethod
    def of_arrays(cls, shape: np.ndarray, corners: np.ndarray, matrix: Matrix) -> _Part:
        """Vertices and triangles by themselves."""
        return cls._placed(single(_without_strays(shape, corners)), corners, matrix, Vector())

    @classmethod
    def _placed(
        cls, copies: Copies, corners: np.ndarray, matrix_world: Matrix, shift: Vector
    ) -> _Part:
        matrix = linear_of(matrix_world)
        turned = [
            places[corners[:, ::-1] if is_flipped else corners]
            for places, is_flipped in zip(copies.places, copies.is_flipped, strict=True)
        ]
        is_nowhere = np.isnan(copies.positions)
        positions = np.where(is_nowhere, 0.0, copies.positions) @ matrix.T + np.array(shift)
        # A coordinate in the world has no place if it depends on one that has none.
        positions[is_nowhere @ (matrix != 0).T] = np.nan
        return cls(copies, matrix, positions, np.concatenate(turned))


def _without_strays(shape: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The shape with NaN for coordinates that are nowhere, and vertices in no face at any place."""
    shape = np.where(np.abs(shape) < NOWHERE, shape, np.nan)
    is_nowhere = np.isnan(shape).any(axis=1)
    is_stray = is_nowhere.copy()
    is_stray[corners] = False
    count = np.count_nonzero(is_stray)
    if count and count < len(shape):
        shape[is_stray] = shape[~is_stray][0]
        what = "1 vertex in no face has" if count == 1 else f"{count} vertices in no face have"
        note(f"{what} no finite place, and no part in this")
    return shape
