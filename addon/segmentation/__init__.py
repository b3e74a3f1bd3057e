"""Parts: found alike in several poses, and written on them."""

from spectral_tv.later import modules_of

__getattr__ = modules_of(__name__)

FILES = (
    "properties",
    "cosegment",
    "split_segments",
    "panel",
)
