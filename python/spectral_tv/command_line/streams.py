"""Standard output and standard error, which may be closed, or read by nobody."""

import os
import stat
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any, TextIO


@contextmanager
def may_be_lost() -> Iterator[None]:
    """Have messages, not files, be lost with the streams."""
    # What is opened next must not take their places, or messages would go into it.
    with suppress(OSError):
        while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
            pass
        os.close(number)
    former = sys.stdout, sys.stderr
    with ExitStack() as stack:
        sys.stdout = _Lossy(stack.enter_context(_apart(sys.stdout)))
        sys.stderr = _Lossy(sys.stderr)
        try:
            yield
        finally:
            for stream in (sys.stdout, sys.stderr):
                stream.flush()
            sys.stdout, sys.stderr = former


@contextmanager
def _apart(stream: TextIO | None) -> Iterator[TextIO | None]:
    """Keep Blender's own messages from standard output if that is a pipe.

    If the other end of the pipe is closed, Blender's importers end the process.
    """
    try:
        is_pipe = stream is not None and stream.fileno() == 1 and _is_pipe(1)
    except (OSError, ValueError):
        is_pipe = False
    if stream is None or not is_pipe:
        yield stream
        return
    with suppress(OSError, ValueError):
        stream.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)
    try:
        with open(
            kept, "w", encoding=stream.encoding, errors=stream.errors, closefd=False
        ) as other:
            yield other
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def _is_pipe(number: int) -> bool:
    mode = os.fstat(number).st_mode
    return stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode)


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
        with suppress(OSError, ValueError):
            if stream is None:
                return
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, stream.fileno())
            os.close(nowhere)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
