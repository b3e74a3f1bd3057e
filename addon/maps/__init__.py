"""Maps over UVs, of what bands do: displacements and normals, baked by Cycles."""

from spectral_tv.later import modules_of

__getattr__ = modules_of(__name__)

FILES = (
    "bake_map",
    "panel",
)
VERBS = ("BakeMap",)
