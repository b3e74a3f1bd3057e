"""A survey of what a scene holds beside shapes, to compare with what a format can hold."""

from collections.abc import Iterator, Sequence

import bpy
import numpy as np
from spectral_tv.dataclass import dataclass

from ..scene.animation import curves_of
from ..scene.arrays import numbers
from ..scene.attribute_band import has_bands
from ..scene.channels import drivers_of
from ..scene.frames import depends_on_time
from ..scene.mix import keys_of
from .formats import APPLIED, HOLDS, NO

CURVES = ("CURVE", "SURFACE", "FONT", "META", "CURVES")
PLAIN = ("MESH", "EMPTY", "ARMATURE")
# Blender's own attributes; those with a dot before their names are too.
BUILT_IN = {
    "position", "material_index", "sharp_face", "sharp_edge", "custom_normal", "crease_edge",
    "crease_vert", "bevel_weight_edge", "bevel_weight_vert", "freestyle_edge", "freestyle_face",
    "UVMap", "skel:jointIndices", "skel:jointWeights",
}  # fmt: skip
# Modifiers that move vertices by themselves as frames go by.
MOVING = {"MESH_CACHE", "MESH_SEQUENCE_CACHE", "CLOTH", "SOFT_BODY", "OCEAN", "WAVE", "BUILD",
          "EXPLODE", "DYNAMIC_PAINT", "FLUID"}  # fmt: skip


@dataclass(frozen=True)
class Thing:
    """Something of a kind: whose it is, its name, and what else tells whether it is kept."""

    kind: str
    owner: str
    name: str
    detail: str = ""
    count: int = 1


def survey(objects: Sequence[bpy.types.Object], suffix: str) -> list[Thing]:
    """What objects that were read from a file of this suffix hold, as far as the format can."""
    found = [thing for obj in objects for thing in _of_object(obj)]
    return [thing for thing in found if HOLDS[suffix][thing.kind] not in (NO, APPLIED)]


def _of_object(obj: bpy.types.Object) -> Iterator[Thing]:
    name = obj.name
    if obj.type == "MESH":
        yield from _of_mesh(obj)
    elif obj.type == "CAMERA":
        yield Thing("cameras", name, name)
    elif obj.type == "LIGHT":
        yield Thing("lights", name, name)
    elif obj.type in CURVES:
        yield Thing("curves, texts", name, name, obj.type)
    elif obj.type not in PLAIN:
        yield Thing("other objects", name, name)
    if obj.parent is not None:
        yield Thing("parents", name, obj.parent.name)
    for collection in obj.users_collection:
        if collection in bpy.context.scene.collection.children_recursive:
            yield Thing("collections", name, collection.name)
    for key in own_properties(obj):
        yield Thing("custom properties", name, key)
    if is_animated(obj):
        yield Thing("animation", name, name, "shape" if has_moving_shape(obj) else "")


def _of_mesh(obj: bpy.types.Object) -> Iterator[Thing]:
    mesh, name = obj.data, obj.name
    yield Thing("objects apart", name, name)
    yield Thing("object names", name, name)
    for kind, layers in (("vertex colors", color_layers(mesh)), ("UV maps", uv_layers(mesh))):
        for layer in layers:
            yield Thing(kind, name, layer.name, getattr(layer, "data_type", ""))
    for material in filter(None, mesh.materials):
        yield Thing("materials", name, material.name)
        for image in images(material.node_tree):
            yield Thing("textures", name, image.name)
    if mesh.has_custom_normals:
        yield Thing("custom normals", name, name)
    for attribute in own_attributes(mesh):
        yield Thing("custom attributes", name, attribute.name, attribute.domain)
    for group in obj.vertex_groups if not armatures(obj) else ():
        yield Thing("vertex groups", name, group.name)
    for key in list(keys_of(mesh).keys())[1:]:
        yield Thing("shape keys", name, key)
    for modifier in obj.modifiers:
        if modifier.show_viewport:
            kind = "armatures" if modifier.type == "ARMATURE" else "modifiers"
            yield Thing(kind, name, modifier.name)
    edges, points = loose(mesh)
    for kind, what, count in (
        ("quads, n-gons", name, int((numbers(mesh.polygons, "loop_total") > 3).sum())),
        ("loose edges, points", "edges", edges),
        ("loose edges, points", "points", points),
    ):
        if count:
            yield Thing(kind, name, what, count=count)


