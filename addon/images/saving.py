"""Saving pictures to files, with the values that they have."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np
from spectral_tv.files import picture_tags
from spectral_tv.files.checks import check
from spectral_tv.files.profiles import fits, name_of
from spectral_tv.files.tiff import Meaning, write_tiff
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..command_line.formats import a
from ..scene.temporary import Temporary
from . import colors
from .colors import Kind
from .formats import BY_SUFFIX, DEPTHS, HALF_MAX, STEPS, Format
from .pixels import Pixels
from .reading import Picture
from .sources import stored_in

# What is black or transparent, of floats.
NOTHING = 1e-6
# How far values may be off where they are read again: of a step, and relatively of floats.
OF_STEP, OF_HALF, OF_FLOAT = 0.51, 2.0**-11, 2.0**-23
# Dots per inch that programs write where nobody chose any.
USUAL_DPI = (72, 96)
METRES_PER_INCH = 0.0254


@dataclass(frozen=True)
class Target:
    """A file to write."""

    path: Path
    suffix: str
    form: Format
    depth: str
    # Of formats that have one, in percent.
    quality: int | None

    @property
    def is_integer(self) -> bool:
        """Whether it holds nothing below black and above white."""
        return self.depth in STEPS


def save_picture(
    picture: Picture, path: Path, depth: str | None = None, quality: int | None = None
) -> None:
    """Save a picture in the format of the path's suffix, and make sure of what was written.

    Colors are converted where the format holds others: to scene-linear ones in OpenEXR, from
    linear ones of floats to sRGB in 8 and 16 bits. What cannot be kept is noted. Raises Refusal,
    Torn if the file was cut short, RuntimeError if Blender cannot write it, and OSError.
    """
    suffix = path.suffix.lower()
    form = BY_SUFFIX[suffix]
    depth = depth or form.depth_for(picture.header.depth)
    target = Target(path, suffix, form, depth, quality or form.quality)
    if target.depth not in form.holding(picture.header.depth):
        note(f"written with {DEPTHS[target.depth]}; the input has {DEPTHS[picture.header.depth]}")
    with _scene(target) as scene:
        pixels = _of_alpha(_of_space(picture, target), target, _holds_alpha(scene))
        pixels = replace(pixels, stored=_cut(pixels.stored, target))
        channels = _channels(picture, pixels, target)
        is_converted = pixels.space != picture.pixels.space
        profile = _profile(picture, target, channels, is_converted)
        if form.name == "TIFF":
            _save_tiff(picture, pixels, target, channels, profile)
        else:
            _save_by_blender(picture, pixels, target, channels, scene)
            check(path)
            _add_tags(picture, pixels, target, is_converted, profile)
    _check(pixels, target)


def _of_space(picture: Picture, target: Target) -> Pixels:
    """The picture in a color space that the format holds by convention."""
    pixels = picture.pixels
    kind = colors.kind_of(pixels.space)
    if target.form.is_linear and picture.header.format != "OpenEXR" and kind is Kind.ENCODED:
        space = colors.scene_linear()
    elif target.is_integer and picture.header.depth not in STEPS and kind is Kind.LINEAR:
        space = colors.SRGB
    else:
        return pixels
    straight = pixels.associated(False)
    stored = straight.stored.astype(np.float64)
    linear = colors.to_linear(stored[..., :3], pixels.space)
    stored[..., :3] = linear if target.form.is_linear else colors.from_linear(linear, space)
    note(f"its colors were converted from {pixels.space} to {space}")
    return replace(straight, stored=stored, space=space)


def _of_alpha(pixels: Pixels, target: Target, holds_alpha: bool) -> Pixels:
    """The picture with its alpha and its colors as the format has them."""
    if not pixels.has_alpha:
        return pixels
    alpha = pixels.stored[..., 3]
    under = (alpha == 0) & (np.abs(pixels.stored[..., :3]) > NOTHING).any(axis=2)
    if not holds_alpha:
        count = int((alpha < 1).sum())
        if count:
            note(
                f"{a(target.suffix)} has no alpha: {count} pixels that were transparent are shown "
                "in full"
            )
        opaque = pixels.associated(False)
        stored = opaque.stored.copy()
        stored[..., 3] = 1
        return replace(opaque, stored=stored, has_alpha=False)
    is_associated = target.form.is_associated
    if is_associated is None:
        is_associated = pixels.is_associated
    loses = target.form.loses_hidden or is_associated != pixels.is_associated
    if under.any() and loses:
        note(f"the colors of {int(under.sum())} pixels under alpha 0 are not kept")
    return pixels.associated(is_associated)


def _cut(stored: np.ndarray, target: Target) -> np.ndarray:
    """The values that the depth holds; those that are cut off are noted."""
    if target.depth == "float":
        return stored
    low, high, step = -HALF_MAX, HALF_MAX, 1.0
    if target.is_integer:
        low, high, step = 0.0, 1.0, 1 / STEPS[target.depth]
    known = np.nan_to_num(stored.astype(np.float64), posinf=np.inf, neginf=-np.inf)
    cut = known.clip(low, high)
    count = int((np.abs(known - cut) > step / 2).any(axis=2).sum())
    if count:
        percent = 100 * count / cut[..., 0].size
        note(
            f"{count} pixels ({percent:.2g} %) were cut off at what {DEPTHS[target.depth]} hold; "
            "floats, in .exr and .tif, hold all"
        )
    # Steps now, as Blender would round alpha after it has divided by it.
    return np.rint(cut * STEPS[target.depth]) * step if target.is_integer else cut


def _channels(picture: Picture, pixels: Pixels, target: Target) -> str:
    """Which channels to write, as Blender calls them, but BWA for grey with alpha."""
    form = target.form
    if picture.header.is_grey and pixels.has_alpha and form.holds_grey_alpha:
        return "BWA"
    if picture.header.is_grey and not pixels.has_alpha and form.holds_grey:
        return "BW"
    if picture.header.is_grey:
        grey, colors_ = "grey", "red, green and blue"
        if pixels.has_alpha:
            grey, colors_ = "grey with alpha", "red, green, blue and alpha"
        note(f"its {grey} becomes {colors_}, as no {grey} is written to {a(target.suffix)}")
    return "RGBA" if pixels.has_alpha else "RGB"


def _profile(picture: Picture, target: Target, channels: str, is_converted: bool) -> bytes | None:
    """The color profile to write; it is noted if what it says is lost."""
    profile = picture.header.profile
    if profile is None:
        return None
    if target.form.holds_profile and not is_converted and fits(profile, channels):
        return profile
    name = name_of(profile)
    if colors.SRGB not in name or picture.pixels.space != colors.SRGB:
        note(
            f"its color profile {name!r} is not kept; colors were taken for {picture.pixels.space}"
        )
    return None


def _save_tiff(
    picture: Picture, pixels: Pixels, target: Target, channels: str, profile: bytes | None
) -> None:
    wanted = {"BW": [0], "BWA": [0, 3], "RGB": [0, 1, 2], "RGBA": [0, 1, 2, 3]}[channels]
    rows = pixels.stored[::-1][..., wanted]
    if target.is_integer:
        dtype = np.uint8 if target.depth == "8" else np.uint16
        rows = np.rint(rows.astype(np.float64) * STEPS[target.depth]).astype(dtype)
    else:
        rows = rows.astype(np.float32)
    meaning = Meaning(pixels.has_alpha, pixels.is_associated, picture.header.resolution, profile)
    try:
        write_tiff(target.path, rows, meaning)
    except ValueError as error:
        raise Refusal(str(error)) from error


def _save_by_blender(
    picture: Picture, pixels: Pixels, target: Target, channels: str, scene: bpy.types.Scene
) -> None:
    height, width, _ = pixels.stored.shape
    stored = pixels.stored.astype(np.float32)
    is_float = target.depth != "8"
    if is_float and pixels.has_alpha and not target.form.is_associated:
        # Blender divides floats by alpha, where that is not 0.
        alpha = pixels.stored[..., 3:]
        stored[..., :3] = pixels.stored[..., :3] * np.where(alpha == 0, 1, alpha)
    with Temporary() as now:
        image = bpy.data.images.new("Picture", width, height, alpha=True, float_buffer=is_float)
        colors.make_raw(now.made(image))
        image.pixels.foreach_set(stored.ravel())
        if picture.header.resolution is not None:
            image.resolution = picture.header.resolution
        settings = scene.render.image_settings
        settings.color_mode = channels
        if colors.kind_of(pixels.space) is Kind.DATA:
            settings.linear_colorspace_settings.name = image.colorspace_settings.name
        else:
            settings.linear_colorspace_settings.name = colors.scene_linear()
        image.save_render(str(target.path), scene=scene, quality=target.quality or 0)


def _add_tags(
    picture: Picture, pixels: Pixels, target: Target, is_converted: bool, profile: bytes | None
) -> None:
    """Add what Blender does not write, and what it says of colors that it did not know."""
    if profile is not None:
        picture_tags.add_profile(target.path, profile)
    resolution = picture.header.resolution
    if target.form.name == "JPEG" and resolution is not None:
        picture_tags.set_jpeg_resolution(target.path, resolution)
    elif resolution is not None and not target.form.holds_resolution:
        dpi = resolution[0] * METRES_PER_INCH
        if round(dpi) not in USUAL_DPI:
            note(f"its resolution of {dpi:.0f} dpi is not kept")
    if target.form.name == "OPEN_EXR":
        meaning = picture.header.color_attributes
        if meaning and not is_converted:
            picture_tags.set_exr_meaning(target.path, meaning)
        elif pixels.space != colors.scene_linear() and colors.kind_of(pixels.space) != Kind.DATA:
            picture_tags.set_exr_meaning(target.path, {})


def _check(pixels: Pixels, target: Target) -> None:
    """Read the file again; raises RuntimeError if it holds anything else than it should."""
    check(target.path)
    with Temporary() as now:
        image = now.made(bpy.data.images.load(str(target.path)))
        assumed = image.colorspace_settings.name
        colors.make_raw(image)
        height, width, _ = pixels.stored.shape
        if tuple(image.size) != (width, height):
            raise RuntimeError("Blender cannot read it again")
        found = stored_in(image)
    if assumed != pixels.space:
        note(
            f"its colors are in {pixels.space}, but Blender will open it as {assumed}: choose "
            "the first as its Color Space"
        )
    if target.form.name == "JPEG" or (target.form.name == "WEBP" and target.quality != 100):
        return  # its values are not those that it was given
    wanted = pixels.stored
    if target.form.loses_hidden and pixels.has_alpha:
        shown = wanted[..., 3] > OF_STEP / STEPS["8"]
        found, wanted = found[shown], wanted[shown]
    if target.is_integer:
        allowed = np.array(OF_STEP / STEPS[target.depth])
    else:
        rounding = OF_HALF if target.depth == "half" else OF_FLOAT
        allowed = rounding * np.maximum(np.abs(wanted), np.finfo(np.float16).tiny)
    with np.errstate(invalid="ignore"):  # what is not finite is no number of steps away
        error = np.abs(found.astype(np.float64) - wanted) / allowed
    if (error > 1).any():
        raise RuntimeError(f"values came out {np.nanmax(error):.3g} times as far off as they may")


@contextmanager
def _scene(target: Target) -> Iterator[bpy.types.Scene]:
    """A scene whose settings have Blender write values as they are."""
    with Temporary() as now:
        scene = now.made(bpy.data.scenes.new("Picture"))
        scene.render.dither_intensity = 0
        settings = scene.render.image_settings
        settings.file_format = target.form.name
        if target.form.name != "TIFF":
            settings.color_depth = {"half": "16", "float": "32"}.get(target.depth, target.depth)
        settings.color_management = "OVERRIDE"
        try:
            settings.view_settings.view_transform = "Raw"
        except TypeError as error:
            raise Refusal("the color management of this Blender has no view Raw") from error
        yield scene


def _holds_alpha(scene: bpy.types.Scene) -> bool:
    """Whether this Blender writes alpha in the scene's format; some write none in .bmp."""
    try:
        scene.render.image_settings.color_mode = "RGBA"
    except TypeError:
        return False
    return True
