"""How far a look is from the original: limited, measured, and shown in color."""

from spectral_tv.later import modules_of

__getattr__ = modules_of(__name__)

FILES = (
    "properties",
    "limit_movement",
    "measure",
    "panel",
)
START = ("heat_map.start",)
WITHDRAW = ("heat_map.withdraw",)
FORGET = ("heat_map.forget",)
