"""Signals that end the program, and the streams that may be gone."""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any, TextIO

ENDING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
# Writing to what nobody reads, and past a limit, are errors of that write alone.
PASSED_OVER = ("SIGPIPE", "SIGXFSZ")

_received: list[int] = []


@contextmanager
def heeded() -> Iterator[None]:
    """Have the first signal to end raise KeyboardInterrupt, so that files are cleaned up.

    Further ones do not disturb that.
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


class _Lossy:
    """A stream that may be closed, or read by nobody: what is written then is lost, no more."""

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write what can be written."""
        if self._stream is not None:
            try:
                return self._stream.write(text)
            except (OSError, ValueError):
                self._give_up()
        return len(text)

    def flush(self) -> None:
        """Bring it to the other end."""
        if self._stream is not None:
            try:
                self._stream.flush()
            except (OSError, ValueError):
                self._give_up()

    def isatty(self) -> bool:
        """Whether a user looks at it."""
        return self._stream is not None and not self._stream.closed and self._stream.isatty()

    def _give_up(self) -> None:
        """Lead the stream nowhere, so that nothing fails that is still in it."""
        stream, self._stream = self._stream, None
        with suppress(OSError, ValueError, AttributeError):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, stream.fileno())
            os.close(nowhere)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


@contextmanager
def streams_may_be_lost() -> Iterator[None]:
    """Have messages, not files, be lost with standard output and standard error."""
    # What is opened next must not take their places, or messages would go into it.
    with suppress(OSError):
        while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
            pass
        os.close(number)
    former = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = _Lossy(sys.stdout), _Lossy(sys.stderr)  # type: ignore[assignment]
    try:
        yield
    finally:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        sys.stdout, sys.stderr = former
