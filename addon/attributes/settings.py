"""The settings of functions on a mesh that only Blender has."""

from typing import Any

import bpy
from spectral_tv.attributes import settings
from spectral_tv.attributes.settings import elements
from spectral_tv.dataclass import dataclass
from spectral_tv.options.declaring import Only, choice, name_of, redeclared

from . import sources

PARTS = (
    ("GROUPS", "Vertex Groups", "The mean value of every chosen vertex group"),
    ("VERTICES", "Selected Vertices", "The value of every vertex selected in Edit Mode"),
)


def _names(choices: Any, context: bpy.types.Context, _text: str) -> list[str]:
    obj = context.active_object
    return sources.names(obj, choices.kind) if obj is not None and obj.type == "MESH" else []


@dataclass(frozen=True)
class Settings(settings.Settings):
    """What is flowed, how, and what of it is written."""

    source: str = redeclared(settings.Settings, "source", search=_names)


@dataclass(frozen=True)
class EigensetSettings:
    """How a set is tested."""

    elements: str = elements()


@dataclass(frozen=True)
class Measure(Settings):
    """The same, and whose values over time are told."""

    parts: str = choice("Values of", "Whose values are told", PARTS, place="parts")
    groups: str = name_of(
        "Groups",
        "Vertex groups, with commas between; all but those written here if empty",
        applies=Only("parts", ["GROUPS"]), dims=True, place="parts"
    )  # fmt: skip
