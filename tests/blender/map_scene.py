"""A scan with bands and a low-poly mesh in its place, and maps as they are in files."""

from __future__ import annotations

from pathlib import Path

import bmesh
import bpy
import numpy as np
import pytest
from ball import object_of
from deform_scene import coordinates
from mathutils.bvhtree import BVHTree
from shapes import bumpy_sphere

BANDS = {"bands": 3, "steps": 8}
DISPLACEMENTS = ("DISPLACEMENT", "TANGENT", "OBJECT")


def scan(detail: int = 5, amplitude: float = 0.1) -> bpy.types.Object:
    """A dense sphere with detail of all sizes, the selected and active object; its look has the
    two finest bands raised."""
    obj = object_of("Scan", *bumpy_sphere(detail, amplitude=amplitude))
    obj.data.shade_smooth()
    obj.select_set(True)
    bpy.ops.spectral_tv.decompose(**BANDS)
    keys = obj.data.shape_keys.key_blocks
    keys[1].value, keys[2].value = 1, 0.5
    return obj


def low_poly(segments: int = 32) -> bpy.types.Object:
    """A sphere of few faces with UVs, selected beside what is active."""
    active = bpy.context.view_layer.objects.active
    chosen = bpy.context.selected_objects
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=segments // 2)
    low = bpy.context.object
    low.name = "Low"
    low.data.shade_smooth()
    bpy.context.view_layer.objects.active = active
    for obj in chosen:
        obj.select_set(True)
    return low


def sphere_with_uvs() -> bpy.types.Object:
    """A dense sphere with UVs and a bumpy look, the selected and active object."""
    bpy.ops.object.select_all(action="DESELECT")
    obj = low_poly(64)
    bpy.context.view_layer.objects.active = obj
    # The diagonals of quads would depend on their shape.
    mesh = bmesh.new()
    mesh.from_mesh(obj.data)
    bmesh.ops.triangulate(mesh, faces=mesh.faces)
    mesh.to_mesh(obj.data)
    mesh.free()
    points = coordinates(obj.data.vertices)
    waves = np.sin(points @ np.random.default_rng(3).normal(0, 5, (3, 4))).mean(axis=1)
    points *= 1 + 0.2 * waves[:, np.newaxis]
    obj.data.vertices.foreach_set("co", points.astype(np.float32).ravel())
    bpy.ops.spectral_tv.decompose(**BANDS)
    keys = obj.data.shape_keys.key_blocks
    keys[2].value, keys[3].value = 2, 2
    return obj


def bake(path: Path | str, **options) -> np.ndarray:
    """What *Bake Map* writes, (side, side, 3) from the bottom."""
    options = {"size": 128, "margin": 4, **options}
    assert bpy.ops.spectral_tv.bake_map(filepath=str(path), **options) == {"FINISHED"}
    return values_of(path)


def refused(match: str, **options) -> None:
    """Make sure that *Bake Map* is refused for this reason."""
    with pytest.raises(RuntimeError, match=match):
        bpy.ops.spectral_tv.bake_map(**{"size": 64, **options})


def values_of(path: Path | str) -> np.ndarray:
    """The values in a file, (height, width, 3) from the bottom."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.is_data = True
    flat = np.empty(image.size[0] * image.size[1] * 4, dtype=np.float32)
    image.pixels.foreach_get(flat)
    found = flat.reshape(image.size[1], image.size[0], 4)[..., :3].astype(np.float64)
    bpy.data.images.remove(image)
    return found


def looked_up(values: np.ndarray, uvs: np.ndarray) -> np.ndarray:
    """A map (side, side, C) at UVs (N, 2), between the middles of texels, (N, C)."""
    side = len(values)
    places = np.clip(uvs * side - 0.5, 0, side - 1)
    first = np.minimum(places.astype(int), side - 2)
    (x, y), (a, b) = first.T, (places - first).T[..., np.newaxis]
    lower = values[y, x] * (1 - a) + values[y, x + 1] * a
    upper = values[y + 1, x] * (1 - a) + values[y + 1, x + 1] * a
    return lower * (1 - b) + upper * b


class Spots:
    """Random spots on a mesh: ``points``, ``normals``, ``tangents`` (N, 3), ``uvs`` (N, 2)."""

    def __init__(self, mesh: bpy.types.Mesh, count: int = 3000) -> None:
        mesh = mesh.copy()
        random = np.random.default_rng(0)
        mesh.calc_loop_triangles()
        mesh.calc_tangents(uvmap=mesh.uv_layers[0].name)
        triangles = list(mesh.loop_triangles)
        chosen = random.choice(len(triangles), count)
        weights = random.dirichlet((1, 1, 1), count)
        corners = [[mesh.loops[loop] for loop in triangles[each].loops] for each in chosen]

        def mean(of) -> np.ndarray:
            values = np.array([[of(corner) for corner in each] for each in corners])
            return np.einsum("nk,nkc->nc", weights, values)

        self.points = mean(lambda corner: mesh.vertices[corner.vertex_index].co)
        self.normals = unit(mean(lambda corner: corner.normal))
        self.tangents = unit(mean(lambda corner: corner.tangent))
        signs = mean(lambda corner: [corner.bitangent_sign])
        self.bitangents = signs * unit(np.cross(self.normals, self.tangents))
        self.uvs = mean(lambda corner: mesh.uv_layers[0].uv[corner.index].vector)
        bpy.data.meshes.remove(mesh)

    def displaced(self, values: np.ndarray, kind: str) -> np.ndarray:
        """Where a map takes the spots, (N, 3)."""
        x, y, z = looked_up(values, self.uvs).T[..., np.newaxis]
        if kind == "DISPLACEMENT":
            return self.points + x * self.normals
        if kind == "TANGENT":
            return self.points + x * self.tangents + y * self.normals + z * self.bitangents
        return self.points + np.hstack([x, y, z])


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def surface(obj: bpy.types.Object) -> BVHTree:
    """What is seen of an object, in its space."""
    graph = bpy.context.evaluated_depsgraph_get()
    return BVHTree.FromObject(obj, graph)


def distances(tree: BVHTree, points: np.ndarray) -> np.ndarray:
    return np.array([tree.find_nearest(point)[3] for point in points])


def amplitude(obj: bpy.types.Object) -> float:
    """How far the look of an object moves its vertices, in the root of the mean square."""
    keys = obj.data.shape_keys.key_blocks
    graph = bpy.context.evaluated_depsgraph_get()
    seen = np.array([each.co for each in obj.evaluated_get(graph).data.vertices])
    moved = seen - np.array([each.co for each in keys[0].points])
    return float(np.sqrt(np.square(moved).sum(axis=1).mean()))
