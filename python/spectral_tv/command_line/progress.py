"""Messages and progress on standard error."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

STEP = 10


def say(message: str) -> None:
    """Write a line."""
    print(message, file=sys.stderr, flush=True)


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Yield a function that takes the fraction done, in [0, 1].

    On a terminal one line counts up; elsewhere there is a line for every tenth.
    """
    is_terminal = sys.stderr.isatty()
    last = -STEP

    def show(fraction: float) -> None:
        nonlocal last
        percent = int(100 * fraction)
        if percent < last + (1 if is_terminal else STEP):
            return
        last = percent if is_terminal else percent // STEP * STEP
        end = "" if is_terminal else "\n"
        start = "\r" if is_terminal else ""
        print(f"{start}{label}: {last} %", end=end, file=sys.stderr, flush=True)

    try:
        yield show
    finally:
        if is_terminal and last >= 0:
            print(file=sys.stderr, flush=True)
