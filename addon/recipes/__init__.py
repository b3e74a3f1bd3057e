"""Recipes: a method, its settings and a filter under one name, dialled by one strength."""

from . import menu, operator, own, own_operators, panel, properties

FILES = (properties, operator, own, own_operators, menu, panel)
VERBS = ("Recipe",)
START = (menu.add,)
WITHDRAW = (menu.remove,)
FORGET = (own.forget,)
