"""What a format makes of a picture; what it cannot keep is noted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spectral_tv.dataclass import dataclass
from spectral_tv.files.profiles import fits, name_of
from spectral_tv.files.tiff import Meaning, write_tiff
from spectral_tv.images.formats import BY_SUFFIX, DEPTHS, HALF_MAX, STEPS, Format
from spectral_tv.images.picture import Picture
from spectral_tv.images.pixels import Pixels
from spectral_tv.later import np
from spectral_tv.notes import a, note
from spectral_tv.refusal import Refusal

if TYPE_CHECKING:
    from numpy.typing import NDArray

# The color space of displays, as Blender names it.
SRGB = "sRGB"
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

    @classmethod
    def of(
        cls,
        path: Path,
        picture: Picture,
        depth: str | None,
        quality: int | None,
        forms: Mapping[str, Format] = BY_SUFFIX,
    ) -> Target:
        """That for a picture, in the format of the path's suffix; ``depth`` and ``quality`` are
        those that were asked for. Notes a depth that does not hold the picture's.
        """
        suffix, own = path.suffix.lower(), picture.header.depth
        form = forms[suffix]
        depth = depth or form.depth_for(own)
        if depth not in form.holding(own):
            note(f"written with {DEPTHS[depth]}; the input has {DEPTHS[own]}")
        return cls(path, suffix, form, depth, quality or form.quality)


def of_alpha(pixels: Pixels, target: Target, holds_alpha: bool) -> Pixels:
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


def cut_off(stored: NDArray[np.float32], target: Target) -> NDArray[Any]:
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
            "floats hold all, as in a .tif"
        )
    # Steps now, as Blender would round alpha after it has divided by it.
    return np.rint(cut * STEPS[target.depth]) * step if target.is_integer else cut


def channels_of(picture: Picture, pixels: Pixels, target: Target) -> str:
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


def profile_for(
    picture: Picture, target: Target, channels: str, is_converted: bool
) -> bytes | None:
    """The color profile to write; it is noted if what it says is lost."""
    profile = picture.header.profile
    if profile is None:
        return None
    if target.form.holds_profile and not is_converted and fits(profile, channels):
        return profile
    name = name_of(profile)
    if SRGB not in name or picture.pixels.space != SRGB:
        note(
            f"its color profile {name!r} is not kept; colors were taken for {picture.pixels.space}"
        )
    return None


def note_resolution(picture: Picture, target: Target) -> None:
    """Note a resolution that somebody chose, and that the format does not hold."""
    resolution = picture.header.resolution
    if resolution is not None and not target.form.holds_resolution:
        dpi = resolution[0] * METRES_PER_INCH
        if round(dpi) not in USUAL_DPI:
            note(f"its resolution of {dpi:.0f} dpi is not kept")


def integers(rows: NDArray[np.float32], depth: str) -> NDArray[np.generic]:
    """Values as a file holds them, in steps or in floats of 32 bits."""
    if depth not in STEPS:
        return rows.astype(np.float32)
    kind = np.uint8 if depth == "8" else np.uint16
    return np.rint(rows.astype(np.float64) * STEPS[depth]).astype(kind)


def rows_of(pixels: Pixels, channels: str) -> NDArray[np.float32]:
    """The channels of a picture, from the top down, (H, W, C)."""
    wanted = {"BW": [0], "BWA": [0, 3], "RGB": [0, 1, 2], "RGBA": [0, 1, 2, 3]}[channels]
    return pixels.stored[::-1][..., wanted]


def save_tiff(
    picture: Picture, pixels: Pixels, target: Target, channels: str, profile: bytes | None
) -> None:
    """Write a .tif; raises Refusal if it would be too large, and OSError."""
    rows = integers(rows_of(pixels, channels), target.depth)
    meaning = Meaning(pixels.has_alpha, pixels.is_associated, picture.header.resolution, profile)
    try:
        write_tiff(target.path, rows, meaning)
    except ValueError as error:
        raise Refusal(str(error)) from error


def ensure_same(found: NDArray[np.float32], pixels: Pixels, target: Target) -> None:
    """Raise RuntimeError if values that were read again (H, W, 4) are not those to be written."""
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
