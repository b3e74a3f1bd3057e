"""The arguments about frames."""

import argparse
import re

FRAMES = re.compile(r"(-?\d{1,6})-(-?\d{1,6})(?::(\d{1,6}))?")
ALL = "all"
METAVAR = "START-END[:STEP]"


def add_scales(parser: argparse.ArgumentParser) -> None:
    """Declare which frames fix what sizes of bands are relative to."""
    parser.add_argument(
        "--scales",
        choices=("first", "all"),
        help="what sizes of bands are relative to in all of --frames: the size of the first of "
        "them, or the median of all; default first",
    )


def complaint_of_scales(choices: argparse.Namespace) -> str | None:
    """What is wrong with it; None if nothing is."""
    if choices.scales is not None and choices.frames is None:
        return "--scales goes with --frames"
    return None


def frames_argument(text: str) -> list[int]:
    """A type of argument: START-END or START-END:STEP, the end included."""
    found = FRAMES.fullmatch(text)
    if found is None or int(found[3] or 1) == 0:
        message = f"{text!r} is not START-END or START-END:STEP, such as 1-40:2"
        raise argparse.ArgumentTypeError(message)
    start, end, step = int(found[1]), int(found[2]), int(found[3] or 1)
    if end < start:
        raise argparse.ArgumentTypeError(f"frame {end} comes before frame {start}")
    return every(start, end, step)


def all_or_frames(text: str) -> list[int] | str:
    """A type of argument: the same, or all."""
    return ALL if text.lower() == ALL else frames_argument(text)


def every(start: int, end: int, step: int) -> list[int]:
    """Every ``step``-th frame from the first on, and the last one."""
    return sorted({*range(start, end + 1, step), end})
