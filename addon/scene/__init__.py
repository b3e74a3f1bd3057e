"""What Blender holds: objects and their surfaces read, shape keys, records and results written."""

from spectral_tv.later import modules_of

__getattr__ = modules_of(__name__)

FILES = (
    "band_nodes",
    "decomposition",
    "documents",
    "masks",
    "naming",
    "results",
    "work_objects",
)
LOADED = ("records.adopt_all",)
