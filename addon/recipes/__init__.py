"""Recipes: a method, its settings and a filter under one name, dialled by one strength."""

from . import menu, operator, own, own_operators, panel, properties, verb

FILES = (properties, operator, own, own_operators, menu, panel)
VERBS = (verb.Recipe,)
START = (menu.add,)
WITHDRAW = (menu.remove,)
FORGET = (own.forget,)