def color_layers(mesh: bpy.types.Mesh) -> list[bpy.types.Attribute]:
    """The colors of a mesh, the active ones first."""
    active = mesh.color_attributes.active_color
    layers = list(mesh.color_attributes)
    return sorted(layers, key=lambda layer: active is None or layer.name != active.name)


def uv_layers(mesh: bpy.types.Mesh) -> list[bpy.types.MeshUVLoopLayer]:
    """The UV maps of a mesh, the active one first."""
    return sorted(mesh.uv_layers, key=lambda layer: layer.name != mesh.uv_layers.active.name)


def own_attributes(mesh: bpy.types.Mesh) -> list[bpy.types.Attribute]:
    """The attributes of a mesh that are neither Blender's own nor colors nor UV maps."""
    layers = {layer.name for layer in [*mesh.color_attributes, *mesh.uv_layers]}
    return [
        attribute
        for attribute in mesh.attributes
        if attribute.name not in layers | BUILT_IN and not attribute.name.startswith(".")
    ]


def own_properties(data: bpy.types.ID) -> list[str]:
    """The names of the custom properties of an object or a mesh that are the user's."""
    known = data.bl_rna.properties
    return [name for name in dict(data.items()) if name not in known and name != "cycles"]


def armatures(obj: bpy.types.Object) -> list[bpy.types.Modifier]:
    """The modifiers that have an armature move an object, and are on."""
    return [
        item
        for item in obj.modifiers
        if item.type == "ARMATURE" and item.object is not None and item.show_viewport
    ]


def is_animated(obj: bpy.types.Object) -> bool:
    """Whether an object, its shape keys or its vertices move as frames go by."""
    keys = obj.data.shape_keys if obj.type == "MESH" else None
    if any(constraint.type == "TRANSFORM_CACHE" for constraint in obj.constraints):
        return True
    return any(_has_animation(item) for item in (obj, obj.data, keys)) or has_moving_shape(obj)


def has_moving_shape(obj: bpy.types.Object) -> bool:
    """Whether modifiers move the vertices of an object as frames go by."""
    own = [item for item in obj.modifiers if item.show_viewport and not has_bands(item)]
    if any(item.type in MOVING for item in own):
        return True
    if any(item.type == "NODES" and depends_on_time(item.node_group) for item in own):
        return True
    curves = [*drivers_of(obj), *(curves_of(obj) or ())]
    return any(curve.data_path.startswith("modifiers[") for curve in curves)


def _has_animation(data: bpy.types.ID | None) -> bool:
    found = getattr(data, "animation_data", None)
    return found is not None and bool(found.action or found.nla_tracks or found.drivers)


def image_nodes(tree: bpy.types.NodeTree | None) -> Iterator[bpy.types.Node]:
    """The nodes with images in a tree of nodes and in the groups in it."""
    for node in tree.nodes if tree is not None else ():
        if node.type == "TEX_IMAGE" and node.image is not None:
            yield node
        elif node.type == "GROUP":
            yield from image_nodes(node.node_tree)


def images(tree: bpy.types.NodeTree | None) -> list[bpy.types.Image]:
    """The images of these."""
    return list(dict.fromkeys(node.image for node in image_nodes(tree)))


def loose(mesh: bpy.types.Mesh) -> tuple[int, int]:
    """How many edges are in no face, and how many vertices in no edge."""
    used = np.zeros(len(mesh.vertices), dtype=bool)
    used[_edges(mesh)] = True
    return len(loose_edges(mesh)), int((~used).sum())


def loose_edges(mesh: bpy.types.Mesh) -> np.ndarray:
    """The vertices of edges in no face, (E, 2)."""
    used = numbers(mesh.loops, "edge_index")
    is_loose = np.ones(len(mesh.edges), dtype=bool)
    is_loose[used] = False
    return _edges(mesh)[is_loose].astype(np.int64)


def _edges(mesh: bpy.types.Mesh) -> np.ndarray:
    return numbers(mesh.edges, "vertices", 2).reshape(-1, 2)
