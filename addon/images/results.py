"""Images that are made of another image, written over those of the last time."""

from __future__ import annotations

from collections.abc import Collection

import bpy
import spectral_tv
from spectral_tv.images.bands import Prepared
from spectral_tv.images.flows import Still
from spectral_tv.images.pixels import Pixels
from spectral_tv.later import np
from spectral_tv.notes import note

from ..scene.documents import images_of, remember_image

BAND, REST, FILTERED = "Band", "Rest", "Filtered"
# Bytes that the names of images may have in all versions.
LONGEST = 63
# How far values of 8 bits may be beyond black and white before something is lost.
HALF_STEP = 0.5 / 255
# Users of a result that nothing shows: its fake user, and the record.
OWN_USERS = 2


def source_of(image: bpy.types.Image) -> bpy.types.Image | None:
    """What an image was written of; None if it is none of ours, or the user cleared its source."""
    source = image.spectral_tv.source
    known = source is not None and any(
        (each.image, each.source) == (image, source) for records in _lists() for each in records
    )
    return source if known else None


def write(source: bpy.types.Image, prepared: Prepared, flow: spectral_tv.Flow | Still) -> list[str]:
    """Write what was chosen as images beside the source; returns their names."""
    settings = prepared.settings
    if settings.result == "BANDS":
        bands, rest = prepared.parts(flow)
        written = [
            _write_data(source, f"{BAND} {number}", band)
            for number, band in enumerate(bands, start=1)
        ]
        written.append(_write_data(source, REST, rest))
        _remove_surplus(source, {image.spectral_tv.label for image in written})
    elif settings.keep_rest:
        written = [_write_colors(source, FILTERED, prepared.filtered(flow))]
    else:
        written = [_write_data(source, FILTERED, prepared.filtered_bands(flow))]
    return [image.name for image in written]


def _write_data(source: bpy.types.Image, label: str, values: np.ndarray) -> bpy.types.Image:
    """Write values (H, W, C) that are no colors, as they may be negative."""
    image = _target(source, label, is_float=True)
    image.colorspace_settings.is_data = True
    image.alpha_mode = "PREMUL"
    stored = np.ones((*values.shape[:2], 4), dtype=np.float32)
    stored[..., :3] = values  # grey in all of them
    _fill(source, label, image, stored)
    return image


def _write_colors(source: bpy.types.Image, label: str, pixels: Pixels) -> bpy.types.Image:
    """Write a picture in the depth, the color space and the alpha of its source."""
    image = _target(source, label, source.is_float)
    image.colorspace_settings.name = pixels.space
    stored = pixels.stored
    if source.is_float:
        mode = "PREMUL" if pixels.is_associated else "STRAIGHT"
    else:
        mode = "STRAIGHT"  # as Blender holds 8 bits, whatever the file had
        beyond = np.abs(stored - stored.clip(0, 1)) > HALF_STEP
        cut = int(beyond[..., :3].any(axis=2).sum())
        if cut:
            note(f"{cut} pixels of {image.name!r} were cut off at black and white")
        stored = stored.clip(0, 1)
    image.alpha_mode = mode if pixels.has_alpha else source.alpha_mode
    _fill(source, label, image, stored)
    return image


def _fill(source: bpy.types.Image, label: str, image: bpy.types.Image, stored: np.ndarray) -> None:
    image.pixels.foreach_set(np.ascontiguousarray(stored, dtype=np.float32).ravel())
    image.pack()
    image.buffers_free()  # read anew, in its color space
    image.update()
    remember_image(_lists(), source, label, image)


def _target(source: bpy.types.Image, label: str, is_float: bool) -> bpy.types.Image:
    """The image to write into; one of another size or depth takes the place of the former."""
    former = images_of(_lists(), source, lambda each: each == label).get(label)
    wanted = (*source.size, is_float)
    if former is not None and (*former.size, former.is_float) == wanted:
        return former
    stem = source.name.encode()[: LONGEST - len(label) - 1].decode(errors="ignore")
    name = f"{stem} {label}" if former is None else former.name
    image = bpy.data.images.new(name, *source.size, alpha=True, float_buffer=is_float)
    image.use_fake_user = True  # what the user has not put anywhere yet is saved all the same
    if former is not None:
        former.user_remap(image)
        bpy.data.images.remove(former)
        image.name = name
    return image


def _remove_surplus(source: bpy.types.Image, labels: Collection[str]) -> None:
    """Remove bands of an earlier run that there are no more."""

    def is_surplus(label: str) -> bool:
        return label.startswith(BAND) and label not in labels

    for image in images_of(_lists(), source, is_surplus).values():
        if image.users > OWN_USERS:
            note(f"{image.name!r} is of an earlier run; it is used, and is kept")
        else:
            bpy.data.images.remove(image)


def _lists() -> list[bpy.types.bpy_prop_collection]:
    """What the scenes remember, the present one first; copies of scenes have copies."""
    others = [scene for scene in bpy.data.scenes if scene.library is None]
    scenes = dict.fromkeys((bpy.context.scene, *others))
    return [scene.spectral_tv_images.results for scene in scenes]
