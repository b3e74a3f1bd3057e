"""A task: a file, and what to do with it."""

from pathlib import Path
from typing import Any

from spectral_tv.dataclass import dataclass


@dataclass(frozen=True)
class Limits:
    """What a task may take: seconds, bytes of memory and threads; None for any."""

    seconds: float | None = None
    memory: int | None = None
    threads: int | None = None


@dataclass(frozen=True)
class Task:
    """A file, and what to do with it.

    ``verb`` and ``choices`` are of the command line, ``folders`` those that it writes to. ``child``
    starts the program that does it; None stands for this package's, on the machine that the task
    comes to. Names begin at ``place``, or where the program does.
    """

    source: Path
    verb: str
    choices: dict[str, Any]
    folders: tuple[Path, ...]
    limits: Limits = Limits()
    child: tuple[str, ...] | None = None
    place: Path | None = None
