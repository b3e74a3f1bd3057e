"""A box with panels, grooves, knobs and holes, as machines have them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import bmesh
import bpy
from mathutils import Matrix, Vector

from ..demo.studio import temporary_data
from .page import Shape
from .shapes import taken

OCTREE_DEPTH = 6
SIDES = [Vector(side) for side in ((1, 0, 0), (0, -1, 0), (0, 0, 1), (-1, 0, 0), (0, 1, 0))]


@cache
def box() -> Shape:
    """The box, evenly meshed with crisp edges."""
    scene = bpy.context.scene
    with temporary_data():
        obj = bpy.data.objects.new("Box", _solids([("cube", Matrix.Scale(2, 4))]))
        scene.collection.objects.link(obj)
        for operation, solids in (("UNION", _added()), ("DIFFERENCE", _carved())):
            other = bpy.data.objects.new(operation, _solids(solids))
            scene.collection.objects.link(other)
            modifier = obj.modifiers.new(operation, "BOOLEAN")
            modifier.operation, modifier.object, modifier.solver = operation, other, "EXACT"
            modifier.use_self = True
        remesh = obj.modifiers.new("Remesh", "REMESH")
        remesh.mode, remesh.octree_depth, remesh.scale = "SHARP", OCTREE_DEPTH, 0.93
        graph = bpy.context.evaluated_depsgraph_get()
        data = bpy.data.meshes.new_from_object(obj.evaluated_get(graph))
        return taken(bpy.data.objects.new("Box", data), azimuth=32.0, elevation=24.0, smooth=False)


def _added() -> Iterator[tuple[str, Matrix]]:
    """Raised panels, a knob on each of three sides, bars."""
    for side in SIDES:
        yield "cube", _on(side, 0.0, 0.0, (1.2, 1.2, 0.16))
    for side in SIDES[:3]:
        yield "cylinder", _on(side, 0.0, 0.0, (0.42, 0.42, 1.0))
        for x in (-0.42, 0.42):
            yield "cylinder", _on(side, x, 0.42, (0.14, 0.14, 0.34))


def _carved() -> Iterator[tuple[str, Matrix]]:
    """Grooves around the panels, slots, a hole."""
    for side in SIDES:
        for x in (-0.78, 0.78):
            yield "cube", _on(side, x, 0.0, (0.08, 1.64, 0.12))
            yield "cube", _on(side, 0.0, x, (1.64, 0.08, 0.12))
        for y in (-0.44, -0.34):
            yield "cube", _on(side, 0.0, y, (0.8, 0.05, 0.3))
    for side in SIDES[:3]:
        yield "cylinder", _on(side, 0.0, 0.0, (0.2, 0.2, 1.4))


def _on(side: Vector, x: float, y: float, size: tuple[float, float, float]) -> Matrix:
    """Places a unit solid of a size in the middle of a side, moved along the side."""
    turn = side.to_track_quat("Z", "Y").to_matrix().to_4x4()
    return turn @ Matrix.Translation((x, y, 1)) @ Matrix.Diagonal((*size, 1))


def _solids(solids: list[tuple[str, Matrix]] | Iterator[tuple[str, Matrix]]) -> bpy.types.Mesh:
    """Unit cubes and cylinders, each placed."""
    edited = bmesh.new()
    for kind, place in solids:
        if kind == "cube":
            bmesh.ops.create_cube(edited, size=1, matrix=place)
        else:
            bmesh.ops.create_cone(
                edited, cap_ends=True, segments=48, radius1=0.5, radius2=0.5, depth=1, matrix=place
            )
    data = bpy.data.meshes.new("Solids")
    edited.to_mesh(data)
    edited.free()
    return data
