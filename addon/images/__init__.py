"""Images: their pixels read, split into bands, filtered, and written as new images."""

from . import operator, panel, properties

FILES = (properties, operator, panel)
VERBS = ("Filter",)
