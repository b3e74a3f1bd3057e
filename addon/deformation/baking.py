"""The deformation of an object on many frames: from moving handles to a shape-key animation."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import bpy
from spectral_tv.deformation.solvers import Follower, Solved, follow_complaint, follower_of
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..scene import frames as time
from ..scene.animation import as_before, check_animatable, play_in_turn
from ..scene.places import kept_up
from ..scene.shape_keys import add_displacements, remove_key
from ..scene.whole import whole
from . import results
from .constraints import deformation_of, followed_by
from .deform import Deformable, is_same_metric, metric_of


def prepare(
    obj: bpy.types.Object, frames: Sequence[int], progress: Callable[[float], None]
) -> tuple[Deformable, list[np.ndarray], Follower]:
    """What is read of ``obj``, the targets of every frame, and what solves for them.

    ``progress`` takes the fraction of the frames that was read. Raises Refusal or
    spectral_tv.MeshError if it cannot be deformed.
    """
    settings = deformation_of(obj).settings()
    reason = follow_complaint(settings.algorithm)  # before frames are read
    if reason is not None:
        raise Refusal(reason)
    if obj.data.shape_keys is not None:
        check_animatable(obj.data.shape_keys)
    scene = bpy.context.scene
    targets: list[np.ndarray] = []
    with kept_up(followed_by(obj), over_frames=True), time.kept(scene):
        deformable = Deformable.read(obj)
        first, metric = scene.frame_current, metric_of(obj)
        for number in time.visited(scene, frames):
            try:
                targets.append(deformable.grips.targets(obj))
            except Refusal as error:
                raise Refusal(f"on frame {number}: {error}") from error
            if not is_same_metric(metric_of(obj), metric):
                note(f"its scale is animated: lengths are those of frame {first}")
            progress(len(targets) / len(frames))
    deformable.note_turning(obj, targets, settings.algorithm)
    return deformable, targets, follower_of(deformable.grips.held(obj), settings)


def write(
    obj: bpy.types.Object,
    frames: Sequence[int],
    deformable: Deformable,
    follower: Follower,
    solutions: Sequence[Solved],
) -> str:
    """Write one shape key per frame, play them in turn, and say what was done.

    They replace those of an earlier baking, once they are all there.
    """
    names = [f"{results.NAME} {frame}" for frame in frames]
    former = results.Known.of(obj)
    with whole(obj), as_before(obj):
        displacements = (deformable.displacement(each.result) for each in solutions)
        keys = add_displacements(obj, names, displacements)
        play_in_turn(obj, keys, frames)
    renamed = former.renamed
    results.keep([*former.kept, *renamed])
    for key in former.baked:
        if key not in renamed:
            remove_key(obj, key)
    baked = deformation_of(obj).baked
    baked.clear()
    for key, name in zip(keys, names, strict=True):
        if name not in obj.data.shape_keys.key_blocks:  # free by now
            key.name = name
        baked.add().take(obj, "KEY", key.name)
    deformation_of(obj).vertex_count = len(obj.data.vertices)
    results.show_baked(obj)
    follower.note_sequence(frames, solutions)
    scene = bpy.context.scene
    scene.frame_set(scene.frame_current, subframe=scene.frame_subframe)  # the shape of this frame
    return f"{len(keys)} frames baked" if len(keys) > 1 else f"frame {frames[0]} baked"
