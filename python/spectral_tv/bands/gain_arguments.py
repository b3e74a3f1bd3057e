"""Gains on the command line: of single bands, and as a curve."""

import argparse
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from spectral_tv.bands.gains import VALUES, curve_values
from spectral_tv.options.arguments import number

# A value is the gain less one.
LEAST_GAIN, MOST_GAIN = VALUES[0] + 1, VALUES[1] + 1


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


def complaint_of_gains(choices: argparse.Namespace, bands: int) -> str | None:
    """What is wrong with gains of so many bands; None if nothing is."""
    for band, _ in choices.gains:
        if band is not None and band > bands:
            return f"there is no band {band} among {bands}"
    return None


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


def _gain(text: str) -> tuple[int | None, float]:
    band, _, gain = text.partition("=")
    if band != "all" and not (band.isdecimal() and int(band) > 0):
        raise argparse.ArgumentTypeError(f"{text!r} is not BAND=GAIN, such as 1=0 or all=2")
    return (None if band == "all" else int(band)), number(gain, LEAST_GAIN, MOST_GAIN)


def _curve(text: str) -> Sequence[tuple[float, float]]:
    points = []
    for point in text.split(","):
        x, _, y = point.partition(":")
        points.append((number(x, 0, 1), number(y, LEAST_GAIN, MOST_GAIN)))
    if any(a[0] >= b[0] for a, b in pairwise(points)):
        raise argparse.ArgumentTypeError(f"the X of {text!r} have to increase")
    return points


def filter_of(choices: argparse.Namespace, count: int) -> dict[str, Any]:
    """The options of a FilterSettings that stand for the gains of so many bands."""
    gains = [1 + value for value in band_values(choices, count)]
    return {"preset": "GAINS", "gains": " ".join(map(repr, gains))}
