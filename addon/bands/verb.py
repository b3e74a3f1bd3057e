"""``decompose``: files in, bands or filtered shapes out."""

import argparse
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import bpy
import numpy as np
import spectral_tv

from ..command_line.arguments import number, percent, whole
from ..command_line.formats import BLEND, FORMATS
from ..command_line.frames import all_or_frames, frames_of, treat_frames
from ..command_line.load import freeze
from ..command_line.progress import progress
from ..command_line.verb import Job, Task, Verb
from ..scene import applied
from ..scene.notes import note
from ..scene.shape_keys import SLIDER_RANGE
from .bands import add_bands, prepare_together, set_values
from .filtering import KEEPS_ALL
from .gains import curve_values
from .settings import COMPARISONS, METHODS, METRICS, SHAPES, WELD, WITH_BASE, Settings
from .shapes import groups

# A key's value is the gain less one.
LEAST_GAIN, MOST_GAIN = SLIDER_RANGE[0] + 1, SLIDER_RANGE[1] + 1


class Decompose(Verb):
    """Splits objects into bands, and filters them."""

    name = "decompose"
    summary = "split meshes into bands of detail"
    result = "filtered"
    description = """\
Split the meshes of files into bands of detail, filter them, and write them.

A .blend keeps the bands as shape keys, set to the gains; .glb, .gltf and .fbx carry them too.
All other formats hold the filtered shape."""
    examples = """\
  blender --command spectral_tv decompose dragon.ply -o dragon.blend --bands 5
  blender --command spectral_tv decompose scan.obj -o smooth.obj --gain 1=0 --gain 2=0.5
  blender --command spectral_tv decompose *.ply -o results --curve 0:0,0.5:1,1:2 --render results"""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare what is split off, and how it is filtered."""
        add = parser.add_argument
        methods, comparisons = (
            ", ".join(f"{name.lower()}: {label}" for name, label, _ in items)
            for items in (METHODS, COMPARISONS)
        )
        add(
            "--method",
            type=str.lower,
            choices=[name.lower() for name, _, _ in METHODS + COMPARISONS],
            default="m1",
            help=f"what the bands split off ({methods}; for comparison {comparisons}); default m1",
        )
        add("--bands", metavar="N", type=whole(1, 32), default=5, help="1 to 32; default 5")
        add("--steps", metavar="N", type=whole(2, 1000), default=32, help="of the flow; default 32")
        add(
            "--accuracy",
            metavar="E",
            type=_accuracy,
            default=0.0,
            help="relative error of the bands, such as 0.05: as many steps are taken as it needs, "
            "and --steps is of no account",
        )
        add(
            "--eigenpairs",
            metavar="N",
            type=whole(2, 10000),
            default=300,
            help="number of eigenfunctions of lb; default 300",
        )
        add(
            "--finest",
            metavar="PERCENT",
            type=_share,
            default=0.0,
            help="the finest detail told apart, in percent of the object's size",
        )
        add(
            "--largest",
            metavar="PERCENT",
            type=_share,
            default=0.0,
            help="the largest features that bands hold, in percent of the object's size",
        )
        add(
            "--base",
            metavar="{flow,flat,KEY}",
            help="from what m3 and displacement measure detail: the object smoothed (default), the "
            "object flattened along its Z axis, or a shape key by its name",
        )
        add(
            "--metric",
            type=str.lower,
            choices=[name.lower() for name, _, _ in METRICS],
            help="along what m3 measures distances: the object itself (default), or the base",
        )
        add(
            "--base-amount",
            metavar="PERCENT",
            type=_share,
            help="size of the features that vanish from the smoothed base, in percent of the "
            "object's size",
        )
        add(
            "--vertex-group",
            metavar="NAME",
            default="",
            help="limits where the bands have an effect",
        )
        add(
            "--shape",
            type=str.lower,
            choices=[name.lower() for name, _, _ in SHAPES],
            default="shown",
            help="which shape is split: as shape keys show it (default), without them, or as "
            "modifiers show it, which are applied",
        )
        add(
            "--weld",
            metavar="PERCENT",
            type=lambda text: percent(text, 0),
            default=WELD,
            help="corners of open edges this near to one another are one, in percent of the "
            f"object's size; default {WELD:g}",
        )
        add(
            "--leave-out",
            action="store_true",
            help="leave faces out whose vertices have no finite place; otherwise they are refused",
        )
        add(
            "--apart",
            action="store_true",
            help="split every object by itself, even where the open edges of several meet",
        )
        add(
            "--frames",
            metavar="START-END[:STEP]",
            type=all_or_frames,
            help="split and filter what is seen in each of these frames, or in all. The file plays "
            "them; of a format that cannot, there is a file for each",
        )
        add_gains(parser)

    def complaint_of_own(self, choices: argparse.Namespace) -> str | None:
        """What is wrong with them together."""
        asked = settings(choices)
        if choices.accuracy and not asked.is_adaptive:
            return f"--accuracy is not for --method {choices.method}, which takes no time steps"
        if 0 < choices.largest <= choices.finest:
            return "--largest has to be larger than --finest"
        if choices.method.upper() not in WITH_BASE and (choices.base or choices.base_amount):
            return "--base and --base-amount go with --method m3 or displacement"
        if choices.method != "m3" and choices.metric:
            return "--metric goes with --method m3"
        if choices.base_amount and choices.base not in (None, "flow"):
            return "--base-amount goes with the smoothed base, --base flow"
        return complaint_of_gains(choices, asked.band_count, asked.least_steps)

    def not_in_force(self, choices: argparse.Namespace) -> set[str]:
        """The settings that are of no account beside others; 0 is what suits the method."""
        asked = settings(choices)
        left = {name for name in ("accuracy", "finest", "largest") if not getattr(choices, name)}
        if choices.method != "lb":
            left.add("eigenpairs")
        if asked.is_adaptive or choices.method == "displacement":
            left.add("steps")
        if choices.method == "displacement":
            left.add("bands")
        return left

    def settings_of(self, choices: argparse.Namespace) -> dict[str, Any]:
        """The settings that were chosen, or are defaults, and count."""
        found, asked = super().settings_of(choices), settings(choices)
        if asked.method in WITH_BASE:
            found["base"] = choices.base or "flow"
        if asked.method == "M3":
            found["metric"] = asked.metric.lower()
        return found

    def treat_all(
        self, objects: list[bpy.types.Object], choices: argparse.Namespace, job: Job
    ) -> None:
        """Give objects their bands; over frames, have them play their filtered shapes."""
        if choices.frames is None:
            freeze(job.read, "; --frames all takes each as it is seen")
            self.treat_groups(objects, choices, job)
            return
        frames = frames_of(choices.frames, job.read)

        def treat(copies: list[bpy.types.Object], frame: int) -> None:
            self.treat_groups(copies, choices, job, f", frame {frame}")

        treat_frames(objects, frames, treat)

    def groups(
        self, objects: list[bpy.types.Object], choices: argparse.Namespace
    ) -> list[list[bpy.types.Object]]:
        """The objects, those together whose open edges meet."""
        if choices.apart:
            return super().groups(objects, choices)
        found = groups(objects, settings(choices))
        for group in found:
            if len(group) > 1:
                names = ", ".join(obj.name for obj in group)
                note(f"{names} are split as one, as their open edges meet; --apart splits each")
        return found

    def treat(
        self, objects: Sequence[bpy.types.Object], choices: argparse.Namespace, task: Task
    ) -> None:
        """Give objects their bands."""
        asked = settings(choices)
        if asked.shape == "APPLIED":
            for obj in objects:
                applied.apply(obj)
        values = band_values(choices, asked.band_count)
        is_filtered = bool(choices.gains) or choices.curve is not None
        if not any(values) and (is_filtered or not _holds_bands(task)):
            note(KEEPS_ALL)
        surfaces, arguments = prepare_together(objects, asked)
        with progress(task.label) as show:
            split = spectral_tv.decompose(surfaces[0].mesh, **arguments, progress=show)
        for obj, surface in zip(objects, surfaces, strict=True):
            add_bands(obj, asked, surface, arguments, split)
            set_values(obj, values)


def _holds_bands(task: Task) -> bool:
    """Whether bands can still be dialled in what is written."""
    if task.file is None:
        return False
    suffix = task.file.suffix.lower()
    return suffix == BLEND or FORMATS[suffix].keys


def add_gains(parser: argparse.ArgumentParser) -> None:
    """Declare the filter."""
    add = parser.add_argument
    add(
        "--gain",
        metavar="BAND=GAIN",
        dest="gains",
        type=_gain,
        action="append",
        default=[],
        help="0 removes a band, 1 keeps it, 2 doubles it; bands count from 1, the finest, or "
        "all. Repeatable, later ones win",
    )
    add(
        "--curve",
        metavar="X:Y,X:Y,…",
        type=_curve,
        help="gains as a curve: X from 0, the finest, to 1, the largest; Y the gain. --gain wins",
    )


def complaint_of_gains(choices: argparse.Namespace, bands: int, steps: int) -> str | None:
    """What is wrong with so many bands, the least number of steps and the gains together."""
    if bands >= steps:
        return f"{bands} bands need more than {steps} steps"
    for band, _ in choices.gains:
        if band is not None and band > bands:
            return f"there is no band {band} among {bands}"
    return None


def settings(choices: argparse.Namespace) -> Settings:
    """The settings that the arguments ask for."""
    base = choices.base or "flow"
    is_key = base not in ("flow", "flat")
    return Settings(
        method=choices.method.upper(),
        bands=choices.bands,
        steps=choices.steps,
        accuracy=choices.accuracy,
        finest=choices.finest,
        largest=choices.largest,
        eigenpairs=choices.eigenpairs,
        base="KEY" if is_key else base.upper(),
        base_amount=choices.base_amount or 0.0,
        base_key=base if is_key else "",
        metric=(choices.metric or "surface").upper(),
        vertex_group=choices.vertex_group,
        shape=choices.shape.upper(),
        weld=choices.weld,
        leaves_out=choices.leave_out,
    )


def band_values(choices: argparse.Namespace, count: int) -> list[float]:
    """The values of the shape keys of so many bands."""
    values = [0.0] * count
    if choices.curve is not None:
        positions, heights = zip(*choices.curve, strict=True)
        values = curve_values(lambda x: float(np.interp(x, positions, heights)), count)
    for band, gain in choices.gains:
        for index in range(count) if band is None else (band - 1,):
            values[index] = gain - 1
    return values


def _share(text: str) -> float:
    return percent(text) / 100


def _gain(text: str) -> tuple[int | None, float]:
    band, _, gain = text.partition("=")
    if band != "all" and not (band.isdecimal() and int(band) > 0):
        raise argparse.ArgumentTypeError(f"{text!r} is not BAND=GAIN, such as 1=0 or all=2")
    return (None if band == "all" else int(band)), number(gain, LEAST_GAIN, MOST_GAIN)


def _accuracy(text: str) -> float:
    return number(text, 0.005, 0.5)


def _curve(text: str) -> Sequence[tuple[float, float]]:
    points = []
    for point in text.split(","):
        x, _, y = point.partition(":")
        points.append((number(x, 0, 1), number(y, LEAST_GAIN, MOST_GAIN)))
    if any(a[0] >= b[0] for a, b in pairwise(points)):
        raise argparse.ArgumentTypeError(f"the X of {text!r} have to increase")
    return points
