"""The shape that modifiers show of an object, as a mesh or as an object of its own."""

import bpy


def mesh_of(obj: bpy.types.Object) -> bpy.types.Mesh:
    """A new mesh of what is seen of ``obj`` now: its keys and its modifiers applied."""
    graph = bpy.context.evaluated_depsgraph_get()
    return bpy.data.meshes.new_from_object(
        obj.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph
    )


def copy_of(obj: bpy.types.Object) -> bpy.types.Object:
    """A new object of what is seen of ``obj``, in its collections."""
    mesh = mesh_of(obj)
    mesh.name = f"{obj.data.name} Applied"
    copy = obj.copy()
    copy.name = f"{obj.name} Applied"
    copy.data = mesh
    copy.modifiers.clear()
    for collection in obj.users_collection:
        collection.objects.link(copy)
    return copy


def apply(obj: bpy.types.Object) -> None:
    """Give ``obj`` what is seen of it for its mesh, without modifiers and shape keys."""
    mesh = mesh_of(obj)
    mesh.name = obj.data.name
    obj.data = mesh
    obj.modifiers.clear()
