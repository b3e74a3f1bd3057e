"""The arguments about many files."""

import argparse
import os
import re
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import spectral_tv
from spectral_tv.options.arguments import positive, whole

GIGABYTE = 10**9
# What they are kept as; none of them is a setting of a verb.
NAMES = (
    "files_from",
    "skip_existing",
    "shard",
    "jobs",
    "timeout",
    "memory",
    "scheduler",
)
LOCAL = "local"
# What a part of the free memory is left for: the system, and the parent. A fraction.
SPARE = 0.1


def add_batch(parser: argparse.ArgumentParser, *, is_together: bool) -> Any:
    """Declare which files are worked on, by whom, and within which limits; in a group, returned.

    Work that is one with all inputs is not shared out.
    """
    group = parser.add_argument_group("many files")
    add = group.add_argument
    add(
        "--files-from",
        metavar="LIST",
        type=Path,
        help="a text file with a name in each line, as more inputs; - for standard input",
    )
    if is_together:
        parser.set_defaults(skip_existing=False, shard=None, jobs=None, timeout=None, memory=None)
        return group
    add(
        "--skip-existing",
        action="store_true",
        help="pass over inputs whose outputs are there, whatever is in them",
    )
    add(
        "--shard",
        metavar="I/N",
        type=_shard,
        help="do the I-th of N shares of the inputs; each machine takes another one",
    )
    add(
        "--jobs",
        metavar="N",
        type=whole(1, 4096),
        help="work on so many files at a time, each in a process of its own; default 1",
    )
    add(
        "--timeout",
        metavar="SECONDS",
        type=positive,
        help="give up a file that takes longer",
    )
    add(
        "--memory",
        metavar="GB",
        type=positive,
        help="give up a file that takes more memory, in 1e9 bytes; default an equal share for each "
        "job of what is free (Linux)",
    )
    return group


def add_scheduler(group: Any) -> None:
    """Declare, in that group, who hands out the files on a cluster."""
    group.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="hand the files to the workers of a Dask scheduler, such as tcp://host:8786; "
        f"{LOCAL} starts workers on this machine, as many as its memory and cores allow",
    )


def complaint_of_batch(choices: argparse.Namespace) -> str | None:
    """What is wrong with these arguments together; None if nothing is."""
    asked = [name for name in ("jobs", "timeout", "memory") if getattr(choices, name) is not None]
    if asked and choices.child is None:
        return f"--{asked[0]} needs a program of its own for each file, which this is not"
    if choices.jobs is not None and getattr(choices, "scheduler", None) is not None:
        return "--jobs is for this machine; --scheduler has workers of its own"
    if getattr(choices, "scheduler", None) is not None and find_spec("distributed") is None:
        return '--scheduler needs Dask: pip install "spectral-tv[dask]"'
    return None


def cores() -> int:
    """How many cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on macOS and Windows
        return os.cpu_count() or 1


def free_memory() -> float | None:
    """The bytes that files may take together; None where the system does not tell."""
    free = spectral_tv.estimate(1, "m1").available
    return None if free is None else free * (1 - SPARE)


def _shard(text: str) -> tuple[int, int]:
    """A type of argument: I/N."""
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    number, count = (int(found[1]), int(found[2])) if found else (0, 0)
    if not 1 <= number <= count:
        raise argparse.ArgumentTypeError(f"{text!r} is not I/N with I from 1 to N, such as 2/8")
    return number, count
