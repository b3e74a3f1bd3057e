"""The deformation of an object on many frames: from moving handles to a shape-key animation."""

from collections.abc import Sequence

import bpy
import numpy as np
import spectral_tv

from ..scene.animation import play_in_turn, remove_animation
from ..scene.shape_keys import add_displacements
from .constraints import deformation_of
from .deform import NAME, Deformable, result_key


def prepare(
    obj: bpy.types.Object, frames: Sequence[int]
) -> tuple[Deformable, list[np.ndarray], spectral_tv.Deformer]:
    """What is read of ``obj``, the targets of every frame, and what solves for them.

    Raises Refusal or spectral_tv.MeshError if it cannot be deformed.
    """
    deformable = Deformable.read(obj)
    scene = bpy.context.scene
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        targets = []
        for number in frames:
            scene.frame_set(number)
            targets.append(deformable.targets(obj))
    finally:
        scene.frame_set(frame, subframe=subframe)
    return deformable, targets, deformable.deformer(obj)


def write(
    obj: bpy.types.Object,
    frames: Sequence[int],
    deformable: Deformable,
    results: Sequence[spectral_tv.Deformation],
) -> str:
    """Write one shape key per frame, play them in turn, and say what was done.

    They replace those of an earlier baking.
    """
    _remove_baked(obj)
    single = result_key(obj)
    if single is not None:
        single.value = 0.0  # it would be added to the baked ones
    names = [f"{NAME} {frame}" for frame in frames]
    displacements = np.stack([deformable.displacement(each) for each in results])
    keys = add_displacements(obj, names, displacements)
    play_in_turn(obj, keys, frames)
    for key in keys:
        deformation_of(obj).baked.add().name = key.name
    scene = bpy.context.scene
    scene.frame_set(scene.frame_current, subframe=scene.frame_subframe)  # the shape of this frame
    return f"{len(keys)} frames baked"


def _remove_baked(obj: bpy.types.Object) -> None:
    """Remove the shape keys of an earlier baking, and their animation."""
    baked = deformation_of(obj).baked
    keys = obj.data.shape_keys
    for entry in baked if keys is not None else ():
        key = keys.key_blocks.get(entry.name)
        if key is not None:
            remove_animation(obj, key)
            obj.shape_key_remove(key)
    baked.clear()
