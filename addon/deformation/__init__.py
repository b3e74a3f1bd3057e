"""Deformations: what holds and moves an object, and the shapes that it gets."""

from . import (
    bake_operator,
    constraint_operators,
    constraints,
    deform_operator,
    live_operator,
    overlay,
    panel,
    pick_operator,
    rig_operator,
    versions,
)

FILES = (
    constraints,
    constraint_operators,
    deform_operator,
    live_operator,
    bake_operator,
    rig_operator,
    pick_operator,
    panel,
)
VERBS = ("Deform",)
START = (overlay.start,)
LOADED = (versions.keep_algorithms,)
FORGET = (live_operator.end, pick_operator.end, overlay.forget)
WITHDRAW = (overlay.withdraw,)
