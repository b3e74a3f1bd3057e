"""Signals that ask the program to end."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

ENDING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
# Writing to what nobody reads, and past a limit, are errors of that write alone.
PASSED_OVER = ("SIGPIPE", "SIGXFSZ")


@dataclass
class _State:
    """What came, whether it has to wait, and whether something waits."""

    received: list[int] = field(default_factory=list)
    is_held: bool = False
    is_waiting: bool = False


_state = _State()


@contextmanager
def heeded() -> Iterator[None]:
    """Have the first signal that asks for an end raise KeyboardInterrupt; so files are cleaned up.

    Further signals do not disturb the cleaning.
    """
    # Blender's own handlers would wait for the end.
    former: dict[int, Any] = {}
    _state.received.clear()
    _state.is_waiting = False
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
    if _state.received:
        raise KeyboardInterrupt


@contextmanager
def held() -> Iterator[None]:
    """Have signals wait meanwhile; one that came raises KeyboardInterrupt at the end."""
    with _holding(True):
        yield
    _let_go()


@contextmanager
def released() -> Iterator[None]:
    """Have signals raise KeyboardInterrupt at once, in what holds them otherwise."""
    with _holding(False):
        _let_go()
        yield


@contextmanager
def _holding(is_held: bool) -> Iterator[None]:
    former, _state.is_held = _state.is_held, is_held
    try:
        yield
    finally:
        _state.is_held = former


def _let_go() -> None:
    """Have what waits raise KeyboardInterrupt, unless it is held."""
    if _state.is_waiting and not _state.is_held:
        _state.is_waiting = False
        raise KeyboardInterrupt


def code() -> int:
    """The exit code after a signal, as shells count them."""
    return 128 + (_state.received[0] if _state.received else signal.SIGINT)


def _receive(number: int, _frame: FrameType | None) -> None:
    _state.received.append(number)
    if len(_state.received) == 1:
        _state.is_waiting = True
        _let_go()
