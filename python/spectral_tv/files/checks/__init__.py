"""Checks whether a file is whole, by the length that its format states or by the way it ends.

They detect a file that was cut short anywhere. They do not judge its content.
"""

import struct
from collections.abc import Callable
from pathlib import Path

from spectral_tv.files.checks import pictures, scenes, shapes
from spectral_tv.files.torn import Torn

CHECKS: dict[str, Callable[[Path], None]] = {
    ".ply": shapes.ply, ".stl": shapes.stl, ".obj": shapes.obj, ".blend": scenes.blend,
    ".glb": scenes.glb, ".gltf": scenes.gltf, ".fbx": scenes.fbx, ".usd": scenes.usd,
    ".usda": scenes.usd, ".usdc": scenes.usd, ".usdz": scenes.usdz, ".abc": scenes.abc,
    ".dae": scenes.dae, ".png": pictures.png, ".jpg": pictures.jpeg, ".jpeg": pictures.jpeg,
    ".tif": pictures.tiff, ".tiff": pictures.tiff, ".webp": pictures.webp, ".bmp": pictures.bmp,
    ".tga": pictures.tga, ".exr": pictures.exr,
}  # fmt: skip


def check(path: Path) -> None:
    """Raise Torn if a file of one of these suffixes is not whole."""
    test = CHECKS.get(path.suffix.lower())
    if test is None:
        return
    try:
        test(path)
    except (ValueError, LookupError, OverflowError, struct.error) as error:
        raise Torn("it makes no sense where it ends") from error


__all__ = ["CHECKS", "Torn", "check"]
