"""Names that Blender takes as they are: short enough, and nobody else's."""

from collections.abc import Container

import bpy

from .mix import keys_of

# Vertex groups and shape keys have room for so many bytes, attributes for a few more.
LONGEST = 63


def free_name(stem: str, label: str, taken: Container[str]) -> str:
    """``stem`` and ``label``, numbered where that is taken; the stem is cut where they are long."""
    tail = f" {label}" if label else ""
    number, end = 0, tail
    while (name := _cut(stem, LONGEST - len(end.encode())) + end) in taken:
        number += 1
        end = f"{tail}.{number:03}"
    return name


def taken_names(obj: bpy.types.Object, written: str) -> set[str]:
    """Names that a new KEY, GROUP or ATTRIBUTE of ``obj`` cannot have.

    Vertex groups are attributes too where meshes are evaluated, so these share their names.
    """
    if written == "KEY":
        return set(keys_of(obj.data).keys())
    return {*obj.data.attributes.keys(), *obj.vertex_groups.keys()}


def _cut(text: str, size: int) -> str:
    """The longest beginning of a text that takes at most so many bytes."""
    return text.encode()[: max(size, 0)].decode(errors="ignore").rstrip()
