"""The units and axes of files, and the options of exporters that give a new file the same ones."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from spectral_tv.files import fbx, usd

AXES = "XYZ"
# What stands for a USD file that does not say.
USD_METRES, USD_UP = 0.01, "Y"
USD_UNITS = {1.0: "METERS", 0.01: "CENTIMETERS", 0.001: "MILLIMETERS", 1000.0: "KILOMETERS",
             0.0254: "INCHES", 0.3048: "FEET", 0.9144: "YARDS"}  # fmt: skip


def units_of(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """What a file says of its units and axes, and the options to write another alike."""
    read = READERS.get(path.suffix.lower())
    return read(path) if read is not None else ({}, {})


def _of_fbx(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    found = fbx.metadata(path)
    options: dict[str, Any] = {}
    up, front = int(found.get("UpAxis", 1)), int(found.get("FrontAxis", 2))
    up_sign, front_sign = found.get("UpAxisSign", 1), found.get("FrontAxisSign", 1)
    if up in (0, 1, 2) and front in (0, 1, 2) and up != front:
        options["axis_up"] = ("-" if up_sign < 0 else "") + AXES[up]
        options["axis_forward"] = ("-" if front_sign > 0 else "") + AXES[front]
    centimetres = found.get("UnitScaleFactor", 1.0)
    if centimetres == 100:
        options["apply_scale_options"] = "FBX_SCALE_UNITS"
    told = {"metres_per_unit": centimetres / 100, "up_axis": options.get("axis_up", "Y")}
    return told, options


def _of_usd(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    found = usd.metadata(path)
    metres, up = found.get("metersPerUnit", USD_METRES), found.get("upAxis", USD_UP)
    options: dict[str, Any] = {}
    if up == "Y":
        options |= {
            "convert_orientation": True,
            "export_global_up_selection": "Y",
            "export_global_forward_selection": "NEGATIVE_Z",
        }
    named = next((name for unit, name in USD_UNITS.items() if abs(metres / unit - 1) < 1e-6), None)
    options["convert_scene_units"] = named or "CUSTOM"
    if named is None:
        options["meters_per_unit"] = metres
    return {"metres_per_unit": metres, "up_axis": up}, options


READERS: Mapping[str, Callable[[Path], tuple[dict[str, Any], dict[str, Any]]]] = {
    ".fbx": _of_fbx,
    ".usd": _of_usd,
    ".usda": _of_usd,
    ".usdc": _of_usd,
    ".usdz": _of_usd,
    ".glb": lambda _path: ({"metres_per_unit": 1.0, "up_axis": "Y"}, {}),
    ".gltf": lambda _path: ({"metres_per_unit": 1.0, "up_axis": "Y"}, {}),
    ".obj": lambda _path: ({"up_axis": "Y"}, {}),
}
