"""The verb that filters images: pictures in, pictures out."""

import argparse
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import bpy
from spectral_tv.bands.gain_arguments import add_gains, band_values, complaint_of_gains
from spectral_tv.bands.gains import too_few_steps
from spectral_tv.command_line.command import Command
from spectral_tv.command_line.places import (
    add_places,
    add_report,
    complaint_of_clashes,
    complaint_of_places,
    ensure_file,
    is_folder,
    target_of,
)
from spectral_tv.command_line.progress import progress, say
from spectral_tv.command_line.report import Entry
from spectral_tv.files.room import with_room
from spectral_tv.files.whole import ensure_writable
from spectral_tv.options.arguments import add_arguments as add_options
from spectral_tv.options.arguments import read, whole

from ..command_line.writing import written_by_blender
from . import colors
from .bands import prepare
from .formats import BY_SUFFIX, DEPTHS, FORMATS
from .reading import read_picture
from .saving import save_picture
from .settings import Settings

# Formats and their depths, for the help.
WRITES = ", ".join(f"{suffix} ({' '.join(form.depths)})" for suffix, form in BY_SUFFIX.items())
# What a pixel takes at most, and a picture beside its pixels, bytes.
PIXEL, REST = 16, 1 << 20


class Filter(Command):
    """Splits pictures into bands, and filters them."""

    name = "image"
    options = Settings
    summary = "filter pictures by their bands"
    description = """\
Split pictures into bands by spectral total variation, filter them, and write them.

Works on the values of the file: encoded for displays in most formats, scene-linear in .exr. Those
of transparent pixels mean nothing and take no part. What is written has the depth, the channels and
the color space of the input, as far as its format has them; only .exr gets scene-linear colors, and
8 and 16 bits get sRGB where the input is linear floats."""
    examples = """\
  {program} image photo.jpg -o flat.png --gain 1=0 --gain 2=0
  {program} image *.png -o results --luminance --curve 0:0,0.5:1,1:2
  {program} image height.tif -o smooth.exr --colorspace Non-Color --gain 1=0"""

    @staticmethod
    def formats() -> str:
        """Lines that tell what it writes."""
        return f"writes: {WRITES}"

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what it takes."""
        add_places(parser, "a picture that Blender reads", "the picture", "png", is_required=True)
        add = parser.add_argument
        add(
            "--depth",
            choices=DEPTHS,
            help="8 or 16 bits, or floats of 16 (half) or 32 bits; as the input if not given, or "
            "what is next to it",
        )
        add(
            "--colorspace",
            metavar="NAME",
            help="the color space that the values of the inputs are in, such as Non-Color or "
            "'Linear Rec.709'; what Blender assumes if not given",
        )
        qualities = ", ".join(
            f"{form.quality} in {form.suffixes[0]}" for form in FORMATS if form.quality is not None
        )
        add(
            "--quality",
            metavar="PERCENT",
            type=whole(1, 100),
            help=f"of formats that lose some; default {qualities}, where 100 loses nothing",
        )
        add("--luminance", action="store_true", help="split the brightness alone")
        add_options(parser, Settings)
        add_gains(parser)
        add_report(parser)

    def complaint(self) -> str | None:
        """What is wrong with the arguments together; None if nothing is."""
        choices = self.choices
        reason = complaint_of_places(choices, [("-o", choices.output)])
        reason = reason or _complaint_of_targets(choices) or _complaint_of_space(choices)
        reason = reason or too_few_steps(choices.bands, choices.steps)
        return reason or complaint_of_gains(choices, choices.bands)

    @cached_property
    def asked(self) -> Settings:
        """The options that were chosen, and the filter."""
        choices = self.choices
        gains = [1 + value for value in band_values(choices, choices.bands)]
        return replace(
            read(choices, Settings),
            channels="LUMINANCE" if choices.luminance else "ALL",
            preset="GAINS",
            gains=" ".join(map(repr, gains)),
        )

    def treat_file(self, source: Path, entry: Entry) -> None:
        choices = self.choices
        target = target_of(choices, source)
        ensure_file(source)
        ensure_writable(target.absolute())
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        picture = read_picture(source, choices.colorspace)
        entry.read = picture.told()
        prepared = prepare(picture.pixels, self.asked)
        with progress(str(source)) as show:
            flow = prepared.request.run(show)
        result = replace(picture, pixels=prepared.filtered(flow))
        entry.done = {"verb": self.name, "settings": self.told()}
        # A disk that gets full would end the process when Blender reads what it has written.
        most = REST + PIXEL * picture.pixels.stored[..., 0].size
        with written_by_blender(target) as path, with_room(path, most) as place:
            save_picture(result, place, choices.depth, choices.quality)
        entry.output = str(target)
        say(f"{source}: wrote {target}")


def _complaint_of_targets(choices: argparse.Namespace) -> str | None:
    targets = [target_of(choices, source) for source in choices.inputs]
    for target in targets:
        form = BY_SUFFIX.get(target.suffix.lower())
        if form is None:
            hint = "; choose another with --format" if is_folder(choices.output) else ""
            return f"pictures are written as {' '.join(BY_SUFFIX)}, not {target}{hint}"
        if choices.depth is not None and choices.depth not in form.depths:
            depths = " or ".join(form.depths)
            return f"the depth of a {target.suffix} is {depths}, not {choices.depth}: {target}"
    return complaint_of_clashes(choices, targets, is_replaced=False)


def _complaint_of_space(choices: argparse.Namespace) -> str | None:
    """Complain of an unknown color space; a known one gets the name that Blender has for it."""
    if choices.colorspace is None:
        return None
    known = {name.casefold(): name for name in colors.names()}
    found = known.get(choices.colorspace.casefold())
    if found is None:
        names = ", ".join(known.values())
        return f"there is no color space {choices.colorspace!r}; there are: {names}"
    choices.colorspace = found
    return None
