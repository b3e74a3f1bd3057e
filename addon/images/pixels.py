"""Reading the pixels of Blender's images, and writing new images beside them.

Values are those that Blender stores: as they are in the file for 8-bit images, which mostly are
encoded for displays (sRGB), and scene-linear for float images. No color space is converted.
"""

from dataclasses import dataclass

import bpy
import numpy as np

from ..scene.objects import Refusal
from ..scene.records import digest

# Of red, green and blue in luminance (ITU-R BT.709).
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class Pixels:
    """An image from the bottom up: ``values`` (H, W, C), C being 1 for grey; ``alpha`` (H, W)."""

    values: np.ndarray
    alpha: np.ndarray | None

    @property
    def luminance(self) -> np.ndarray:
        """Of colours, (H, W, 1); else the values."""
        if self.values.shape[2] != len(LUMINANCE):
            return self.values
        return (self.values @ LUMINANCE)[..., np.newaxis]


def refusal(image: bpy.types.Image | None) -> str | None:
    """Why an image cannot be worked on, in a sentence for the user; None if it can."""
    if image is None:
        return "There is no image; open one in the Image Editor"
    if image.source not in ("FILE", "GENERATED"):
        return f"{image.name} is no single still image"
    if image.size[0] < 2 or image.size[1] < 2:
        return f"{image.name} has no pixels that can be read"
    return None


def read(image: bpy.types.Image) -> Pixels:
    """Read an image; colours whose channels are all alike are read as grey.

    Raises Refusal if a value is not finite.
    """
    stored = _stored(image)
    broken = np.argwhere(~np.isfinite(stored))
    if len(broken):
        row, column, _ = broken[0]
        raise Refusal(f"the pixel at {column}, {row} from the lower left is not a finite number")
    values, alpha = stored, None
    if image.channels == 4:
        values, alpha = stored[..., :3], stored[..., 3]
    if (values == values[..., :1]).all():
        values = values[..., :1]
    return Pixels(values.astype(np.float64), alpha)


def state_of(image: bpy.types.Image) -> str:
    """Digest of all of an image that a result depends on."""
    return digest(np.array(image.size), _stored(image))


def write(source: bpy.types.Image, label: str, values: np.ndarray, is_signed: bool) -> int:
    """Write (H, W, C) beside its source, over what was written with this label before.

    Images with ``is_signed`` are floats that are not colours; others are stored as the source is.
    Returns how many pixels were cut off at black and white.
    """
    pixels = read(source)
    is_float = source.is_float or is_signed
    image = _target(source, label, is_float)
    if is_float:  # as they are held in memory, whatever the source was read from
        image.colorspace_settings.is_data = is_signed or source.colorspace_settings.is_data
        image.alpha_mode = "PREMUL"
    else:
        image.colorspace_settings.name = source.colorspace_settings.name
        image.alpha_mode = source.alpha_mode
    stored = np.ones((*values.shape[:2], 4), dtype=np.float32)
    stored[..., :3] = values  # grey in all of them
    if pixels.alpha is not None and not is_signed:
        stored[..., 3] = pixels.alpha
    cut = 0
    if not is_float:
        cut = int((np.abs(stored - stored.clip(0, 1)) > 1 / 255).any(axis=2).sum())
        stored = stored.clip(0, 1)
    image.pixels.foreach_set(stored.ravel())
    image.update()
    image.pack()
    return cut


def results_of(source: bpy.types.Image) -> list[bpy.types.Image]:
    """The images that were written of another."""
    return [image for image in bpy.data.images if image.spectral_tv.source == source]


def _target(source: bpy.types.Image, label: str, is_float: bool) -> bpy.types.Image:
    """The image to write into; one of another size or depth takes the place of the former."""
    former = next((i for i in results_of(source) if i.spectral_tv.label == label), None)
    wanted = (*source.size, is_float)
    if former is not None and (*former.size, former.is_float) == wanted:
        return former
    name = f"{source.name} {label}" if former is None else former.name
    image = bpy.data.images.new(name, *source.size, alpha=True, float_buffer=is_float)
    image.use_fake_user = True  # what the user has not put anywhere yet is saved all the same
    image.spectral_tv.source, image.spectral_tv.label = source, label
    if former is not None:
        former.user_remap(image)
        bpy.data.images.remove(former)
        image.name = name
    return image


def _stored(image: bpy.types.Image) -> np.ndarray:
    """(H, W, channels) float32, from the bottom up."""
    width, height = image.size
    flat = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    return flat.reshape(height, width, image.channels)
