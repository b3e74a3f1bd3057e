"""Messages and progress on standard error, or where else they are told."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

STEP = 10


class Listener(Protocol):
    """Who is told messages and progress."""

    def say(self, line: str) -> None:
        """Take a line."""

    def show(self, label: str, fraction: float) -> None:
        """Take the fraction done of what the label names, in [0, 1]."""


_listener: Listener | None = None


@contextmanager
def told_to(listener: Listener) -> Iterator[None]:
    """Have someone else told meanwhile."""
    global _listener  # noqa: PLW0603 - the process has one standard error too
    former, _listener = _listener, listener
    try:
        yield
    finally:
        _listener = former


def say(message: str) -> None:
    """Write a line."""
    if _listener is not None:
        _listener.say(message)
    else:
        print(message, file=sys.stderr, flush=True)


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Yield a function that takes the fraction done, in [0, 1].

    On a terminal one line counts up; elsewhere there is a line for every tenth.
    """
    listener = _listener
    if listener is not None:
        yield lambda fraction: listener.show(label, fraction)
        return
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
