"""A body of quads with all that production adds: rig, Subdivision, UV maps, driven face keys."""

from __future__ import annotations

import bpy
import numpy as np
from deform_scene import evaluated, group

FRAMES = (1, 7, 20)


def rigged_body() -> bpy.types.Object:
    """The active object, subdivided and posed by an armature on FRAMES."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=16)
    obj = bpy.context.object
    obj.name = obj.data.name = "Body"
    mesh = obj.data
    for vertex in mesh.vertices:
        vertex.co *= 1 + 0.06 * np.sin(9 * vertex.co.x) * np.cos(7 * vertex.co.y)
        vertex.co.z *= 1.5
    mesh.materials.append(bpy.data.materials.new("Skin"))
    own = bpy.data.materials.new("Own Skin")
    obj.material_slots[0].link, obj.material_slots[0].material = "OBJECT", own
    add_face_keys(obj)
    add_rig(obj)
    return obj


def add_face_keys(obj) -> None:
    """Give ``obj`` a Basis, a driven key, and one that is relative to that."""
    obj.shape_key_add(name="Basis", from_mix=False)
    smile, pout = (obj.shape_key_add(name=name, from_mix=False) for name in ("Smile", "Pout"))
    for point in smile.points:
        point.co.x *= 1 + 0.2 * max(point.co.z, 0)
    pout.relative_key = smile
    for point, other in zip(pout.points, smile.points, strict=True):
        point.co = other.co * 1.05
    smile.driver_add("value").driver.expression = "frame / 20"
    pout.value = 0.5


def add_rig(obj) -> None:
    """Have a bone bend ``obj`` on FRAMES, and then subdivide it."""
    obj.modifiers.new("Armature", "ARMATURE").object = bent_rig(obj)
    obj.modifiers.new("Subdivision", "SUBSURF")
    bpy.context.scene.frame_set(FRAMES[0])


def bent_rig(obj) -> bpy.types.Object:
    """An armature with a bone that turns the upper half of ``obj``, which stays active."""
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones.new("Bone").tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    bone = rig.pose.bones["Bone"]
    bone.rotation_mode = "XYZ"
    for frame, angle in zip(FRAMES, (0, 0.5, 1.2), strict=True):
        bone.rotation_euler.x = angle
        bone.keyframe_insert("rotation_euler", frame=frame)
    group(obj, "Bone", [v.index for v in obj.data.vertices if v.co.z > 0])
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    return rig


def poses(obj) -> list[np.ndarray]:
    """What is seen of ``obj`` on FRAMES."""
    found = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        found.append(evaluated(obj))
    bpy.context.scene.frame_set(FRAMES[0])
    return found


def driven(obj) -> list[tuple[str, str]]:
    """The drivers of its keys."""
    return [
        (each.data_path, each.driver.expression)
        for each in obj.data.shape_keys.animation_data.drivers
    ]
