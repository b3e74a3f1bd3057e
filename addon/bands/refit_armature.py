"""The operator that fits the bones of an armature to the look of a body."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..scene import mix
from ..scene.places import linear_of
from ..scene.records import all_bands_of
from ..scene.surface import Surface
from ..scene.temporary import Temporary
from . import bone_children
from .set_bands import BandsOperator

# What a bone keeps: by what its head and its tail were moved so far, in the armature's space.
MOVED = "spectral_tv_moved"
# By which power of the distance a part of the surface counts less for a joint.
POWER = 4
# Joints are no nearer to the surface than that, relative to its size, so that none counts alone.
NEAREST = 0.01


class SPECTRAL_TV_OT_refit_armature(BandsOperator, bpy.types.Operator):
    """Move the heads and tails of the bones of the other selected armature along with the surface
    around them, as the bands of the active mesh move it now. Again, after other values, they start
    from where they were at first"""

    bl_idname = "spectral_tv.refit_armature"
    bl_label = "Refit Armature"

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> str:
        rigs = [each for each in context.selected_objects if each.type == "ARMATURE"]
        if len(rigs) != 1:
            raise Refusal("select the one armature that is fitted to it too, and it last")
        (rig,) = rigs
        reason = _refusal(rig)
        if reason is not None:
            raise Refusal(f"{rig.name}: {reason}")
        bands = all_bands_of(obj)
        surface = Surface.read(obj, mix.shown(obj, bands))
        moved = surface.merge_vectors(mix.shown(obj) - mix.shown(obj, bands))
        farthest = _refit(context, rig, obj, surface, moved)
        if rig.animation_data is not None and rig.animation_data.action is not None:
            note(f"the animation of {rig.name} stays as it is, and moves other bones now")
        return f"{len(rig.data.bones)} bones of {rig.name} moved by up to {farthest:.3g}"


def _refusal(rig: bpy.types.Object) -> str | None:
    """Why bones of an armature cannot be moved; None if they can."""
    if rig.library or rig.data.library or rig.override_library or rig.data.override_library:
        return "it belongs to another file; make it local first"
    if rig.mode == "EDIT" or rig.data.is_editmode:
        return "leave its Edit Mode first"
    if rig.hide_get() or not rig.visible_get():
        return "it is hidden; show it"
    return None


def _refit(
    context: bpy.types.Context,
    rig: bpy.types.Object,
    obj: bpy.types.Object,
    surface: Surface,
    moved: np.ndarray,
) -> float:
    """Move bones along with a surface whose vertices are moved by (N, 3); returns how far at most,
    in the world."""
    matrix = linear_of(rig.matrix_world, rig.name)
    shift = np.array(rig.matrix_world.translation - obj.matrix_world.translation)
    back = np.linalg.inv(matrix)
    with bone_children.staying(rig), _edited(context, rig) as bones:
        farthest = 0.0
        places = {}
        for bone in bones:
            before = np.array(bone.get(MOVED, [0.0] * 6), dtype=np.float64).reshape(2, 3)
            first = np.array([bone.head, bone.tail], dtype=np.float64) - before
            steps = np.array(
                [_moved_at(surface, moved, joint @ matrix.T + shift) for joint in first]
            )
            farthest = max(farthest, float(np.linalg.norm(steps, axis=1).max()))
            places[bone.name] = first, steps @ back.T
        for name, (first, steps) in places.items():
            bones[name].head, bones[name].tail = first + steps
            bones[name][MOVED] = steps.ravel().tolist()
    return farthest


@contextmanager
def _edited(
    context: bpy.types.Context, rig: bpy.types.Object
) -> Iterator[bpy.types.bpy_prop_collection]:
    """The bones of an armature as Edit Mode has them; it is in its own mode again afterwards."""
    chosen = {"selected_objects": [rig], "selected_editable_objects": [rig]}
    with context.temp_override(object=rig, active_object=rig, **chosen), Temporary() as now:
        now.put(rig.data, "use_mirror_x", False)  # or bones would drag their mirror images along
        now.put(context.view_layer.objects, "active", rig)
        now.callback(bpy.ops.object.mode_set, mode=rig.mode)
        bpy.ops.object.mode_set(mode="EDIT")
        yield rig.data.edit_bones


def _moved_at(surface: Surface, moved: np.ndarray, joint: np.ndarray) -> np.ndarray:
    """By what the surface around a joint is moved, (3,): the mean, where near parts count most."""
    mesh = surface.mesh
    away = np.linalg.norm(mesh.vertices - joint, axis=1)
    away = np.maximum(away, NEAREST * np.sqrt(mesh.area))
    weights = mesh.vertex_areas / away**POWER
    return weights @ moved / weights.sum()
