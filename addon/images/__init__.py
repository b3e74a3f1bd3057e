"""Images: their pixels read, split into bands, filtered, and written as new images."""

from . import operator, panel, properties, results, verb

FILES = (results, properties, operator, panel)
VERBS = (verb.Filter,)
