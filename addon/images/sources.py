"""Reading Blender's images as they are shown, with what was painted on them."""

from __future__ import annotations

import bpy
from spectral_tv.images.pixels import Pixels
from spectral_tv.later import np

from ..scene.contents import digest
from ..scene.temporary import Temporary
from . import colors

# Why images of other sources and types are not worked on.
OTHERS = {
    "SEQUENCE": "is a sequence of images; open one of them by itself",
    "MOVIE": "is a movie; open one of its frames as an image",
    "TILED": "has several tiles (UDIM); open one of them by itself",
    "VIEWER": "is what a render or a node shows; save it as an image",
    "MULTILAYER": "has several layers; save one of them as an image",
}


def refusal(image: bpy.types.Image | None) -> str | None:
    """Why an image cannot be worked on, in a sentence for the user; None if it can."""
    if image is None:
        return "There is no image; open one in the Image Editor"
    width, height = image.size  # reads it, which may tell its type
    if image.source not in ("FILE", "GENERATED"):
        return f"{image.name} {OTHERS[image.source]}"
    if image.type not in ("IMAGE", "UV_TEST"):
        return f"{image.name} {OTHERS.get(image.type, OTHERS['VIEWER'])}"
    if image.is_multiview or image.is_stereo_3d:
        return f"{image.name} has several views; save one of them as an image"
    if width == 0 or height == 0:
        return f"{image.name} has no pixels that can be read"
    if width < 2 or height < 2:
        return f"{image.name} has {width} × {height} pixels, but 2 × 2 are needed"
    return None


def read(image: bpy.types.Image) -> Pixels:
    """Read an image as it is seen now.

    Values are those of its file, for displays in most formats and scene-linear in OpenEXR.
    """
    stored = stored_in(image)
    space = image.colorspace_settings.name
    mode = image.alpha_mode
    has_alpha = image.channels == 4 and mode in ("STRAIGHT", "PREMUL")
    if not image.is_float:
        return Pixels(stored, space, has_alpha, is_associated=False)
    is_associated = mode == "PREMUL"
    kind = colors.kind_of(space)
    # Blender converted the values when it read the file, not always so that they can be had back.
    values = stored if kind is colors.Kind.DATA else _of_file(image, stored)
    if values is not None:
        return Pixels(values, space, has_alpha, is_associated)
    seen = Pixels(stored, colors.scene_linear(), has_alpha, is_associated=True)
    if kind is colors.Kind.LINEAR:
        return seen
    straight = seen.associated(False).stored.copy()
    straight[..., :3] = colors.from_linear(straight[..., :3], space)
    return Pixels(straight, space, has_alpha, is_associated=False)


def state_of(image: bpy.types.Image) -> str:
    """Digest of all of an image that a result depends on."""
    settings = f"{image.colorspace_settings.name} {image.alpha_mode}".encode()
    size = np.array(image.size)
    return digest(size, np.frombuffer(settings, dtype=np.uint8), stored_in(image))


def stored_in(image: bpy.types.Image) -> np.ndarray:
    """What Blender holds of an image, (H, W, 4) float32 from the bottom up."""
    width, height = image.size
    flat = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    found = flat.reshape(height, width, image.channels)
    if image.channels == 4:
        return found
    stored = np.ones((height, width, 4), dtype=np.float32)
    stored[..., :3] = found[..., :3] if image.channels == 3 else found[..., :1]
    return stored


def _of_file(image: bpy.types.Image, stored: np.ndarray) -> np.ndarray | None:
    """The values in the file of an image; None if what is seen is not what is in it."""
    if image.source != "FILE" or image.is_dirty:
        return None
    with Temporary() as now:
        copy = now.made(image.copy())
        alike = (tuple(copy.size), copy.channels) == (tuple(image.size), image.channels)
        if not alike or not np.array_equal(stored_in(copy), stored, equal_nan=True):
            return None
        colors.make_raw(copy)
        return stored_in(copy)
