"""Shapes that move: each frame treated by itself, and played in turn."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
from spectral_tv.command_line.frames import ALL
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from ..scene import applied
from ..scene.animation import play_in_turn
from ..scene.contents import topology_digest
from ..scene.coordinates import coordinates
from ..scene.frames import kept, visited
from ..scene.playing import play_meshes
from ..scene.shape_keys import add_displacements
from ..scene.temporary import Temporary
from .formats import HOLDS, NO, YES
from .load import Source


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


def plays(file: Path, *, is_remeshed: bool = False) -> bool:
    """Whether a file of its format can hold several frames, also of other vertices each if
    ``is_remeshed``."""
    held = HOLDS[file.suffix.lower()]["animation"]
    return held == YES if is_remeshed else held != NO


# What is done to copies of objects, which have no modifiers, in a frame.
Treat = Callable[[list[bpy.types.Object], int], None]


def look_at_frames(objects: Sequence[bpy.types.Object], frames: Sequence[int], look: Treat) -> None:
    """Show ``look`` what is seen of objects in every frame, in copies that are gone afterwards."""
    with kept(bpy.context.scene):
        for frame in visited(bpy.context.scene, frames):
            with _copies(objects) as copies:
                look([copy for copy in copies if len(copy.data.polygons)], frame)


def treat_frames(objects: Sequence[bpy.types.Object], frames: Sequence[int], treat: Treat) -> bool:
    """Treat what is seen of objects in every frame, and have them play that.

    Returns whether vertices come and go: then a modifier of nodes shows a mesh for each frame.
    Otherwise shape keys play them.
    """
    scene = bpy.context.scene
    played = {obj: _Played() for obj in objects}
    with kept(scene):
        for frame in visited(scene, frames):
            with _copies(objects) as copies:
                alike = {copy: played[obj].begin(copy.data)
                         for obj, copy in zip(objects, copies, strict=True)}  # fmt: skip
                faced = [copy for copy in copies if len(copy.data.polygons)]
                if faced:
                    treat(faced, frame)
                bpy.context.view_layer.update()
                for obj, copy in zip(objects, copies, strict=True):
                    played[obj].take(copy, is_alike=alike[copy])
    scene.frame_start, scene.frame_end = frames[0], frames[-1]
    scene.frame_set(frames[0])
    modified = [obj.name for obj in objects if len(obj.modifiers)]
    for obj in objects:
        for modifier in obj.modifiers:
            modifier.show_viewport = modifier.show_render = False
    for obj in objects:
        played[obj].play(obj, frames)
    if modified:
        note(f"what modifiers show is in the frames, so they are off now: {listed(modified)}")
    bpy.context.view_layer.update()
    changing = [obj.name for obj in objects if not played[obj].keeps_vertices]
    if changing:
        note(f"vertices come and go, so there is a mesh for each frame: {listed(changing)}")
    return bool(changing)


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


class _Played:
    """What was made of an object in the frames so far."""

    def __init__(self) -> None:
        """Begin without a frame."""
        self._first: bpy.types.Mesh | None = None
        # Of each frame the shape, flat, and the mesh if it is not like the first one.
        self._shapes: list[np.ndarray] = []
        self._meshes: list[bpy.types.Mesh | None] = []

    @property
    def keeps_vertices(self) -> bool:
        """Whether all meshes are like the first one."""
        return not any(self._meshes)

    def begin(self, mesh: bpy.types.Mesh) -> bool:
        """Look at what is seen in the next frame; tells whether it is like the first one."""
        if self._first is None:
            self._first = mesh.copy()
            self._topology = topology_digest(mesh)
        is_same = len(mesh.vertices) == len(self._first.vertices)
        return is_same and topology_digest(mesh) == self._topology

    def take(self, copy: bpy.types.Object, *, is_alike: bool) -> None:
        """Take what was made of it."""
        graph = bpy.context.evaluated_depsgraph_get()
        self._shapes.append(coordinates(copy.evaluated_get(graph).data.vertices))
        mesh = None if is_alike else applied.mesh_of(copy)
        if mesh is not None:
            mesh.property_unset("spectral_tv")  # there are no bands on it
        self._meshes.append(mesh)

    def play(self, obj: bpy.types.Object, frames: Sequence[int]) -> None:
        """Have an object play it, and those that share its mesh."""
        if self.keeps_vertices:
            _play(obj, self._first, frames, self._shapes)
            return
        users = [each for each in bpy.context.view_layer.objects if each.data == obj.data]
        meshes = [self._mesh(place, obj.data.name, frame) for place, frame in enumerate(frames)]
        modifier = play_meshes(obj, meshes, frames)
        for user in users:
            user.data = meshes[0]
            if user != obj:
                user.modifiers.new(modifier.name, "NODES").node_group = modifier.node_group
        bpy.data.meshes.remove(self._first)

    def _mesh(self, place: int, name: str, frame: int) -> bpy.types.Mesh:
        mesh = self._meshes[place]
        if mesh is None:
            mesh = self._first.copy()
            mesh.vertices.foreach_set("co", self._shapes[place])
            mesh.update()
        mesh.name = f"{name} {frame}"
        return mesh


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
