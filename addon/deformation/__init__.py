"""Deformations: what holds and moves an object, and the shapes that it gets."""

from . import (
    bake_operator,
    constraint_operators,
    constraints,
    deform_operator,
    live_operator,
    panel,
    verb,
    versions,
)

FILES = (constraints, constraint_operators, deform_operator, live_operator, bake_operator, panel)
VERBS = (verb.Deform,)
LOADED = (versions.keep_algorithms,)
FORGET = (live_operator.end,)
