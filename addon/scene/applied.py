"""The shape that modifiers show of an object, as a mesh or as an object of its own."""

import bpy

from . import results

# What is selected in Edit Mode. Of edges that a modifier adds Blender leaves it to chance.
SELECTED = (".select_vert", ".select_edge", ".select_poly")


def mesh_of(obj: bpy.types.Object) -> bpy.types.Mesh:
    """A new mesh of what is seen of ``obj`` now: its keys and its modifiers applied."""
    graph = bpy.context.evaluated_depsgraph_get()
    return bpy.data.meshes.new_from_object(
        obj.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph
    )


def copy_of(obj: bpy.types.Object) -> bpy.types.Object:
    """A new object of what is seen of ``obj``, in its collections."""
    return object_of(mesh_of(obj), obj, "Applied")


def object_of(mesh: bpy.types.Mesh, obj: bpy.types.Object, label: str) -> bpy.types.Object:
    """A new object like ``obj`` with a shape of its own and no modifiers, in its collections.

    Segments and other results on it are known as such.
    """
    mesh.name = f"{obj.data.name} {label}"
    for name in SELECTED:
        if name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[name])
    copy = obj.copy()
    copy.name = f"{obj.name} {label}"
    copy.data = mesh
    _undress(copy)
    for collection in obj.users_collection:
        collection.objects.link(copy)
    results.hand_on(obj, copy)
    return copy


def apply(obj: bpy.types.Object) -> None:
    """Give ``obj`` what is seen of it for its mesh, without modifiers and shape keys."""
    mesh = mesh_of(obj)
    mesh.name = obj.data.name
    obj.data = mesh
    _undress(obj)


def _undress(obj: bpy.types.Object) -> None:
    """Leave nothing that changes the shape of ``obj`` once more, or hides keys it is given."""
    obj.modifiers.clear()
    obj.show_only_shape_key = False
    if obj.parent_type in ("ARMATURE", "LATTICE"):  # a parent that bends its children
        obj.parent_type = "OBJECT"
