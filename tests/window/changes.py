"""What users do to an object while something of it is worked on."""

from __future__ import annotations

import bpy
from pictures import activate


def delete(obj: bpy.types.Object) -> None:
    bpy.data.objects.remove(obj)


def rename(obj: bpy.types.Object) -> None:
    obj.name = "Renamed"


def edit(obj: bpy.types.Object) -> None:
    enter_edit_mode(obj)
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")


def move_a_vertex(obj: bpy.types.Object) -> None:
    obj.data.shape_keys.reference_key.data[0].co.z += 0.1


def exchange_the_mesh(obj: bpy.types.Object) -> None:
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    obj.data = cube.data


def undo(_obj: bpy.types.Object) -> None:
    bpy.ops.ed.undo()


def enter_edit_mode(obj: bpy.types.Object) -> None:
    activate(obj)
    bpy.ops.object.mode_set(mode="EDIT")


def enter_edit_mode_by_a_twin(obj: bpy.types.Object) -> None:
    twin = bpy.data.objects.new("Twin", obj.data)
    bpy.context.collection.objects.link(twin)
    enter_edit_mode(twin)


def turn_dyntopo_on(obj: bpy.types.Object) -> None:
    sculpt(obj)
    bpy.ops.sculpt.dynamic_topology_toggle()


def make_keys_absolute(obj: bpy.types.Object) -> None:
    obj.data.shape_keys.use_relative = False


def add_a_key(obj: bpy.types.Object) -> None:
    obj.shape_key_add(name="Frown")


def remove_the_keys(obj: bpy.types.Object) -> None:
    obj.shape_key_clear()


def remove_the_groups(obj: bpy.types.Object) -> None:
    obj.vertex_groups.clear()


def sculpt(_obj: bpy.types.Object) -> None:
    bpy.ops.object.mode_set(mode="SCULPT")


def another_scene(_obj: bpy.types.Object) -> None:
    scene = bpy.data.scenes.new("Other")
    bpy.context.window.scene = scene
    bpy.context.window.scene = next(each for each in bpy.data.scenes if each != scene)
    bpy.data.scenes.remove(scene)
