"""Which objects can be worked on, and why others cannot."""

import bpy
from spectral_tv.refusal import Refusal


def is_mesh(obj: bpy.types.Object | None) -> bool:
    """Whether there is an object and it is a mesh."""
    return obj is not None and obj.type == "MESH"


def refusal(
    obj: bpy.types.Object | None,
    edit_mode: bool = False,
    override: bool = False,
    linked_mesh: bool = False,
) -> str | None:
    """Why ``obj`` cannot be worked on, in a sentence for the user; None if it can.

    Edit Mode is a reason unless ``edit_mode`` allows it, a library override unless ``override``,
    the mesh of another file unless ``linked_mesh``.
    """
    if obj is None:
        return "There is no active object"
    if obj.type != "MESH":
        return "The active object is not a mesh"
    if obj.mode == "EDIT" and not edit_mode:
        return "Leave Edit Mode first"
    # What is written meanwhile is overwritten in the end.
    if obj.data.is_editmode and obj.mode != "EDIT":
        return "The mesh is in Edit Mode as that of another object; leave that first"
    if obj.use_dynamic_topology_sculpting:
        return "Turn Dyntopo off first"
    if obj.library is not None or (obj.data.library is not None and not linked_mesh):
        return "The mesh is linked from another file; make it local first"
    # Files keep changed values of an override, but neither shape keys nor lists that were added.
    if (obj.override_library or obj.data.override_library) and not override:
        return "The object overrides one of another file; make it local first"
    if len(obj.data.polygons) == 0:
        return "The mesh has no faces"
    keys = obj.data.shape_keys
    if keys is not None and not keys.use_relative:
        return "The mesh has absolute shape keys; relative ones are needed"
    return None


def selected_meshes(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The active object and the other selected meshes."""
    others = [
        obj
        for obj in context.selected_objects
        if obj.type == "MESH" and obj != context.active_object
    ]
    return [context.active_object, *others]


def user_of(mesh: bpy.types.Mesh) -> bpy.types.Object | None:
    """An object that has a mesh, the active one if it does."""
    active = bpy.context.active_object
    if active is not None and active.data == mesh:
        return active
    return next((obj for obj in bpy.data.objects if obj.data == mesh), None)


def distinct_meshes(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The same, but one of those that share a mesh.

    Raises Refusal if one of them cannot be worked on.
    """
    found: dict[bpy.types.Mesh, bpy.types.Object] = {}
    for obj in selected_meshes(context):
        reason = refusal(obj)
        if reason is not None:
            raise Refusal(f"{obj.name}: {reason}")
        found.setdefault(obj.data, obj)
    return list(found.values())


def take_place(obj: bpy.types.Object, other: bpy.types.Object) -> None:
    """Have ``obj`` be active and selected instead of another object, which is hidden."""
    other.select_set(False)
    other.hide_set(True)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
