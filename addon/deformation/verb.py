"""``deform``: files in, shapes out of which parts were moved."""

import argparse
from collections.abc import Container, Iterable, Sequence

import bpy
import spectral_tv
from mathutils import Matrix, Vector
from spectral_tv.command_line.frames import METAVAR, frames_argument
from spectral_tv.command_line.progress import progress, say
from spectral_tv.deformation.parts import add_parts, complaint_of_parts, imply_algorithm
from spectral_tv.deformation.regions import Region
from spectral_tv.deformation.settings import Settings
from spectral_tv.deformation.solvers import follow_complaint
from spectral_tv.notes import listed, note
from spectral_tv.options.arguments import add_arguments as add_options
from spectral_tv.options.arguments import complaint
from spectral_tv.options.declaring import options_of
from spectral_tv.refusal import Refusal

from ..command_line.formats import BLEND
from ..command_line.frames import plays
from ..command_line.verb import Verb
from ..scene.animation import travel
from ..scene.objects import refusal
from ..scene.surface import Reading
from ..scene.touching import touching
from . import baking, constraints
from .constraints import deformation_of
from .deform import prepare, write
from .empties import constrain
from .regions import group_of


class Deform(Verb):
    """Moves parts of objects, and has the others follow."""

    name = "deform"
    options = Settings
    of_object = True
    summary = "move parts of meshes and have the others follow in rigid pieces"
    result = "deformed"
    description = """\
Move parts of the meshes of files, hold others, and have the rest follow in rigid pieces. They turn,
with joints at narrow places; with --algorithm convex they shift only. An option that is for one
algorithm alone asks for it.

WHERE is a vertex group by its name, or a region of the object's bounding box along an axis of
Blender's world (Z is up) such as 'z<10%' or 'x>90%'. Without --pin and --move the objects that
hold constraints in the file are deformed by them.

A .blend keeps the deformation as a shape key, the parts as vertex groups and constraints, and an
empty per --move to drag on; .glb, .gltf and .fbx carry the shape key too. All other formats hold
the deformed shape. With --frames .abc and USD files play it; of the others there is a file for
each frame."""
    examples = """\
  {program} deform cat.ply -o cat.obj --pin 'z<10%' --move 'z>90%:0,0,0.2'
  {program} deform *.glb -o bent --move 'Head:0.1,0,0' --pin Feet --softness 10
  {program} deform man.blend -o waving.blend --pin Trunk --move 'Hand:0,0,0.6'
  {program} deform rigged.blend -o baked.glb --frames 1-40:2"""

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what moves, and how the others follow."""
        super().add_arguments(parser)
        add = parser.add_argument
        add_parts(
            parser,
            "the world; repeatable. With --pin in place of the constraints in the file",
        )
        add_options(parser, Settings, of_object=True)
        add(
            "--frames",
            metavar=METAVAR,
            type=frames_argument,
            help="a shape key for each of these frames and the last one, played in turn as the "
            "handles move; those of --move go their way from the first to the last. With = where "
            "the first is negative: --frames=-10-40. Of a format that cannot play there is a file "
            "for each",
        )

    def complaint(self) -> str | None:
        """What is wrong with them together."""
        choices, reason = self.choices, super().complaint()
        if reason is not None:
            return reason
        reason = complaint_of_parts(choices)
        if reason is not None:
            return reason
        imply_algorithm(choices)
        reason = complaint(choices, Settings, self.asked)
        if reason is None and choices.frames is not None and choices.algorithm is not None:
            is_still = follow_complaint(self.asked.algorithm) is not None
            reason = "--frames goes with --algorithm pose or convex" if is_still else None
        return reason

    def choose(self) -> list[bpy.types.Object]:
        """All meshes, or those with constraints if none are given."""
        meshes = super().choose()
        if self.choices.moves:
            return meshes
        held = [obj for obj in meshes if deformation_of(obj).constraints]
        if not held:
            raise Refusal("no object in it has constraints; give some with --pin and --move")
        return held

    def groups(self, objects: list[bpy.types.Object]) -> list[list[bpy.types.Object]]:
        """Each object by itself; notes what that does to those that belong together."""
        named = [*self.choices.pins, *(where for where, _ in self.choices.moves)]
        regions = [region.name for where in named if (region := Region.read(where))]
        if len(objects) > 1 and regions:
            names = listed(obj.name for obj in objects)
            note(f"{listed(regions)}: percent are of each object by itself, {names}")
        self._tell_touching(objects)
        return super().groups(objects)

    def treat(self, objects: Sequence[bpy.types.Object], label: str) -> None:
        """Give an object the shape keys of its deformation."""
        (obj,), choices = objects, self.choices
        moves = self._parts(obj, dict(choices.moves))
        if choices.moves and not moves:
            note("it was left as it is: it has none of the groups to move")
            return
        if obj.data.users > 1:
            note(f"{obj.data.users} objects share its mesh: all are deformed alike")
        deformation = deformation_of(obj)
        for name in options_of(Settings):
            if getattr(choices, name) is not None:
                setattr(deformation, name, getattr(self.asked, name))
        empties = self._constrain(obj, moves) if moves else []
        done = _deform(obj, label) if choices.frames is None else self._bake(obj, label)
        say(f"{label}: {done}")
        if self.file is None or self.file.suffix.lower() != BLEND:
            bpy.data.batch_remove(empties)

    def _constrain(self, obj: bpy.types.Object, here: Container[str]) -> list[bpy.types.Object]:
        """Replace the constraints of ``obj`` by those asked for, and return their handles."""
        deformation_of(obj).constraints.clear()
        for where in self._parts(obj, self.choices.pins):
            constraints.add(obj, group_of(obj, where))
        empties, frames = [], self.choices.frames
        for where, offset in self.choices.moves:
            if where not in here:
                continue
            constraint = constrain(obj, group_of(obj, where), "OBJECT")
            constraint.turns = self.choices.unturned
            empty = constraint.target
            rest = empty.matrix_world.copy()
            empty.matrix_world = Matrix.Translation(offset) @ rest
            if frames is not None:
                places = rest.translation, rest.translation + Vector(offset)
                travel(empty, places, (frames[0], frames[-1]))
            empties.append(empty)
        bpy.context.view_layer.update()
        return empties

    def _tell_touching(self, objects: Sequence[bpy.types.Object]) -> None:
        """Note which objects tear as they, or others in the file, are deformed apart."""
        others = [] if self.choices.objects else bpy.context.view_layer.objects
        meshes = [obj for obj in others if obj.type == "MESH" and len(obj.data.polygons)]
        sound = [obj for obj in dict.fromkeys([*objects, *meshes]) if refusal(obj) is None]
        try:
            found = touching(sound, [None] * len(sound), Reading.of_scene())
        except (Refusal, spectral_tv.MeshError):  # told when that object is deformed
            return
        for group in found:
            names = [sound[index].name for index in group]
            if len(group) > 1 and any(sound[index] in objects for index in group):
                note(
                    f"open edges of {listed(names)} meet, but each object is deformed by itself, "
                    "so the surface may tear there: join them into one object before"
                )

    def _parts(self, obj: bpy.types.Object, named: Iterable[str]) -> list[str]:
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
                if self.choices.objects or not is_elsewhere:
                    raise
                note(f"it has no vertex group {where.strip()!r}")
            else:
                found.append(where)
        return found

    def _bake(self, obj: bpy.types.Object, label: str) -> str:
        scene, frames = bpy.context.scene, self.choices.frames  # exporters keep to the scene's
        scene.frame_start = min(scene.frame_start, frames[0])
        scene.frame_end = max(scene.frame_end, frames[-1])
        is_played = self.file is None or plays(self.file)
        first = scene.frame_start
        if first > frames[0] and is_played:  # Blender has no such start
            note(f"the scene starts at frame {first}: no export goes back to {frames[0]}")
        deformable, targets, follower = baking.prepare(obj, frames, lambda _fraction: None)
        with progress(label) as show:
            solutions = follower.start_sequence(targets).result(show)
        return baking.write(obj, frames, deformable, follower, solutions)


def _deform(obj: bpy.types.Object, label: str) -> str:
    deformable, targets, solver = prepare(obj, deformation_of(obj).settings())
    with progress(label) as show:
        solved = solver.start(targets).result(show)
    write(obj, deformable.displacement(solved.result))
    return solver.message(solved)
