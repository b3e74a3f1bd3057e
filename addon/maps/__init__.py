"""Maps over UVs, of what bands do: displacements and normals, baked by Cycles."""

from . import bake_map, panel

FILES = (bake_map, panel)
VERBS = ("BakeMap",)
