"""The triangles of a mesh as arrays, with what maps need of their corners."""

from __future__ import annotations

from dataclasses import replace

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..scene.arrays import numbers
from ..scene.coordinates import points
from ..scene.temporary import Temporary

# The UV map of meshes that are made for baking.
UVS = "UVMap"
# Normals that differ by less need not be told to Blender.
SAME_NORMAL = 1e-3


@dataclass(frozen=True)
class Triangles:
    """``positions`` (V, 3) of vertices, and of F triangles: their ``vertices`` (F, 3) and face
    ``corners`` (F, 3), the ``normals`` there (F, 3, 3) as they are shaded, and ``uvs`` (F, 3, 2),
    if any.
    """

    positions: np.ndarray
    vertices: np.ndarray
    corners: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray | None

    @classmethod
    def of(cls, mesh: bpy.types.Mesh, uv_map: str | None = None) -> Triangles:
        """Read a mesh without shape keys, in object space."""
        mesh.calc_loop_triangles()
        corners = numbers(mesh.loop_triangles, "loops", 3).reshape(-1, 3)
        uvs = None
        if uv_map is not None:
            flat = numbers(mesh.uv_layers[uv_map].uv, "vector", 2, np.float32)
            uvs = flat.reshape(-1, 2)[corners]
        vertices = numbers(mesh.loop_triangles, "vertices", 3).reshape(-1, 3)
        normals = _corner_normals(mesh)[corners]
        return cls(points(mesh.vertices), vertices, corners, normals, uvs)

    def moved(self, matrix: np.ndarray) -> Triangles:
        """The same by a matrix (4, 4), without UVs."""
        linear = matrix[:3, :3]
        normals = self.normals @ np.linalg.inv(linear)
        lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
        normals = normals / np.where(lengths > 0, lengths, 1)
        positions = self.positions @ linear.T + matrix[:3, 3]
        return replace(self, positions=positions, normals=normals, uvs=None)

    def normals_in(self, mesh: bpy.types.Mesh) -> np.ndarray:
        """The normals (F, 3, 3) that a mesh with the same face corners has there."""
        return _corner_normals(mesh)[self.corners]

    def mesh(self) -> bpy.types.Mesh:
        """A new mesh of nothing but the triangles, shaded smooth, and their UVs."""
        mesh = bpy.data.meshes.new("Triangles")
        count = len(self.vertices)
        mesh.vertices.add(len(self.positions))
        mesh.loops.add(3 * count)
        mesh.polygons.add(count)
        mesh.vertices.foreach_set("co", self.positions.astype(np.float32).ravel())
        mesh.loops.foreach_set("vertex_index", self.vertices.ravel())
        mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
        if self.uvs is not None:
            layer = mesh.uv_layers.new(name=UVS)
            layer.uv.foreach_set("vector", self.uvs.astype(np.float32).ravel())
        mesh.update()
        return mesh

    def tangents(self) -> tuple[np.ndarray, np.ndarray]:
        """Tangents (F, 3, 3) of the corners by MikkTSpace, and the signs of their bitangents
        (F, 3), as renderers take them of triangles with these normals and UVs."""
        with Temporary() as now:
            mesh = now.made(self.mesh())
            smooth = _corner_normals(mesh)
            normals = self.normals.reshape(-1, 3)
            if np.abs(smooth - normals).max(initial=0) > SAME_NORMAL:
                mesh.normals_split_custom_set(normals.tolist())
            try:
                mesh.calc_tangents(uvmap=UVS)
            except RuntimeError as error:
                raise Refusal(f"its UV map gives no tangents: {error}") from error
            tangents = numbers(mesh.loops, "tangent", 3, np.float32).reshape(-1, 3, 3)
            signs = numbers(mesh.loops, "bitangent_sign", 1, np.float32).reshape(-1, 3)
            return tangents, signs


def shaped(obj: bpy.types.Object, shape: np.ndarray) -> bpy.types.Mesh:
    """A new mesh like that of ``obj``, without shape keys, in a shape (V, 3)."""
    mesh = obj.data.copy()
    if mesh.shape_keys is not None:
        name = mesh.shape_keys.name
        with Temporary() as now:
            now.made(bpy.data.objects.new("Shape", mesh)).shape_key_clear()
        left = bpy.data.shape_keys.get((name, None))
        if left is not None:  # Blender before 5.2 leaves them behind
            bpy.data.batch_remove([left])
    mesh.vertices.foreach_set("co", shape.astype(np.float32).ravel())
    mesh.update()
    return mesh


def _corner_normals(mesh: bpy.types.Mesh) -> np.ndarray:
    return numbers(mesh.corner_normals, "vector", 3, np.float32).reshape(-1, 3)


def flat_share(mesh: bpy.types.Mesh) -> float:
    """Which share of the faces is shaded flat."""
    flat = mesh.attributes.get("sharp_face")
    if flat is None or len(mesh.polygons) == 0:
        return 0.0
    return float(numbers(flat.data, "value", 1, bool).mean())
