"""Lengths in the unit of the scene, as a user reads them."""

from typing import Any

import bpy


def told(length: float, precision: int = 3) -> str:
    """A length such as ``0.3 mm``."""
    units = bpy.context.scene.unit_settings
    return bpy.utils.units.to_string(
        units.system, "LENGTH", length * units.scale_length, precision=precision
    )


def unit() -> dict[str, Any]:
    """What lengths of the scene are in, for reports."""
    units = bpy.context.scene.unit_settings
    if units.system == "NONE":
        return {"system": "none"}
    return {"system": units.system.lower(), "metres_per_unit": round(units.scale_length, 9)}
