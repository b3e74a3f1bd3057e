"""The progress of a batch: how many files are done, how many failed, and the time left."""

import sys
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

STEP = 10
# Before so much is done, the time left is not told: a fraction, and seconds.
LEAST, SOON = 0.005, 2.0


class Bar:
    """Counts files; on a terminal in the last line, elsewhere by a line for every tenth.

    Files count by their sizes. Threads may tell it what is done.
    """

    def __init__(self, sizes: Mapping[str, int]) -> None:
        """Count these files, of so many bytes each."""
        self._sizes = {name: max(size, 1) for name, size in sizes.items()}
        self._whole = sum(self._sizes.values()) or 1
        self._parts: dict[str, float] = {}
        self._count = self._failed = 0
        self._sum = 0.0
        self._started = time.monotonic()
        self._last = 0
        self._is_terminal = sys.stderr.isatty()
        self._width = 0
        self._lock = threading.Lock()

    def hear(self, name: str, fraction: float) -> None:
        """Take how much of a file is done."""
        with self._lock:
            if name in self._sizes and fraction > self._parts.get(name, 0.0):
                self._sum += self._sizes[name] * (fraction - self._parts.get(name, 0.0))
                self._parts[name] = fraction
                self._show()

    def close(self, name: str, is_good: bool, lines: list[str]) -> None:
        """Take that a file is done, well or not, and write lines about it."""
        with self._lock:
            size = self._sizes.get(name, 1)
            self._sum += size * (1.0 - self._parts.get(name, 0.0))
            self._parts[name] = 1.0
            self._count += 1
            self._failed += not is_good
            self._clear()
            for line in lines:
                print(line, file=sys.stderr)
            self._show()
            sys.stderr.flush()

    def end(self) -> None:
        """Leave the line."""
        with self._lock:
            self._clear()
            sys.stderr.flush()

    def _clear(self) -> None:
        if self._width:
            print("\r" + " " * self._width + "\r", end="", file=sys.stderr)
            self._width = 0

    def _show(self) -> None:
        fraction = min(self._sum / self._whole, 1.0)
        percent = int(100 * fraction + 1e-9)
        text = f"{percent} %, {self._count} of {len(self._sizes)} files"
        if self._failed:
            text += f", {self._failed} failed"
        text += self._left(fraction)
        if self._is_terminal:
            self._clear()
            print(text, end="", file=sys.stderr, flush=True)
            self._width = len(text)
        elif percent >= self._last + STEP:
            self._last = percent // STEP * STEP
            print(text, file=sys.stderr, flush=True)

    def _left(self, fraction: float) -> str:
        passed = time.monotonic() - self._started
        if fraction < LEAST or fraction >= 1 or passed < SOON:
            return ""
        seconds = passed * (1 - fraction) / fraction
        return f", about {told_time(seconds)} left"


def told_time(seconds: float) -> str:
    """Seconds as a user reads them."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def sizes_of(files: Sequence[Path]) -> dict[str, int]:
    """The bytes of files, by their names; 0 for what is not there."""
    found = {}
    for path in files:
        try:
            found[str(path)] = path.stat().st_size
        except (OSError, ValueError):
            found[str(path)] = 0
    return found
