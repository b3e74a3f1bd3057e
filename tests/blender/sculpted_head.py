"""A Multiresolution sculpt with what production adds, and what tests ask of it."""

from __future__ import annotations

import bpy
import numpy as np
from deform_scene import evaluated
from rigged_body import FRAMES, bent_rig

LEVELS = (1, 2, 3, 3)


def reshaped(obj, shape: np.ndarray) -> None:
    """Sculpt ``obj``: give its shown level a shape, by Blender's own Reshape."""
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(graph))
    mesh.vertices.foreach_set("co", shape.astype(np.float32).ravel())
    source = bpy.data.objects.new("Sculptor", mesh)
    bpy.context.scene.collection.objects.link(source)
    bpy.context.view_layer.update()
    both = [obj, source]
    with bpy.context.temp_override(
        object=obj, active_object=obj, selected_objects=both, selected_editable_objects=both
    ):
        bpy.ops.object.multires_reshape(modifier="Multires")
    bpy.data.batch_remove([mesh])


def bumpy(points: np.ndarray, much: float = 1.0) -> np.ndarray:
    waves = np.sin(17 * points[:, :1]) + np.cos(13 * points[:, 1:2]) + np.sin(40 * points[:, 2:])
    return points * (1 + 0.02 * much * waves)


def sculpted_head() -> bpy.types.Object:
    """A head of quads with three sculpted levels, a face key with a driver and a rig."""
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    obj.name = obj.data.name = "Head"
    modifier = obj.modifiers.new("Multires", "MULTIRES")
    for _ in range(2):
        bpy.ops.object.multires_subdivide(modifier="Multires", mode="CATMULL_CLARK")
    reshaped(obj, bumpy(evaluated(obj)))
    bpy.ops.object.multires_subdivide(modifier="Multires", mode="CATMULL_CLARK")
    reshaped(obj, bumpy(evaluated(obj), 0.3))
    modifier.levels, modifier.sculpt_levels, modifier.render_levels = LEVELS[:3]
    obj.data.materials.append(bpy.data.materials.new("Skin"))
    obj.shape_key_add(name="Basis", from_mix=False)
    smile = obj.shape_key_add(name="Smile", from_mix=False)
    for point in smile.points:
        point.co.x *= 1.2
    smile.driver_add("value").driver.expression = "frame / 20"
    obj.modifiers.new("Armature", "ARMATURE").object = bent_rig(obj)
    obj.modifiers.move(1, 0)
    bpy.context.scene.frame_set(FRAMES[0])
    return obj


def levels(obj) -> tuple[int, ...]:
    found = obj.modifiers["Multires"]
    return found.levels, found.sculpt_levels, found.render_levels, found.total_levels


def at_rest(obj, level: int) -> np.ndarray:
    """What a level is, of Basis and without the armature."""
    probe = obj.copy()
    probe.animation_data_clear()
    probe.modifiers.remove(probe.modifiers["Armature"])
    probe.modifiers["Multires"].levels = level
    probe.show_only_shape_key, probe.active_shape_key_index = True, 0
    bpy.context.scene.collection.objects.link(probe)
    found = evaluated(probe)
    bpy.data.objects.remove(probe)
    return found
