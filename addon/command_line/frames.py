"""Shapes that move: each frame treated by itself, and played in turn."""

import argparse
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from ..scene import applied
from ..scene.animation import play_in_turn
from ..scene.coordinates import coordinates
from ..scene.frames import every, kept, visited
from ..scene.shape_keys import add_displacements
from ..scene.temporary import Temporary
from .formats import HOLDS, NO
from .load import Source

FRAMES = re.compile(r"(-?\d{1,6})-(-?\d{1,6})(?::(\d{1,6}))?")
ALL = "all"


def frames_argument(text: str) -> list[int]:
    """A type of argument: START-END or START-END:STEP, the end included."""
    found = FRAMES.fullmatch(text)
    if found is None or int(found[3] or 1) == 0:
        message = f"{text!r} is not START-END or START-END:STEP, such as 1-40:2"
        raise argparse.ArgumentTypeError(message)
    start, end, step = int(found[1]), int(found[2]), int(found[3] or 1)
    if end < start:
        raise argparse.ArgumentTypeError(f"frame {end} comes before frame {start}")
    return every(start, end, step)


def all_or_frames(text: str) -> list[int] | str:
    """A type of argument: the same, or all."""
    return ALL if text.lower() == ALL else frames_argument(text)


def frames_of(asked: list[int] | str, source: Source) -> Sequence[int]:
    """The frames that are asked for; all are those over which something moves."""
    if asked != ALL:
        return asked
    if source.frames is not None:
        return source.frames
    if not any(thing.kind == "animation" for thing in source.things):
        raise Refusal("nothing in it moves, so there are no frames")
    scene = bpy.context.scene
    return range(scene.frame_start, scene.frame_end + 1)


def plays(file: Path) -> bool:
    """Whether a file of its format can hold several frames."""
    return HOLDS[file.suffix.lower()]["animation"] != NO


def treat_frames(
    objects: Sequence[bpy.types.Object],
    frames: Sequence[int],
    treat: Callable[[list[bpy.types.Object], int], None],
) -> None:
    """Treat what is seen of objects in every frame, and have them play that.

    ``treat`` takes copies of the objects, without modifiers, and the frame. Raises Refusal if a
    shape does not keep its vertices.
    """
    scene = bpy.context.scene
    shapes: dict[bpy.types.Object, list[np.ndarray]] = {obj: [] for obj in objects}
    firsts: dict[bpy.types.Object, bpy.types.Mesh] = {}
    with kept(scene):
        for frame in visited(scene, frames):
            with _copies(objects) as copies:
                for obj, copy in zip(objects, copies, strict=True):
                    first = firsts.setdefault(obj, copy.data.copy())
                    _ensure_alike(obj, first, copy.data, frames[0], frame)
                treat(copies, frame)
                bpy.context.view_layer.update()
                graph = bpy.context.evaluated_depsgraph_get()
                for obj, copy in zip(objects, copies, strict=True):
                    shapes[obj].append(coordinates(copy.evaluated_get(graph).data.vertices))
    for obj in objects:
        _play(obj, firsts[obj], frames, shapes[obj])
    scene.frame_start, scene.frame_end = frames[0], frames[-1]
    scene.frame_set(frames[0])
    modified = [obj.name for obj in objects if len(obj.modifiers)]
    for obj in objects:
        for modifier in obj.modifiers:
            modifier.show_viewport = modifier.show_render = False
    if modified:
        note(f"what modifiers show is in the frames, so they are off now: {listed(modified)}")
    bpy.context.view_layer.update()


@contextmanager
def _copies(objects: Sequence[bpy.types.Object]) -> Iterator[list[bpy.types.Object]]:
    """Yield objects of what is seen of others, under their names, and remove them in the end."""
    copies: list[bpy.types.Object] = []
    with Temporary() as now:
        for obj in objects:
            name = obj.name
            now.put(obj, "name", f"{name} (kept)")
            copy = applied.copy_of(obj)
            now.made(copy.data)
            copies.append(now.made(copy))
            copy.animation_data_clear()
            copy.name = name
        bpy.context.view_layer.update()
        yield copies


def _ensure_alike(
    obj: bpy.types.Object, first: bpy.types.Mesh, mesh: bpy.types.Mesh, start: int, frame: int
) -> None:
    counts = [(len(each.vertices), len(each.loops)) for each in (first, mesh)]
    if counts[0] != counts[1]:
        raise Refusal(
            f"{obj.name} has {counts[0][0]} vertices in frame {start} and {counts[1][0]} in frame "
            f"{frame}; only what keeps its vertices can be taken frame by frame"
        )


def _play(
    obj: bpy.types.Object, mesh: bpy.types.Mesh, frames: Sequence[int], shapes: Sequence[np.ndarray]
) -> None:
    """Give ``obj`` a mesh that plays shapes, flat arrays of coordinates, one in each frame."""
    mesh.vertices.foreach_set("co", shapes[0])
    before = obj.data
    mesh.name = before.name
    for other in bpy.context.view_layer.objects:
        if other.data == before:
            other.data = mesh
    basis = shapes[0].reshape(-1, 3).astype(np.float64)
    moves = [shape.reshape(-1, 3) - basis for shape in shapes]
    keys = add_displacements(obj, [f"Frame {frame}" for frame in frames], moves)
    play_in_turn(obj, keys, frames)
