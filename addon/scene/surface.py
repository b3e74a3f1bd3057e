"""Reading the surface of an object."""

from dataclasses import dataclass

import bpy
import numpy as np
import spectral_tv

from .objects import Refusal
from .records import coordinates
from .seams import close


@dataclass(frozen=True)
class Surface:
    """The Basis shape of a mesh object as triangles in world scale, its seams closed.

    ``mesh`` has the rotation and scale of the object applied, not its location; ``matrix``
    (3, 3) is what was applied, ``inverse`` takes displacements back to object space. Its vertices
    are those of the object that ``kept`` names; ``place`` tells where every vertex of the object
    is among them.
    """

    mesh: spectral_tv.Mesh
    matrix: np.ndarray
    inverse: np.ndarray
    kept: np.ndarray
    place: np.ndarray

    @classmethod
    def read(cls, obj: bpy.types.Object) -> "Surface":
        """Read ``obj``; polygons become the triangles that Blender draws.

        Raises Refusal if the object's scale is zero along an axis, spectral_tv.MeshError if
        the mesh cannot be used.
        """
        to_world = np.array(obj.matrix_world.to_3x3(), dtype=np.float64)
        if np.linalg.matrix_rank(to_world) < 3:
            raise Refusal("its scale is zero along an axis")
        vertices, corners = basis_coordinates(obj.data), triangles(obj.data)
        if np.isfinite(vertices).all():
            kept, place = close(vertices, corners)
        else:  # refused below, with the number of the vertex in the object
            kept = place = np.arange(len(vertices))
        mesh = spectral_tv.Mesh(vertices[kept] @ to_world.T, place[corners])
        return cls(mesh, to_world, np.linalg.inv(to_world), kept, place)

    def to_world(self, vertices: np.ndarray) -> np.ndarray:
        """Object-space positions of the object's vertices as positions of the mesh's."""
        return vertices[self.kept] @ self.matrix.T

    def merge(self, values: np.ndarray) -> np.ndarray:
        """Values of the object's vertices (V, C) as those of the mesh's.

        Where a seam is closed, they are the means of those that are one.
        """
        count = np.bincount(self.place)
        sums = [np.bincount(self.place, channel) for channel in values.T]
        return np.column_stack(sums) / count[:, np.newaxis]

    def to_object(self, displacements: np.ndarray) -> np.ndarray:
        """Displacements (K, N, 3) of the mesh's vertices as those of the object's, (K, V, 3)."""
        return (displacements @ self.inverse.T)[:, self.place]


def basis_coordinates(mesh: bpy.types.Mesh) -> np.ndarray:
    """Positions of the Basis shape key, or of the mesh where it has none, (V, 3)."""
    keys = mesh.shape_keys
    source = mesh.vertices if keys is None else keys.reference_key.data
    return coordinates(source).reshape(-1, 3).astype(np.float64)


def triangles(mesh: bpy.types.Mesh) -> np.ndarray:
    """Vertices of the triangles of the mesh's polygons, (F, 3)."""
    mesh.calc_loop_triangles()
    corners = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return corners.reshape(-1, 3)
