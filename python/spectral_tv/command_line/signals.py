"""Signals that ask the program to end."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

ENDING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
# Writing to what nobody reads, and past a limit, are errors of that write alone.
PASSED_OVER = ("SIGPIPE", "SIGXFSZ")

_received: list[int] = []


@contextmanager
def heeded() -> Iterator[None]:
    """Have the first signal that asks for an end raise KeyboardInterrupt; so files are cleaned up.

    Further signals do not disturb the cleaning.
    """
    # Blender's own handlers would wait for the end.
    former: dict[int, Any] = {}
    _received.clear()
    try:
        for name in (*ENDING, *PASSED_OVER):
            number = getattr(signal, name, None)
            if number is None:
                continue
            handler = signal.getsignal(number)
            if name == "SIGHUP" and handler == signal.SIG_IGN:  # nohup
                continue
            former[number] = handler
            signal.signal(number, _receive if name in ENDING else signal.SIG_IGN)
        yield
    finally:
        for number, handler in former.items():
            signal.signal(number, handler if handler is not None else signal.SIG_DFL)


def heed() -> None:
    """Raise KeyboardInterrupt if a signal came that Blender, or an add-on of it, kept to itself."""
    if _received:
        raise KeyboardInterrupt


def code() -> int:
    """The exit code after a signal, as shells count them."""
    return 128 + (_received[0] if _received else signal.SIGINT)


def _receive(number: int, _frame: FrameType | None) -> None:
    _received.append(number)
    if len(_received) == 1:
        raise KeyboardInterrupt
