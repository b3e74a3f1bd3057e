"""Inputs of Geometry Nodes modifiers: read, set, and their paths.

Until Blender 5.1 they are custom properties of the modifier; 5.2 has properties for them.
"""

from typing import Any

import bpy


def _has_properties(modifier: bpy.types.NodesModifier) -> bool:
    return hasattr(modifier, "properties")


def _input(modifier: bpy.types.NodesModifier, socket: str) -> Any:
    return getattr(modifier.properties.inputs, socket)


def value_of(modifier: bpy.types.NodesModifier, socket: str) -> Any:
    """The value of an input, by the identifier of its socket."""
    if _has_properties(modifier):
        return _input(modifier, socket).value
    return modifier[socket]


def set_value(modifier: bpy.types.NodesModifier, socket: str, value: float | bool) -> None:
    """Set it, and have Blender evaluate the object anew."""
    if _has_properties(modifier):
        _input(modifier, socket).value = value
    else:
        modifier[socket] = value
    modifier.id_data.update_tag()


def attribute_of(modifier: bpy.types.NodesModifier, socket: str) -> str:
    """The attribute that an input takes instead of its value; "" if it takes the value."""
    if _has_properties(modifier):
        given = _input(modifier, socket)
        return given.attribute_name if given.type == "ATTRIBUTE" else ""
    return modifier[f"{socket}_attribute_name"] if modifier[f"{socket}_use_attribute"] else ""


def set_attribute(modifier: bpy.types.NodesModifier, socket: str, name: str) -> None:
    """Have an input take an attribute; its value again if the name is ""."""
    if _has_properties(modifier):
        given = _input(modifier, socket)
        given.type, given.attribute_name = "ATTRIBUTE" if name else "VALUE", name
    else:
        modifier[f"{socket}_use_attribute"] = bool(name)
        modifier[f"{socket}_attribute_name"] = name
    modifier.id_data.update_tag()


def path_of(modifier: bpy.types.NodesModifier, socket: str) -> str:
    """The path from the object to the value of an input."""
    start = f'modifiers["{bpy.utils.escape_identifier(modifier.name)}"]'
    if _has_properties(modifier):
        return f"{start}.properties.inputs.{socket}.value"
    return f'{start}["{socket}"]'


def draw_value(
    row: bpy.types.UILayout, modifier: bpy.types.NodesModifier, socket: str, **how: Any
) -> None:
    """Draw an input as a field."""
    if _has_properties(modifier):
        row.prop(_input(modifier, socket), "value", **how)
    else:
        row.prop(modifier, f'["{socket}"]', **how)
