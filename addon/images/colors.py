"""Color spaces, by the names that Blender has for them, and converting between them.

Blender converts to and from scene-linear values where files are read and written, and nowhere else
that scripts could use; so values go through an image that is packed, or a file.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from enum import Enum
from functools import cache
from pathlib import Path

import bpy
from spectral_tv.files.srgb import decoded, encoded
from spectral_tv.images.encoding import SRGB
from spectral_tv.later import np

from ..scene.temporary import Temporary

# What its conversions by Blender may be off by; it has fast ones, good for 8 bits.
NEAR = 1e-3
# How a file is written that keeps floats as they are.
_EXR = ("OPEN_EXR", "RGB", "32")


class Kind(Enum):
    """What the values of a color space are."""

    DATA = "no colors"
    LINEAR = "proportional to light"
    ENCODED = "for displays, or logarithmic"


def names() -> list[str]:
    """All color spaces of this Blender."""
    settings = bpy.types.ColorManagedInputColorspaceSettings
    return [item.identifier for item in settings.bl_rna.properties["name"].enum_items]


def scene_linear() -> str:
    """The color space that Blender works in, and holds images with floats in."""
    with Temporary() as now:
        image = now.made(bpy.data.images.new("Colors", 1, 1, float_buffer=True))
        return image.colorspace_settings.name


@cache
def kind_of(space: str) -> Kind:
    """What the values of a color space are."""
    with _image(np.zeros((1, 1, 3)), space) as image:
        if image.colorspace_settings.is_data:
            return Kind.DATA
    probe = np.array([[[0.5, 0.25, 0.125]]])
    whole, half = to_linear(probe, space), to_linear(probe / 2, space)
    near = np.allclose(half, whole / 2, rtol=NEAR, atol=1e-6)
    return Kind.LINEAR if near else Kind.ENCODED


def to_linear(values: np.ndarray, space: str) -> np.ndarray:
    """Scene-linear values of colors (H, W, 3) in a color space."""
    if space == SRGB and _is_plain(_to_linear, decoded):
        return decoded(values)
    return _to_linear(values, space)


def from_linear(values: np.ndarray, space: str) -> np.ndarray:
    """Colors (H, W, 3) in a color space, of scene-linear values."""
    if space == SRGB and _is_plain(_from_linear, encoded):
        return encoded(values)
    return _from_linear(values, space)


def _is_plain(ours, theirs) -> bool:
    """Whether sRGB is what it is by default: another configuration may have other primaries."""
    probe = np.array([[[0.1, 0.5, 0.9], [0.02, 0.3, 0.6]]])
    return np.abs(ours(probe, SRGB) - theirs(probe)).max() < NEAR


def _to_linear(values: np.ndarray, space: str) -> np.ndarray:
    with _image(values, space) as image:
        image.pack()
        image.buffers_free()  # read anew, as a file is
        return _pixels(image)


def _from_linear(values: np.ndarray, space: str) -> np.ndarray:
    with Temporary() as now, tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "colors.exr"
        scene = now.made(bpy.data.scenes.new("Colors"))
        settings = scene.render.image_settings
        settings.file_format, settings.color_mode, settings.color_depth = _EXR
        settings.color_management = "OVERRIDE"
        settings.linear_colorspace_settings.name = space
        now.enter_context(_image(values, scene_linear())).save_render(str(path), scene=scene)
        written = now.made(bpy.data.images.load(str(path)))
        make_raw(written)
        return _pixels(written)


def make_raw(image: bpy.types.Image) -> None:
    """Have an image's pixels be the values of its file."""
    image.colorspace_settings.is_data = True
    image.alpha_mode = "CHANNEL_PACKED"


@contextmanager
def _image(values: np.ndarray, space: str) -> Iterator[bpy.types.Image]:
    """A float image of values (H, W, 3)."""
    height, width, _ = values.shape
    with Temporary() as now:
        image = bpy.data.images.new("Colors", width, height, alpha=True, float_buffer=True)
        now.made(image)
        image.colorspace_settings.name = space
        image.alpha_mode = "CHANNEL_PACKED"
        stored = np.ones((height, width, 4), dtype=np.float32)
        stored[..., :3] = values
        image.pixels.foreach_set(stored.ravel())
        yield image


def _pixels(image: bpy.types.Image) -> np.ndarray:
    width, height = image.size
    flat = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    return flat.reshape(height, width, image.channels)[..., :3].astype(np.float64)
