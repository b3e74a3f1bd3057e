"""Checks whether a file is whole, by the length that its format states or by the way it ends.

They detect a file that was cut short anywhere. They do not judge its content.
"""

import struct
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from spectral_tv.files.torn import Torn

# The function for each suffix. Its file is read when it is needed: starts of Blender go without.
CHECKS = {
    ".ply": "shapes.ply", ".stl": "shapes.stl", ".obj": "shapes.obj", ".blend": "scenes.blend",
    ".glb": "scenes.glb", ".gltf": "scenes.gltf", ".fbx": "scenes.fbx", ".usd": "scenes.usd",
    ".usda": "scenes.usd", ".usdc": "scenes.usd", ".usdz": "scenes.usdz", ".abc": "scenes.abc",
    ".dae": "scenes.dae", ".png": "pictures.png", ".jpg": "pictures.jpeg", ".jpeg": "pictures.jpeg",
    ".tif": "pictures.tiff", ".tiff": "pictures.tiff", ".webp": "pictures.webp",
    ".bmp": "pictures.bmp", ".tga": "pictures.tga", ".exr": "pictures.exr",
}  # fmt: skip


def check(path: Path) -> None:
    """Raise Torn if a file of one of these suffixes is not whole."""
    named = CHECKS.get(path.suffix.lower())
    if named is None:
        return
    module, name = named.split(".")
    test: Callable[[Path], None] = getattr(import_module(f"{__name__}.{module}"), name)
    try:
        test(path)
    except (ValueError, LookupError, OverflowError, struct.error) as error:
        raise Torn("it makes no sense where it ends") from error


__all__ = ["CHECKS", "Torn", "check"]
