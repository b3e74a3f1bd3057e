"""Where objects and bones are in the world, hidden ones too.

Blender updates only what is shown. A hidden object keeps the place that it had when it was last
shown, unless something shown depends on it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy
from mathutils import Matrix
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from .temporary import Temporary

# An object, and the name of a bone of it, or nothing.
Followed = tuple[bpy.types.Object, str]


def is_in_a_scene(obj: bpy.types.Object) -> bool:
    """Whether there is a scene that holds ``obj``: none does once it was deleted.

    What points at a deleted object keeps it in the file.
    """
    return any(
        obj.name in scene.objects
        and (scene.objects[obj.name] == obj or obj in scene.objects.values())
        for scene in bpy.data.scenes
    )


def is_kept_up(obj: bpy.types.Object) -> bool:
    """Whether Blender moves ``obj`` in the present scene: if it is shown, or hidden by the eye."""
    layer = bpy.context.view_layer
    if obj.visible_get(view_layer=layer):
        return True
    return not obj.hide_viewport and _is_enabled(obj, layer.layer_collection)


def _is_enabled(obj: bpy.types.Object, layer: bpy.types.LayerCollection) -> bool:
    """Whether the view layer holds ``obj`` in a collection that is not disabled."""
    if layer.exclude or layer.collection.hide_viewport:
        return False
    return obj in layer.collection.objects.values() or any(
        _is_enabled(obj, child) for child in layer.children
    )


def linear_of(matrix_world: Matrix, name: str | None = None) -> np.ndarray:
    """What turns and scales an object, (3, 3); raises Refusal, with its name, if it flattens it."""
    found = np.array(matrix_world.to_3x3(), dtype=np.float64)
    if np.linalg.matrix_rank(found) < 3:
        whose = "its scale" if name is None else f"the scale of {name!r}"
        raise Refusal(f"{whose} is zero along an axis")
    return found


@contextmanager
def kept_up(followed: Iterable[Followed], over_frames: bool = False) -> Iterator[None]:
    """Have Blender update all of these objects and bones in the block, hidden ones too.

    With ``over_frames`` also those that are hidden on other frames. Raises Refusal if there are
    hidden ones in a scene that belongs to another file.
    """
    hidden = [(obj, bone) for obj, bone in followed if over_frames or not is_kept_up(obj)]
    if not hidden:
        yield
        return
    with Temporary() as now:
        # Blender moves what something shown depends on.
        probe = now.made(bpy.data.objects.new("Spectral TV Probe", None))
        for obj, bone in hidden:
            constraint = probe.constraints.new("COPY_TRANSFORMS")
            constraint.target = obj
            if obj.type == "ARMATURE":
                constraint.subtarget = bone
        try:
            bpy.context.scene.collection.objects.link(probe)
        except RuntimeError as error:
            raise Refusal(f"{hidden[0][0].name!r} is hidden; show it") from error
        _take_to_this_frame()
        yield


def _take_to_this_frame() -> None:
    """Have Blender animate what it did not move before; what it moved keeps unkeyed changes."""
    graph = bpy.context.evaluated_depsgraph_get()
    for obj in bpy.data.objects:
        if obj.evaluated_get(graph).is_evaluated and not is_kept_up(obj):
            for data in (obj, obj.data):
                if data is not None and data.animation_data is not None:
                    data.update_tag(refresh={"TIME"})


def world_scale(obj: bpy.types.Object) -> float:
    """How much an object enlarges its mesh, in the mean of its axes."""
    return abs(obj.matrix_world.to_3x3().determinant()) ** (1 / 3)


def matrix_of(
    obj: bpy.types.Object, bone: str, graph: bpy.types.Depsgraph | None
) -> np.ndarray | None:
    """World matrix (4, 4) of an object, or of a bone where one is named; None if it is missing.

    With ``graph``, the one just evaluated of the context, it is that of this moment; without, as
    in drawing, that of the last evaluation.
    """
    seen = obj if graph is None else obj.evaluated_get(graph)
    world = np.array(seen.matrix_world, dtype=np.float64)
    if obj.type != "ARMATURE" or not bone:
        return world
    posed = None if seen.pose is None else seen.pose.bones.get(bone)
    return None if posed is None else world @ np.array(posed.matrix, dtype=np.float64)
