"""Deformations: what holds and moves an object, and what becomes of it."""

import bpy
from bpy.props import PointerProperty

from . import (
    bake_operator,
    constraint_operators,
    constraints,
    deform_operator,
    live_operator,
    panel,
    verb,
)

_FILES = (constraints, constraint_operators, deform_operator, live_operator, bake_operator, panel)
CLASSES = tuple(cls for file in _FILES for cls in file.CLASSES)
PROPERTIES = (
    (bpy.types.Object, "spectral_tv", PointerProperty(type=constraints.SpectralTVDeformation)),
)
VERBS = (verb.Deform(),)
FORGET = (live_operator.end,)
