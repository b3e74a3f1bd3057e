"""Deformations: what holds and moves an object, and the shapes that it gets."""

from spectral_tv.later import modules_of

__getattr__ = modules_of(__name__)

FILES = (
    "constraints",
    "constraint_operators",
    "deform_operator",
    "live_operator",
    "bake_operator",
    "rig_operator",
    "pick_operator",
    "panel",
    "results",
)
VERBS = ("Deform",)
START = ("overlay.start",)
LOADED = ("versions.keep_algorithms",)
FORGET = (
    "live_operator.end",
    "pick_operator.end",
    "overlay.forget",
)
WITHDRAW = ("overlay.withdraw",)
