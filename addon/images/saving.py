"""Saving pictures to files, with the values that they have."""

from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from spectral_tv.files import picture_tags
from spectral_tv.files.checks import check
from spectral_tv.images.encoding import (
    Target,
    channels_of,
    cut_off,
    ensure_same,
    note_resolution,
    of_alpha,
    profile_for,
    save_tiff,
)
from spectral_tv.images.formats import STEPS
from spectral_tv.images.picture import Picture
from spectral_tv.images.pixels import Pixels
from spectral_tv.notes import note

from ..scene.raw_scene import raw_scene
from ..scene.temporary import Temporary
from . import colors
from .colors import Kind
from .sources import stored_in


def save_picture(
    picture: Picture, path: Path, depth: str | None = None, quality: int | None = None
) -> None:
    """Save a picture in the format of the path's suffix, and make sure of what was written.

    Colors are converted where the format holds others: to scene-linear ones in OpenEXR, from
    linear ones of floats to sRGB in 8 and 16 bits. What cannot be kept is noted. Raises Refusal,
    Torn if the file was cut short, RuntimeError if Blender cannot write it, and OSError.
    """
    target = Target.of(path, picture, depth, quality)
    bits = {"half": "16", "float": "32"}.get(target.depth, target.depth)
    with raw_scene(target.form.name, None if target.form.name == "TIFF" else bits) as scene:
        pixels = of_alpha(_of_space(picture, target), target, _holds_alpha(scene))
        pixels = replace(pixels, stored=cut_off(pixels.stored, target))
        channels = channels_of(picture, pixels, target)
        is_converted = pixels.space != picture.pixels.space
        profile = profile_for(picture, target, channels, is_converted)
        if target.form.name == "TIFF":
            save_tiff(picture, pixels, target, channels, profile)
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
    note_resolution(picture, target)
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
    ensure_same(found, pixels, target)


def _holds_alpha(scene: bpy.types.Scene) -> bool:
    """Whether this Blender writes alpha in the scene's format; some write none in .bmp."""
    try:
        scene.render.image_settings.color_mode = "RGBA"
    except TypeError:
        return False
    return True
