"""Images: their pixels read, split into bands, filtered, and written as new images."""

from spectral_tv.later import modules_of

__getattr__ = modules_of(__name__)

FILES = (
    "properties",
    "operator",
    "panel",
)
VERBS = ("Filter",)
