"""The verb that filters images: pictures in, pictures out."""

import argparse
from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import ClassVar

from spectral_tv.bands.gain_arguments import add_gains, complaint_of_gains, filter_of
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
from spectral_tv.files.whole import ensure_writable
from spectral_tv.images.bands import prepare
from spectral_tv.images.formats import DEPTHS, Format
from spectral_tv.images.picture import Picture
from spectral_tv.images.settings import Settings
from spectral_tv.options.arguments import add_arguments as add_options
from spectral_tv.options.arguments import read, whole


class ImageVerb(Command):
    """Splits pictures into bands, and filters them."""

    name = "image"
    options = Settings
    summary = "filter pictures by their bands"
    # The formats that are written, by suffix; what is read; and what color space is assumed.
    forms: ClassVar[Mapping[str, Format]]
    source: ClassVar[str]
    assumed: ClassVar[str]

    @classmethod
    def formats(cls) -> str:
        """Lines that tell what it writes."""
        told = (f"{suffix} ({' '.join(form.depths)})" for suffix, form in cls.forms.items())
        return f"writes: {', '.join(told)}"

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what it takes."""
        add_places(parser, cls.source, "the picture", "png", is_required=True)
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
            f"'Linear Rec.709'; {cls.assumed} if not given",
        )
        qualities = ", ".join(
            f"{form.quality} in {form.suffixes[0]}"
            for form in dict.fromkeys(cls.forms.values())
            if form.quality is not None
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

    @classmethod
    def reads(cls) -> Collection[str]:
        """Of files in folders, those that end so are taken."""
        return cls.forms

    def targets(self, source: Path) -> list[Path]:
        """The picture that is written for an input."""
        return [target_of(self.choices, source)]

    def complaint(self) -> str | None:
        """What is wrong with the arguments together; None if nothing is."""
        choices = self.choices
        reason = complaint_of_places(choices, [("-o", choices.output)])
        reason = reason or self._complaint_of_targets() or self.complaint_of_space()
        reason = reason or too_few_steps(choices.bands, choices.steps)
        return reason or complaint_of_gains(choices, choices.bands)

    def complaint_of_space(self) -> str | None:
        """Complain of an unknown color space; a known one gets its proper name."""
        choices = self.choices
        if choices.colorspace is None:
            return None
        known = {name.casefold(): name for name in self.spaces()}
        found = known.get(choices.colorspace.casefold())
        if found is None:
            names = ", ".join(known.values())
            return f"there is no color space {choices.colorspace!r}; there are: {names}"
        choices.colorspace = found
        return None

    def spaces(self) -> list[str]:
        """The color spaces that inputs can be in."""
        raise NotImplementedError

    @cached_property
    def asked(self) -> Settings:
        """The options that were chosen, and the filter."""
        choices = self.choices
        found: Settings = read(choices, Settings)
        channels = "LUMINANCE" if choices.luminance else "ALL"
        return replace(found, channels=channels, **filter_of(choices, choices.bands))

    def treat_file(self, source: Path, entry: Entry) -> None:
        """Read, filter and write a picture, and say so in ``entry``."""
        target = target_of(self.choices, source)
        ensure_file(source)
        ensure_writable(target.absolute())
        picture = self.read(source)
        entry.read = picture.told()
        prepared = prepare(picture.pixels, self.asked)
        with progress(str(source)) as show:
            flow = prepared.request.run(show)
        entry.done = {"verb": self.name, "settings": self.told()}
        self.save(replace(picture, pixels=prepared.filtered(flow)), target)
        entry.output = str(target)
        say(f"{source}: wrote {target}")

    def read(self, source: Path) -> Picture:
        """Read a picture; raises Refusal or OSError."""
        raise NotImplementedError

    def save(self, picture: Picture, target: Path) -> None:
        """Save a picture; raises Refusal, RuntimeError or OSError."""
        raise NotImplementedError

    def _complaint_of_targets(self) -> str | None:
        choices, forms = self.choices, self.forms
        targets = [target_of(choices, source) for source in choices.inputs]
        for target in targets:
            form = forms.get(target.suffix.lower())
            if form is None:
                hint = "; choose another with --format" if is_folder(choices.output) else ""
                return f"pictures are written as {' '.join(forms)}, not {target}{hint}"
            if choices.depth is not None and choices.depth not in form.depths:
                depths = " or ".join(form.depths)
                return f"the depth of a {target.suffix} is {depths}, not {choices.depth}: {target}"
        return complaint_of_clashes(choices, targets, is_replaced=False)
