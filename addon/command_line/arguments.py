"""Reading and checking the arguments of the command line."""

import argparse
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..gains import curve_values
from ..settings import METHODS, Settings
from ..shape_keys import SLIDER_RANGE
from . import files

# A key's value is the gain less one.
LEAST_GAIN, MOST_GAIN = SLIDER_RANGE[0] + 1, SLIDER_RANGE[1] + 1

DESCRIPTION = """\
Split the meshes of files into bands of detail, filter them, and write them.

A .blend keeps the bands as shape keys, set to the gains; .glb, .gltf and .fbx carry them too.
All other formats hold the filtered shape."""
EXAMPLES = """\
examples:
  blender --command spectral_tv decompose dragon.ply -o dragon.blend --bands 5
  blender --command spectral_tv decompose scan.obj -o smooth.obj --gain 1=0 --gain 2=0.5
  blender --command spectral_tv decompose *.ply -o results --curve 0:0,0.5:1,1:2 --render results

exit codes: 0 if everything succeeded, 1 if an input failed, 2 for wrong arguments"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of ``decompose``."""
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.description = DESCRIPTION
    reads, writes = " ".join(files.importable()), " ".join(files.exportable())
    parser.epilog = f"reads:  {reads}\nwrites: {writes}\n\n{EXAMPLES}"
    add = parser.add_argument
    add("inputs", metavar="INPUT", nargs="+", type=_path, help="a file that Blender imports")
    add("-o", "--output", type=_path, help="the file to write, or a folder that exists")
    add(
        "--format",
        metavar="SUFFIX",
        type=lambda text: "." + text.lower().lstrip("."),
        help="what to write into the folder, such as glb; as the input if not given",
    )
    add(
        "--render",
        metavar="PICTURE",
        type=_path,
        help="picture the filtered objects: a .png, or a folder that exists",
    )
    add(
        "--object",
        metavar="NAME",
        dest="objects",
        action="append",
        help="decompose this object instead of every mesh with faces; repeatable. Formats other "
        "than .blend then hold nothing else",
    )
    methods = ", ".join(f"{name.lower()}: {label}" for name, label, _ in METHODS)
    add(
        "--method",
        type=str.lower,
        choices=[name.lower() for name, _, _ in METHODS],
        default="m1",
        help=f"what the bands split off ({methods}); default m1",
    )
    add("--bands", metavar="N", type=_whole(1, 32), default=5, help="1 to 32; default 5")
    add("--steps", metavar="N", type=_whole(2, 1000), default=32, help="of the flow; default 32")
    add("--finest", metavar="PERCENT", type=_percent, default=0.0, help="the finest detail told "
        "apart, in percent of the object's size")  # fmt: skip
    add("--largest", metavar="PERCENT", type=_percent, default=0.0, help="the largest features "
        "that bands hold, in percent of the object's size")  # fmt: skip
    add(
        "--base",
        metavar="{flow,flat,KEY}",
        help="from what m3 measures detail: the object smoothed (default), the object flattened "
        "along its Z axis, or a shape key by its name",
    )
    add("--base-amount", metavar="PERCENT", type=_percent, help="size of the features that vanish "
        "from the smoothed base, in percent of the object's size")  # fmt: skip
    add("--vertex-group", metavar="NAME", default="", help="limits where the bands have an effect")
    add(
        "--gain",
        metavar="BAND=GAIN",
        dest="gains",
        type=_gain,
        action="append",
        default=[],
        help="0 removes a band, 1 keeps it, 2 doubles it; bands count from 1, the finest, or all. "
        "Repeatable, later ones win",
    )
    add(
        "--curve",
        metavar="X:Y,X:Y,…",
        type=_curve,
        help="gains as a curve: X from 0, the finest, to 1, the largest; Y the gain. --gain wins",
    )


def settings(choices: argparse.Namespace) -> Settings:
    """The settings that the arguments ask for."""
    base = choices.base or "flow"
    is_key = base not in ("flow", "flat")
    return Settings(
        method=choices.method.upper(),
        bands=choices.bands,
        steps=choices.steps,
        finest=choices.finest,
        largest=choices.largest,
        base="KEY" if is_key else base.upper(),
        base_amount=choices.base_amount or 0.0,
        base_key=base if is_key else "",
        vertex_group=choices.vertex_group,
    )


