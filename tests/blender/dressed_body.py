"""The production's character with clothes, hair and eyes, and its retopology in the same place."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np
from deform_scene import coordinates, group
from production import character

SHIRT, HAIR, EYES, RETOPOLOGY = "Shirt", "Hair", "Eyes", "Retopology"
CLOTHES = (SHIRT, HAIR, EYES)


def dressed() -> list[bpy.types.Object]:
    """The character, which is active; what is bound to it; and its retopology, all on one rig."""
    body = character()
    body.select_set(False)
    body.data.shade_smooth()
    made = [body, _shirt(body), _hair(body), _eyes(body), _retopology(body)]
    for obj in made:
        obj.select_set(obj == body)
    bpy.context.view_layer.objects.active = body
    return made


def choose(active: str, *others: str) -> bpy.types.Object:
    """Have these be what is selected, and one of them the active object."""
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj.name in (active, *others))
    bpy.context.view_layer.objects.active = bpy.data.objects[active]
    return bpy.data.objects[active]


def _shirt(body) -> bpy.types.Object:
    """Wraps the lower part; open above; with a driven key, materials of its own, and a mask."""
    obj = _around(body, SHIRT, 1.03, segments=20, ring_count=14)
    mesh = bmesh.new()
    mesh.from_mesh(obj.data)
    bmesh.ops.delete(mesh, geom=[v for v in mesh.verts if v.co.z > 0.6], context="VERTS")
    mesh.to_mesh(obj.data)
    mesh.free()
    for name in ("Cloth", "Hem"):
        obj.data.materials.append(bpy.data.materials.new(name))
    count = len(obj.data.polygons)
    obj.data.polygons.foreach_set("material_index", np.arange(count, dtype=np.int32) % 2)
    obj.shape_key_add(name="Basis", from_mix=False)
    tight = obj.shape_key_add(name="Tight", from_mix=False)
    for point in tight.points:
        point.co.x *= 0.98
    tight.driver_add("value").driver.expression = "frame / 40"
    _rigged(obj, body)
    group(obj, "Hem", [v.index for v in obj.data.vertices if v.co.z > 0.4], 0.7)
    obj.modifiers.new("Thickness", "SOLIDIFY").thickness = 0.01
    return obj


def _hair(body) -> bpy.types.Object:
    """Cards that stand on the head, each of four vertices."""
    bpy.ops.mesh.primitive_plane_add(size=2)
    obj = _named(HAIR)
    mesh = bmesh.new()
    uvs = mesh.loops.layers.uv.new("Cards")
    roots = [v for v in body.data.vertices if v.co.z > 0.9]
    for root in roots[::3]:
        across = root.normal.orthogonal() * 0.04
        corners = [root.co - across, root.co + across]
        corners += [corner + 0.2 * root.normal for corner in reversed(corners)]
        face = mesh.faces.new([mesh.verts.new(corner) for corner in corners])
        for loop, uv in zip(face.loops, ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True):
            loop[uvs].uv = uv
    mesh.to_mesh(obj.data)
    mesh.free()
    obj.data.materials.append(bpy.data.materials.new("Strands"))
    _rigged(obj, body)
    return obj


def _eyes(body) -> bpy.types.Object:
    """Two balls without shape keys, which hang on the bone."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8, radius=0.15)
    obj = _named(EYES)
    points = coordinates(obj.data.vertices)
    mesh = bmesh.new()
    mesh.from_mesh(obj.data)
    other = bmesh.ops.duplicate(mesh, geom=mesh.faces[:])["geom"]
    bmesh.ops.translate(
        mesh,
        verts=[each for each in other if isinstance(each, bmesh.types.BMVert)],
        vec=(0.6, 0, 0),
    )
    bmesh.ops.translate(mesh, verts=mesh.verts, vec=(-0.3, -0.75, 0.7))
    mesh.to_mesh(obj.data)
    mesh.free()
    assert len(obj.data.vertices) == 2 * len(points)
    obj.data.materials.append(bpy.data.materials.new("Iris"))
    bpy.context.view_layer.update()
    obj.matrix_world = body.matrix_world
    rig = bpy.data.objects["Rig"]
    there = obj.matrix_world.copy()
    obj.parent, obj.parent_type, obj.parent_bone = rig, "BONE", "Bone"
    bpy.context.view_layer.update()
    obj.matrix_world = there
    return obj


def _retopology(body) -> bpy.types.Object:
    """Of another count of faces, with a driven key; in the place of the body."""
    obj = _around(body, RETOPOLOGY, 1.0, segments=32, ring_count=20)
    obj.data.materials.append(bpy.data.materials.new("Low"))
    obj.shape_key_add(name="Basis", from_mix=False)
    smile = obj.shape_key_add(name="Smile", from_mix=False)
    for point in smile.points:
        point.co.x *= 1 + 0.2 * max(point.co.z, 0)
    smile.driver_add("value").driver.expression = "frame / 20"
    _rigged(obj, body)
    return obj


def _around(body, name: str, scale: float, **detail: int) -> bpy.types.Object:
    """A sphere of other detail whose vertices lie on the body, times a scale."""
    bpy.ops.mesh.primitive_uv_sphere_add(**detail)
    obj = _named(name)
    points = coordinates(obj.data.vertices)
    points *= 1 + 0.06 * np.sin(9 * points[:, :1]) * np.cos(7 * points[:, 1:2])
    points[:, 2] *= 1.5
    obj.data.vertices.foreach_set("co", (scale * points).astype(np.float32).ravel())
    obj.data.shade_smooth()
    return obj


def _named(name: str) -> bpy.types.Object:
    obj = bpy.context.object
    obj.name = obj.data.name = name
    return obj


def _rigged(obj, body) -> None:
    """Have it be where the body is, and bend as that does."""
    obj.parent = rig = bpy.data.objects["Rig"]
    obj.rotation_euler, obj.scale = body.rotation_euler, body.scale
    group(obj, "Bone", [v.index for v in obj.data.vertices if v.co.z > 0])
    obj.modifiers.new("Armature", "ARMATURE").object = rig
