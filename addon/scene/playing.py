"""Having an object show another mesh on every frame, whatever vertices these have."""

from collections.abc import Sequence
from itertools import pairwise

import bpy

NAME = "Frames"
# Exporters write an object for each name that is seen. Since 5.2 a mesh that comes out of nodes has
# that of the mesh that went in.
NAMES_COME_ALONG = bpy.app.version >= (5, 2)


def play_meshes(
    obj: bpy.types.Object, meshes: Sequence[bpy.types.Mesh], frames: Sequence[int]
) -> bpy.types.Modifier:
    """Have ``obj`` show each mesh on its frame and until the next one, by a modifier of nodes.

    ``frames`` increase. The modifier's nodes keep the meshes, as objects of a collection that is in
    no scene.
    """
    if len({later - frame for frame, later in pairwise(frames[:-1])}) > 1:
        meshes, frames = _filled(meshes, frames)
    collection = bpy.data.collections.new(f"{obj.name} {NAME}")
    for place, mesh in enumerate(meshes):  # nodes have them by the order of their names
        collection.objects.link(bpy.data.objects.new(f"{collection.name} {place:06d}", mesh))
    modifier = obj.modifiers.new(NAME, "NODES")
    modifier.node_group = _nodes(collection, frames)
    return modifier


def take_apart(modifier: bpy.types.Modifier) -> None:
    """Remove such a modifier, and all that it shows."""
    group = modifier.node_group
    modifier.id_data.modifiers.remove(modifier)
    collection = group.nodes["Meshes"].inputs["Collection"].default_value
    members = list(collection.objects)
    meshes = {each.data for each in members}
    bpy.data.batch_remove([group, collection, *members])
    bpy.data.batch_remove([mesh for mesh in meshes if not mesh.users])


def _filled(
    meshes: Sequence[bpy.types.Mesh], frames: Sequence[int]
) -> tuple[list[bpy.types.Mesh], Sequence[int]]:
    """The same on every frame, without gaps."""
    found = []
    for mesh, (frame, later) in zip(meshes, pairwise([*frames, frames[-1] + 1]), strict=True):
        found += [mesh] * (later - frame)
    return found, range(frames[0], frames[-1] + 1)


def _nodes(collection: bpy.types.Collection, frames: Sequence[int]) -> bpy.types.NodeTree:
    """A group of nodes that shows the member of a collection that is the frame's. Frames are at
    equal distances but for the last."""
    group = bpy.data.node_groups.new(collection.name, "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    node, link = group.nodes.new, group.links.new
    meshes = node("GeometryNodeCollectionInfo")
    meshes.name = "Meshes"
    meshes.inputs["Collection"].default_value = collection
    for name in ("Separate Children", "Reset Children"):
        meshes.inputs[name].default_value = True

    def math(operation: str, one: bpy.types.NodeSocket, other: float) -> bpy.types.NodeSocket:
        made = node("ShaderNodeMath")
        made.operation = operation
        link(one, made.inputs[0])
        made.inputs[1].default_value = other
        return made.outputs[0]

    now = node("GeometryNodeInputSceneTime").outputs["Frame"]
    step = frames[1] - frames[0] if len(frames) > 1 else 1
    # Half a thousandth of a frame is rounding.
    passed = math("FLOOR", math("DIVIDE", math("SUBTRACT", now, frames[0] - 5e-4), step), 0)
    place = math("MAXIMUM", math("MINIMUM", passed, max(len(frames) - 2, 0)), 0)
    last = math("GREATER_THAN", now, frames[-1] - 5e-4)
    shown = node("ShaderNodeMath")
    shown.operation = "MAXIMUM"
    link(place, shown.inputs[0])
    link(math("MULTIPLY", last, len(frames) - 1), shown.inputs[1])
    # A node that compares has its inputs at other places in other Blenders.
    apart = node("ShaderNodeMath")
    apart.operation = "SUBTRACT"
    link(node("GeometryNodeInputIndex").outputs[0], apart.inputs[0])
    link(shown.outputs[0], apart.inputs[1])
    others = math("GREATER_THAN", math("ABSOLUTE", apart.outputs[0], 0), 0.5)
    removed = node("GeometryNodeDeleteGeometry")
    removed.domain = "INSTANCE"
    link(meshes.outputs[0], removed.inputs["Geometry"])
    link(others, removed.inputs["Selection"])
    realized = node("GeometryNodeRealizeInstances")
    link(removed.outputs[0], realized.inputs[0])
    shape = realized.outputs[0]
    if NAMES_COME_ALONG:
        shape = _nameless(group, shape)
    link(shape, node("NodeGroupOutput").inputs[0])
    return group


def _nameless(group: bpy.types.NodeTree, shape: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """The same mesh without the name of its own: what is joined has that of the first, made mesh,
    whose only vertex is deleted again."""
    node, link = group.nodes.new, group.links.new
    point, joined = node("GeometryNodeMeshLine"), node("GeometryNodeJoinGeometry")
    point.inputs["Count"].default_value = 1
    link(shape, joined.inputs[0])
    link(point.outputs[0], joined.inputs[0])  # the last link comes first
    first, without = node("ShaderNodeMath"), node("GeometryNodeDeleteGeometry")
    first.operation = "LESS_THAN"
    link(node("GeometryNodeInputIndex").outputs[0], first.inputs[0])
    first.inputs[1].default_value = 0.5
    link(joined.outputs[0], without.inputs["Geometry"])
    link(first.outputs[0], without.inputs["Selection"])
    return without.outputs[0]