def band_values(choices: argparse.Namespace) -> list[float]:
    """The value of every band's shape key."""
    values = [0.0] * choices.bands
    if choices.curve is not None:
        positions, heights = zip(*choices.curve, strict=True)
        values = curve_values(lambda x: float(np.interp(x, positions, heights)), choices.bands)
    for band, gain in choices.gains:
        for index in range(choices.bands) if band is None else (band - 1,):
            values[index] = gain - 1
    return values


def complaint(choices: argparse.Namespace) -> str | None:
    """What is wrong with the arguments together; None if nothing is."""
    if choices.output is None and choices.render is None:
        return "say where the result goes: -o, --render or both"
    if choices.bands >= choices.steps:
        return f"{choices.bands} bands need more than {choices.steps} steps"
    if 0 < choices.largest <= choices.finest:
        return "--largest has to be larger than --finest"
    if choices.method != "m3" and (choices.base or choices.base_amount):
        return "--base and --base-amount go with --method m3"
    if choices.base_amount and choices.base not in (None, "flow"):
        return "--base-amount goes with the smoothed base, --base flow"
    for band, _ in choices.gains:
        if band is not None and band > choices.bands:
            return f"there is no band {band} among {choices.bands}"
    if choices.format is not None and not (choices.output and choices.output.is_dir()):
        return "--format goes with -o and a folder that exists"
    for name, place in (("-o", choices.output), ("--render", choices.render)):
        if place is None or place.is_dir():
            continue
        if len(choices.inputs) > 1:
            return f"several inputs need a folder that exists: {name} {place}"
        if not place.parent.is_dir():
            return f"there is no folder {place.parent}"
    return _complaint_of_targets(choices)


def outputs(choices: argparse.Namespace, source: Path) -> tuple[Path | None, Path | None]:
    """The file and the picture to write for an input."""
    file, picture = choices.output, choices.render
    if file is not None and file.is_dir():
        file = file / f"{source.stem}{choices.format or source.suffix}"
    if picture is not None and picture.is_dir():
        picture = picture / f"{source.stem}.png"
    return file, picture


def _complaint_of_targets(choices: argparse.Namespace) -> str | None:
    writable = files.exportable()
    inputs = {source.resolve() for source in choices.inputs}
    taken: set[Path] = set()
    for source in choices.inputs:
        file, picture = outputs(choices, source)
        # An input without a known suffix has its own message.
        if file is not None and file.suffix.lower() not in writable:
            if choices.output.is_dir() and choices.format is None:
                file = None
            else:
                return f"this Blender writes no {file.suffix or 'files without suffix'}: {file}"
        if picture is not None and picture.suffix.lower() != ".png":
            return f"the picture has to be a .png: {picture}"
        for target in filter(None, (file, picture)):
            place = target.resolve()
            if place in taken:
                return f"two inputs would become {target}"
            if place in inputs and target != choices.output:
                return f"{target} is an input; name it with -o, or choose another folder"
            taken.add(place)
    return None


def _path(text: str) -> Path:
    return Path(text).expanduser()


def _whole(least: int, most: int) -> Callable[[str], int]:
    def read(text: str) -> int:
        if not (text.isdecimal() and least <= int(text) <= most):
            raise argparse.ArgumentTypeError(f"{text!r} is not a number from {least} to {most}")
        return int(text)

    return read


def _number(text: str, least: float, most: float) -> float:
    try:
        number = float(text)
    except ValueError:
        number = np.nan
    if not least <= number <= most:
        message = f"{text!r} is not a number from {least:g} to {most:g}"
        raise argparse.ArgumentTypeError(message)
    return number


def _percent(text: str) -> float:
    return _number(text.removesuffix("%"), 0.01, 100) / 100


def _gain(text: str) -> tuple[int | None, float]:
    band, _, gain = text.partition("=")
    if band != "all" and not (band.isdecimal() and int(band) > 0):
        raise argparse.ArgumentTypeError(f"{text!r} is not BAND=GAIN, such as 1=0 or all=2")
    return (None if band == "all" else int(band)), _number(gain, LEAST_GAIN, MOST_GAIN)


def _curve(text: str) -> Sequence[tuple[float, float]]:
    points = []
    for point in text.split(","):
        x, _, y = point.partition(":")
        points.append((_number(x, 0, 1), _number(y, LEAST_GAIN, MOST_GAIN)))
    if any(a[0] >= b[0] for a, b in pairwise(points)):
        raise argparse.ArgumentTypeError(f"the X of {text!r} have to increase")
    return points
