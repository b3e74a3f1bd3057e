"""What a file holds, as values that can be compared: for tests that nothing else changes."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

# Of every type of attribute: where its data are, how many, and their dtype.
TYPES = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int8),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT2": ("vector", 2, np.float32),
    "INT16_2D": ("value", 2, np.int16),
    "INT32_2D": ("value", 2, np.int32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
}


def contents() -> dict[str, Any]:
    """All that operators of the extension may touch, by data-block."""
    found: dict[str, Any] = {}
    for obj in bpy.data.objects:
        found[f"object {obj.name}"] = _object(obj)
    for mesh in [mesh for mesh in bpy.data.meshes if mesh.users]:  # others are not saved
        found[f"mesh {mesh.name}"] = of_mesh(mesh)
    for scene in bpy.data.scenes:
        chosen = values(scene.spectral_tv).items()
        # Lengths follow from the shape.
        found[f"scene {scene.name}"] = {
            name: value for name, value in chosen if not name.startswith("length_")
        }
    for image in [image for image in bpy.data.images if image.source != "VIEWER"]:
        found[f"image {image.name}"] = (*image.size, _flat(image.pixels, None, len(image.pixels)))
    for text in bpy.data.texts:
        found[f"text {text.name}"] = text.as_string()
    for group in bpy.data.node_groups:
        found[f"nodes {group.name}"] = [node.name for node in group.nodes]
    return found


def differences(before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """Names of what is not the same."""
    found = []
    for name in sorted(before.keys() | after.keys()):
        one, other = before.get(name), after.get(name)
        if isinstance(one, dict) and isinstance(other, dict):
            found += [f"{name}: {each}" for each in differences(one, other)]
        elif one != other:
            found.append(name)
    return found


def _object(obj: bpy.types.Object) -> dict[str, Any]:
    found: dict[str, Any] = {
        "data": obj.data and obj.data.name,
        "matrix": [tuple(row) for row in obj.matrix_basis],
        "deformation": values(obj.spectral_tv),
        "parent": obj.parent and (obj.parent.name, [tuple(r) for r in obj.matrix_parent_inverse]),
        "modifiers": [(each.name, each.type, each.show_viewport) for each in obj.modifiers],
        "inputs": [_inputs(each) for each in obj.modifiers if each.type == "NODES"],
        "action": _action(obj),
    }
    if obj.type == "ARMATURE":
        found["bones"] = [_bone(bone) for bone in obj.pose.bones]
    if obj.type == "MESH":
        found["painting"] = values(obj.spectral_tv_painting)
        found["active key"] = obj.active_shape_key_index
        found["groups"] = [group.name for group in obj.vertex_groups]
        found["work"] = values(obj.spectral_tv_work)
        found["levels"] = [_levels(obj, each) for each in obj.modifiers if each.type == "MULTIRES"]
    return found


def _inputs(modifier: bpy.types.NodesModifier) -> list[tuple[Any, ...]]:
    """The inputs of Geometry Nodes: labels, values or attributes, and ends of sliders."""
    found: list[tuple[Any, ...]] = []
    for socket in modifier.node_group.interface.items_tree:
        name = socket.identifier
        if socket.in_out != "INPUT" or socket.socket_type == "NodeSocketGeometry":
            continue
        if hasattr(modifier, "properties"):  # since Blender 5.2
            given = getattr(modifier.properties.inputs, name)
            fields = [getattr(given, each, None) for each in ("value", "type", "attribute_name")]
        else:
            ends = ("", "_use_attribute", "_attribute_name")
            fields = [modifier.get(f"{name}{each}") for each in ends]
        ends = [getattr(socket, each, None) for each in ("min_value", "max_value")]
        found.append((socket.name, *fields, *ends))
    return found


def _action(data: bpy.types.ID) -> str | None:
    """The name of the action that a data-block plays."""
    action = data.animation_data and data.animation_data.action
    return action and action.name


def _levels(obj: bpy.types.Object, modifier: bpy.types.MultiresModifier) -> tuple[Any, ...]:
    """The levels of a sculpt, and the top one without what else the object has."""
    probe = obj.copy()
    probe.animation_data_clear()
    for other in [each for each in probe.modifiers if each.name != modifier.name]:
        probe.modifiers.remove(other)
    probe.modifiers[0].levels = modifier.total_levels
    probe.show_only_shape_key, probe.active_shape_key_index = True, 0
    bpy.context.scene.collection.objects.link(probe)
    top = probe.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    shape = _flat(top.vertices, "co", 3 * len(top.vertices))
    bpy.data.objects.remove(probe)
    shown = modifier.levels, modifier.sculpt_levels, modifier.render_levels
    return (*shown, modifier.total_levels, shape)


def _bone(posed: bpy.types.PoseBone) -> tuple[Any, ...]:
    """A bone, its rest and its pose."""
    matrices = (posed.bone.matrix_local, posed.matrix_basis)
    rows = [tuple(row) for matrix in matrices for row in matrix]
    return (posed.name, posed.parent and posed.parent.name, posed.length, rows)


def of_mesh(mesh: bpy.types.Mesh) -> dict[str, Any]:
    """Its vertices, faces, weights, attributes, shape keys and what the extension remembers."""
    found: dict[str, Any] = {
        "co": _flat(mesh.vertices, "co", 3 * len(mesh.vertices)),
        "corners": _flat(mesh.loops, "vertex_index", len(mesh.loops), np.int32),
        "weights": [[(g.group, g.weight) for g in v.groups] for v in mesh.vertices if v.groups],
        "active color": mesh.color_attributes.active_color_index,
        "remembered": values(mesh.spectral_tv),
    }
    for attribute in mesh.attributes:
        field, channels, dtype = TYPES[attribute.data_type]
        count = channels * len(attribute.data)
        found[f"attribute {attribute.name}"] = _flat(attribute.data, field, count, dtype)
    keys = mesh.shape_keys
    if keys is not None:
        found["bands"] = values(keys.spectral_tv)
        found["action"] = _action(keys)
        for key in keys.key_blocks:
            found[f"key {key.name}"] = (
                _flat(key.data, "co", 3 * len(key.data)),
                (key.value, key.mute, key.vertex_group, key.slider_min, key.slider_max),
            )
    return found


def values(group: bpy.types.PropertyGroup) -> dict[str, Any]:
    """The properties of a group and of the groups in it, but for arbitrary identifiers."""
    found = {}
    for name, declared in group.bl_rna.properties.items():
        if name in ("rna_type", "bl_rna", "identifier", "mark"):
            continue
        value = getattr(group, name)
        if declared.type == "COLLECTION":
            found[name] = [values(each) for each in value]
        elif isinstance(value, bpy.types.PropertyGroup):
            found[name] = values(value)
        elif declared.type == "POINTER":
            found[name] = value and value.name
        else:
            found[name] = tuple(value) if getattr(declared, "is_array", False) else value
    return found


def _flat(data: Any, field: str | None, count: int, dtype: type = np.float32) -> bytes:
    flat = np.empty(count, dtype=dtype)
    if field is None:
        data.foreach_get(flat)
    else:
        data.foreach_get(field, flat)
    return flat.tobytes()
