"""Recipes: a method, its settings and a filter under one name, dialled by one strength."""

from spectral_tv.later import modules_of

__getattr__ = modules_of(__name__)

FILES = (
    "properties",
    "operator",
    "own",
    "own_operators",
    "menu",
    "panel",
)
VERBS = ("Recipe",)
START = ("menu.add",)
WITHDRAW = ("menu.remove",)
FORGET = ("own.forget",)
