"""The verb that filters images: pictures in, pictures out."""

import argparse
from pathlib import Path

import bpy
import spectral_tv

from ..images import pixels
from ..images.bands import Choice, prepare, write
from ..images.properties import METRICS
from ..scene.objects import Refusal
from .arguments import EXIT_CODES, add_report, positive, whole
from .decompose import add_gains, band_values, complaint_of_gains
from .progress import progress, say
from .report import Entry
from .verb import Command
from .writing import written_by_blender

# What Blender calls the formats it writes, by suffix.
FORMATS = {
    ".png": "PNG",
    ".jpg": "JPEG",
    ".jpeg": "JPEG",
    ".tif": "TIFF",
    ".tiff": "TIFF",
    ".webp": "WEBP",
    ".bmp": "BMP",
    ".tga": "TARGA",
    ".exr": "OPEN_EXR",
}


class Filter(Command):
    """Splits pictures into bands, and filters them."""

    name = "image"
    summary = "filter pictures by their bands"
    description = """\
Split pictures into bands by spectral total variation, filter them, and write them.

Works on the stored values: those of the file where it has 8 bits, linear ones otherwise."""
    examples = """\
  blender --command spectral_tv image photo.jpg -o flat.png --gain 1=0 --gain 2=0
  blender --command spectral_tv image *.png -o results --luminance --curve 0:0,0.5:1,1:2"""

    def add_parser(self, commands: argparse._SubParsersAction) -> None:
        """Add the verb to the command line."""
        parser = commands.add_parser(
            self.name,
            help=self.summary,
            description=self.description,
            epilog=f"writes: {' '.join(FORMATS)}\n\nexamples:\n{self.examples}\n\n{EXIT_CODES}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        add = parser.add_argument
        add("inputs", metavar="INPUT", nargs="+", type=Path, help="a picture that Blender reads")
        add(
            "-o",
            "--output",
            metavar="OUTPUT",
            type=Path,
            required=True,
            help="the picture to write, or a folder that exists",
        )
        metrics = [name.lower() for name, _, _ in METRICS]
        add("--metric", choices=metrics, default=metrics[0], help=f"default {metrics[0]}")
        add(
            "--height",
            metavar="PIXELS",
            type=positive,
            default=32.0,
            help="how high the relief of --metric surface is; default 32",
        )
        add("--luminance", action="store_true", help="split the brightness alone")
        add("--bands", metavar="N", type=whole(1, 32), default=5, help="1 to 32; default 5")
        add("--steps", metavar="N", type=whole(2, 1000), default=32, help="of the flow; default 32")
        size = "that stand out by the whole range of the values are gone where bands"
        add(
            "--finest",
            metavar="PIXELS",
            type=positive,
            default=0.1,
            help=f"so wide are spots {size} begin; default 0.1",
        )
        add(
            "--largest",
            metavar="PIXELS",
            type=positive,
            default=64.0,
            help=f"so wide are spots {size} end; default 64",
        )
        add("--exact", action="store_true", help="follow total variation exactly; slower")
        add_gains(parser)
        add_report(parser)
        parser.set_defaults(run=self._run, parser=parser)

    def complaint(self, choices: argparse.Namespace) -> str | None:
        """What is wrong with the arguments together; None if nothing is."""
        output = choices.output
        if len(choices.inputs) > 1 and not output.is_dir():
            return f"several inputs need a folder that exists: -o {output}"
        if not output.is_dir() and not output.parent.is_dir():
            return f"there is no folder {output.parent}"
        targets = [_target(choices, source) for source in choices.inputs]
        for target in targets:
            if target.suffix.lower() not in FORMATS:
                return f"pictures are written as {' '.join(FORMATS)}, not {target}"
        if len(set(targets)) < len(targets):
            return f"several inputs would be written to one file in {output}"
        if {target.resolve() for target in targets} & {i.resolve() for i in choices.inputs}:
            return "an input would be overwritten"
        return complaint_of_gains(choices, choices.bands, choices.steps)

    def _treat_file(self, choices: argparse.Namespace, source: Path, entry: Entry) -> None:
        if not source.is_file():
            raise Refusal("there is no such file")
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        image = bpy.data.images.load(str(source.absolute()))
        reason = pixels.refusal(image)
        if reason is not None:
            raise Refusal(reason)
        choice = _choice(choices)
        prepared = prepare(image, choice)
        with progress(str(source)) as show:
            flow = spectral_tv.decompose_image(**prepared.arguments, progress=show)
        (name,), cut = write(image, prepared, choice, flow)
        if cut:
            say(f"{source}: {cut} pixels cut off at black and white")
        target = _target(choices, source)
        result = bpy.data.images[name]
        result.file_format = FORMATS[target.suffix.lower()]
        with written_by_blender(target) as path:
            result.save(filepath=str(path))
        entry.output = str(target)
        say(f"{source}: wrote {target}")


def _target(choices: argparse.Namespace, source: Path) -> Path:
    return choices.output / source.name if choices.output.is_dir() else choices.output


def _choice(choices: argparse.Namespace) -> Choice:
    gains = [1 + value for value in band_values(choices, choices.bands)]
    return Choice(
        result="FILTER",
        metric=choices.metric.upper(),
        height=choices.height,
        channels="LUMINANCE" if choices.luminance else "ALL",
        exact=choices.exact,
        finest=choices.finest,
        largest=choices.largest,
        bands=choices.bands,
        steps=choices.steps,
        preset="GAINS",
        first=1,
        last=1,
        amount=0.0,
        gains=" ".join(map(repr, gains)),
        keep_rest=True,
    )
