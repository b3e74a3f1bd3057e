"""The parts of shapes that are held and moved, on the command line."""

import argparse

import numpy as np

from spectral_tv.deformation.settings import Settings, algorithm_for
from spectral_tv.options.declaring import options_of


def add_parts(parser: argparse.ArgumentParser, where: str) -> None:
    """Declare what is held and moved; ``where`` ends the sentence about what offsets are in."""
    add = parser.add_argument
    add(
        "--pin",
        metavar="WHERE",
        dest="pins",
        action="append",
        default=[],
        help="hold this part where it is; repeatable",
    )
    add(
        "--move",
        metavar="WHERE:DX,DY,DZ",
        dest="moves",
        type=_move,
        action="append",
        default=[],
        help=f"move this part by an offset in {where}",
    )
    add(
        "--unturned",
        action="store_true",
        help="what --move moves keeps the way it faces; with --algorithm pose. Otherwise it is "
        "free to turn",
    )


def complaint_of_parts(choices: argparse.Namespace) -> str | None:
    """What is wrong with them together; None if nothing is."""
    if choices.pins and not choices.moves:
        return "--pin alone moves nothing; add --move"
    if choices.unturned and not choices.moves:
        return "--unturned goes with --move"
    return None


def imply_algorithm(choices: argparse.Namespace) -> None:
    """Have an option that is for one algorithm alone ask for it, if none was chosen."""
    if choices.algorithm is None:
        given = [name for name in options_of(Settings) if getattr(choices, name) is not None]
        implied = algorithm_for(given)
        choices.algorithm = None if implied is None else implied.lower()


def _move(text: str) -> tuple[str, tuple[float, ...]]:
    where, _, numbers = text.rpartition(":")  # names may have colons
    try:
        offset = tuple(float(number) for number in numbers.split(","))
    except ValueError:
        offset = ()
    if not where.strip() or len(offset) != 3 or not np.isfinite(offset).all():
        message = f"{text!r} is not WHERE:DX,DY,DZ, such as 'z>90%:0,0,0.5'"
        raise argparse.ArgumentTypeError(message)
    return where, offset
