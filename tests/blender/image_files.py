"""Images for the tests of the image operator, made with what every Blender's Python has."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import bpy
import numpy as np


def stored(image: bpy.types.Image) -> np.ndarray:
    """What Blender holds of an image, (H, W, channels) from the bottom up."""
    flat = np.empty(image.size[0] * image.size[1] * image.channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    return flat.reshape(image.size[1], image.size[0], image.channels)


def new(name: str, pixels: np.ndarray, is_float: bool = False, **settings: str) -> bpy.types.Image:
    """A packed image of (H, W, 4) values as Blender stores them, from the bottom up."""
    height, width, _ = pixels.shape
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=is_float)
    for setting, value in settings.items():
        setattr(image, setting, value)
    fill(image, pixels)
    image.pack()
    return image


def fill(image: bpy.types.Image, pixels: np.ndarray) -> None:
    image.pixels.foreach_set(np.ascontiguousarray(pixels, dtype=np.float32).ravel())
    image.update()


def write_png16(path: Path, values: np.ndarray) -> Path:
    """Write (H, W, 4) from the top down, as a PNG with 16 bits."""
    height, width, _ = values.shape
    rows = np.rint(65535 * values).astype(">u2").reshape(height, -1)
    data = b"".join(b"\0" + row.tobytes() for row in rows)
    header = struct.pack(">IIBBBBB", width, height, 16, 6, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(data)), (b"IEND", b""))
    chunks = [
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in parts
    ]
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(chunks))
    return path


def raw(image: bpy.types.Image) -> np.ndarray:
    """The values in the file of an image, (H, W, 4) from the bottom up."""
    copy = image.copy()
    copy.colorspace_settings.is_data = True
    copy.alpha_mode = "CHANNEL_PACKED"
    found = stored(copy)
    bpy.data.images.remove(copy)
    return found
