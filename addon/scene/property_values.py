"""Groups of properties as plain values: read, and set again."""

from typing import Any

import bpy


def values_of(group: bpy.types.PropertyGroup) -> dict[str, Any]:
    """The properties of a group and of those in it, in plain lists."""
    found = {}
    for name, declared in _declared(group):
        value = getattr(group, name)
        if declared.type == "COLLECTION":
            found[name] = [values_of(each) for each in value]
        elif isinstance(value, bpy.types.PropertyGroup):
            found[name] = values_of(value)
        else:
            found[name] = tuple(value) if getattr(declared, "is_array", False) else value
    return found


def set_values_of(group: bpy.types.PropertyGroup, values: dict[str, Any]) -> None:
    """Set the properties of a group to what was read of one like it."""
    for name, declared in _declared(group):
        if name not in values:
            continue
        if declared.type == "COLLECTION":
            collection = getattr(group, name)
            collection.clear()
            for each in values[name]:
                set_values_of(collection.add(), each)
        elif isinstance(values[name], dict):
            set_values_of(getattr(group, name), values[name])
        else:
            setattr(group, name, values[name])


def _declared(group: bpy.types.PropertyGroup) -> list[tuple[str, bpy.types.Property]]:
    return [
        each for each in group.bl_rna.properties.items() if each[0] not in ("rna_type", "bl_rna")
    ]
