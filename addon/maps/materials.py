"""A material that shows a map on a mesh."""

from pathlib import Path

import bpy
from spectral_tv.notes import note

from .settings import DISPLACEMENT, NORMAL, TANGENT

GAP = 300


def show_map(obj: bpy.types.Object, target: Path, kind: str, uv_map: str) -> bpy.types.Material:
    """Give an object a new material that shows the map in a file, in all its slots.

    The slots have it by the object, so that those of the mesh stay as they are.
    """
    material = bpy.data.materials.new(f"{obj.name} Map")
    if material.node_tree is None:  # before Blender 5, where setting it is deprecated
        material.use_nodes = True
    tree = material.node_tree
    shader, output = tree.nodes["Principled BSDF"], tree.nodes["Material Output"]
    uvs, texture = (tree.nodes.new(f"ShaderNode{each}") for each in ("UVMap", "TexImage"))
    uvs.uv_map = uv_map
    texture.image = _image(target)
    texture.extension = "EXTEND"  # as borders of the map are not those of a tile
    tree.links.new(uvs.outputs["UV"], texture.inputs["Vector"])
    if kind == NORMAL:
        node = tree.nodes.new("ShaderNodeNormalMap")
        node.uv_map = uv_map
        tree.links.new(texture.outputs["Color"], node.inputs["Color"])
        tree.links.new(node.outputs["Normal"], shader.inputs["Normal"])
    else:
        node = _displace(tree, kind, texture)
        tree.links.new(node.outputs["Displacement"], output.inputs["Displacement"])
        material.displacement_method = "BOTH"
        _tell_vertices(obj, material)
    for place, each in enumerate((node, texture, uvs), start=1):
        each.location = shader.location.x - place * GAP, shader.location.y - GAP
    _put(obj, material)
    return material


def _image(target: Path) -> bpy.types.Image:
    """The image of the file, as it is now: data, not colors."""
    image = bpy.data.images.load(str(target), check_existing=True)
    image.reload()
    image.colorspace_settings.is_data = True
    if bpy.data.filepath and target.drive == Path(bpy.data.filepath).drive:
        image.filepath = bpy.path.relpath(str(target))
    return image


def _displace(
    tree: bpy.types.NodeTree, kind: str, texture: bpy.types.ShaderNodeTexImage
) -> bpy.types.ShaderNode:
    """A node that takes lengths in object space, of which 0 is no movement."""
    if kind == DISPLACEMENT:
        node = tree.nodes.new("ShaderNodeDisplacement")
        node.space, into = "OBJECT", "Height"
    else:
        node = tree.nodes.new("ShaderNodeVectorDisplacement")
        node.space, into = "TANGENT" if kind == TANGENT else "OBJECT", "Vector"
    node.inputs["Midlevel"].default_value, node.inputs["Scale"].default_value = 0, 1
    tree.links.new(texture.outputs["Color"], node.inputs[into])
    return node


def _tell_vertices(obj: bpy.types.Object, material: bpy.types.Material) -> None:
    """Note that the material moves vertices, and how there are more of them."""
    if any(modifier.type in ("SUBSURF", "MULTIRES") for modifier in obj.modifiers):
        return
    note(
        f"in renders {material.name!r} moves the vertices that there are, and bumps the rest. A "
        "Subdivision modifier gives it more; bake with it, as it changes the surface too"
    )


def _put(obj: bpy.types.Object, material: bpy.types.Material) -> None:
    if not obj.material_slots:
        obj.data.materials.append(material)
        return
    before = {slot.material.name for slot in obj.material_slots if slot.material is not None}
    for slot in obj.material_slots:
        slot.link = "OBJECT"
        slot.material = material
    if before:
        note(
            f"the slots of {obj.name!r} show {material.name!r} by the object, in the place of "
            f"{', '.join(sorted(before))}; Link: Data in a slot has the mesh's own again"
        )
