"""``deform``: files in, shapes out of which parts were moved."""

import argparse
from collections.abc import Sequence

import bpy
import numpy as np
import spectral_tv
from mathutils import Matrix, Vector

from ..command_line.formats import BLEND
from ..command_line.frames import frames_argument, plays
from ..command_line.progress import progress, say
from ..command_line.verb import Task, Verb
from ..options.arguments import add_arguments as add_options
from ..options.arguments import complaint
from ..scene.animation import travel
from ..scene.notes import listed, note
from ..scene.objects import Refusal, refusal
from ..scene.surface import Reading
from ..scene.touching import touching
from . import baking, constraints
from .constraints import Settings, deformation_of
from .deform import message, prepare, write
from .empties import add_empty
from .regions import Region, group_of


class Deform(Verb):
    """Moves parts of objects, and has the others follow."""

    name = "deform"
    options = Settings
    of_object = True
    summary = "move parts of meshes and have the others follow in rigid pieces"
    result = "deformed"
    description = """\
Move parts of the meshes of files, hold others, and have the rest follow in rigid pieces.

WHERE is a vertex group by its name, or a region of the object's bounding box along an axis of
Blender's world (Z is up) such as 'z<10%' or 'x>90%'. Without --pin and --move the objects that
hold constraints in the file are deformed by them.

A .blend keeps the deformation as a shape key, the parts as vertex groups and constraints, and an
empty per --move to drag on; .glb, .gltf and .fbx carry the shape key too. All other formats hold
the deformed shape. With --frames .abc and USD files play it; of the others there is a file for
each frame."""
    examples = """\
  blender --command spectral_tv deform cat.ply -o cat.obj --pin 'z<10%' --move 'z>90%:0,0,0.2'
  blender --command spectral_tv deform *.glb -o bent --move 'Head:0.1,0,0' --pin Feet --softness 10
  blender --command spectral_tv deform rigged.blend -o baked.glb --frames 1-40:2"""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare what moves, and how the others follow."""
        add = parser.add_argument
        add(
            "--pin",
            metavar="WHERE",
            dest="pins",
            action="append",
            default=[],
            help="hold this part where it is; repeatable",
        )
        add(
            "--move",
            metavar="WHERE:DX,DY,DZ",
            dest="moves",
            type=_move,
            action="append",
            default=[],
            help="move this part by an offset in the world; repeatable. With --pin in place of the "
            "constraints in the file",
        )
        add_options(parser, Settings, of_object=True)
        add(
            "--frames",
            metavar="START-END[:STEP]",
            type=frames_argument,
            help="a shape key for each of these frames and the last one, played in turn as the "
            "handles move; those of --move go their way from the first to the last. With = where "
            "the first is negative: --frames=-10-40. Of a format that cannot play there is a file "
            "for each",
        )

    def complaint_of_own(self, choices: argparse.Namespace) -> str | None:
        """What is wrong with them together."""
        if choices.pins and not choices.moves:
            return "--pin alone moves nothing; add --move"
        asked = self.settings(choices)
        if choices.frames is not None and asked.algorithm != "CONVEX":
            return "--frames goes with --algorithm convex"
        return complaint(choices, Settings, asked)

    def choose(self, choices: argparse.Namespace) -> list[bpy.types.Object]:
        """All meshes, or those with constraints if none are given."""
        meshes = super().choose(choices)
        if choices.moves:
            return meshes
        held = [obj for obj in meshes if deformation_of(obj).constraints]
        if not held:
            raise Refusal("no object in it has constraints; give some with --pin and --move")
        return held

    def groups(
        self, objects: list[bpy.types.Object], choices: argparse.Namespace
    ) -> list[list[bpy.types.Object]]:
        """Each object by itself; notes what that does to those that belong together."""
        named = [*choices.pins, *(where for where, _ in choices.moves)]
        regions = [region.name for where in named if (region := Region.read(where))]
        if len(objects) > 1 and regions:
            names = listed(obj.name for obj in objects)
            note(f"{listed(regions)}: percent are of each object by itself, {names}")
        _tell_touching(objects, choices)
        return super().groups(objects, choices)

    def treat(
        self, objects: Sequence[bpy.types.Object], choices: argparse.Namespace, task: Task
    ) -> None:
        """Give an object the shape keys of its deformation."""
        (obj,) = objects
        if choices.moves and not _parts(obj, [where for where, _ in choices.moves], choices):
            note("it was left as it is: it has none of the groups to move")
            return
        if obj.data.users > 1:
            note(f"{obj.data.users} objects share its mesh: all are deformed alike")
        deformation = deformation_of(obj)
        if choices.algorithm is not None:
            deformation.algorithm = choices.algorithm.upper()
        if choices.softness is not None:
            deformation.softness = choices.softness
        empties = _constrain(obj, choices) if choices.moves else []
        done = _deform(obj, task) if choices.frames is None else _bake(obj, choices.frames, task)
        say(f"{task.label}: {done}")
        if task.file is None or task.file.suffix.lower() != BLEND:
            bpy.data.batch_remove(empties)


def _constrain(obj: bpy.types.Object, choices: argparse.Namespace) -> list[bpy.types.Object]:
    """Replace the constraints of ``obj`` by those asked for, and return their handles."""
    deformation_of(obj).constraints.clear()
    for where in _parts(obj, choices.pins, choices):
        constraints.add(obj, group_of(obj, where))
    empties = []
    here = _parts(obj, [where for where, _ in choices.moves], choices)
    for where, offset in choices.moves:
        if where not in here:
            continue
        constraint = constraints.add(obj, group_of(obj, where), "OBJECT")
        empty = constraint.target = add_empty(obj, constraint.vertex_group)
        rest = empty.matrix_world.copy()
        empty.matrix_world = Matrix.Translation(offset) @ rest
        if choices.frames is not None:
            ends = choices.frames[0], choices.frames[-1]
            travel(empty, (rest.translation, rest.translation + Vector(offset)), ends)
        empties.append(empty)
    bpy.context.view_layer.update()
    return empties


def _tell_touching(objects: Sequence[bpy.types.Object], choices: argparse.Namespace) -> None:
    """Note which objects tear as they, or others in the file, are deformed apart."""
    others = [] if choices.objects else bpy.context.view_layer.objects
    meshes = [obj for obj in others if obj.type == "MESH" and len(obj.data.polygons)]
    all_of_them = list(dict.fromkeys([*objects, *meshes]))
    sound = [obj for obj in all_of_them if refusal(obj) is None]
    try:
        found = touching(sound, [None] * len(sound), Reading.of_scene())
    except (Refusal, spectral_tv.MeshError):  # told when that object is deformed
        return
    for group in found:
        names = [sound[index].name for index in group]
        if len(group) > 1 and any(sound[index] in objects for index in group):
            note(
                f"open edges of {listed(names)} meet, but each object is deformed by itself, so "
                "the surface may tear there: join them into one object before"
            )


def _parts(obj: bpy.types.Object, named: list[str], choices: argparse.Namespace) -> list[str]:
    """Those of several parts that ``obj`` has; notes a group that only another object has.

    Raises Refusal if no object has it, or ``obj`` was asked for by name.
    """
    found = []
    for where in named:
        try:
            group_of(obj, where)
        except Refusal:
            others = [each for each in bpy.context.view_layer.objects if each.type == "MESH"]
            is_elsewhere = any(where.strip() in each.vertex_groups for each in others)
            if choices.objects or not is_elsewhere:
                raise
            note(f"it has no vertex group {where.strip()!r}")
        else:
            found.append(where)
    return found


def _deform(obj: bpy.types.Object, task: Task) -> str:
    deformation = deformation_of(obj)
    deformable, arguments = prepare(obj, deformation.algorithm, deformation.softness)
    with progress(task.label) as show:
        result = spectral_tv.deform(deformable.surface.mesh, **arguments, progress=show)
    write(obj, deformable.displacement(result))
    return message(result, deformation.algorithm)


def _bake(obj: bpy.types.Object, frames: list[int], task: Task) -> str:
    scene = bpy.context.scene  # exporters keep to its frames
    scene.frame_start = min(scene.frame_start, frames[0])
    scene.frame_end = max(scene.frame_end, frames[-1])
    is_played = task.file is None or plays(task.file)
    if scene.frame_start > frames[0] and is_played:  # Blender has no such start
        note(f"the scene starts at frame {scene.frame_start}: no export goes back to {frames[0]}")
    deformable, targets, deformer = baking.prepare(obj, frames, lambda _fraction: None)
    with progress(task.label) as show:
        results = deformer.solve_sequence(targets, progress=show)
    return baking.write(obj, frames, deformable, results)


def _move(text: str) -> tuple[str, tuple[float, ...]]:
    where, _, numbers = text.rpartition(":")  # names may have colons
    try:
        offset = tuple(float(number) for number in numbers.split(","))
    except ValueError:
        offset = ()
    if not where.strip() or len(offset) != 3 or not np.isfinite(offset).all():
        message = f"{text!r} is not WHERE:DX,DY,DZ, such as 'z>90%:0,0,0.5'"
        raise argparse.ArgumentTypeError(message)
    return where, offset
