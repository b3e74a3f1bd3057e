"""Tables, printed as they grow and written into a page between markers.

A table named `steps` goes between the lines `<!-- steps -->` and `<!-- /steps -->`.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

import psutil

TABLES = (
    "machine", "steps", "memory", "accuracy", "exact", "eigenpairs", "deformation", "dragging",
    "rigid", "posing", "pose_dragging", "live", "sliders", "smoothing", "interruption", "growth",
    "estimates", "batches",
)  # fmt: skip


class Page:
    """Where tables go: to standard output and, if a path is given, into that page."""

    def __init__(self, path: Path | None) -> None:
        """Refuse a page that lacks the place of a table."""
        self.path = path
        missing = [] if path is None else [name for name in TABLES if not self._place(name)]
        if missing:
            sys.exit(
                f"{path} lacks the markers of {', '.join(missing)}: <!-- NAME --> <!-- /NAME -->"
            )

    @contextmanager
    def table(self, name: str, caption: str, columns: str) -> Iterator[Callable[..., None]]:
        """Give a function that adds a row of cells; `columns` are parted by |."""
        lines = [f"| {columns} |", "|" + " --- |" * (columns.count("|") + 1)]
        stamp = provenance()
        print(f"\n{caption} ({stamp})", *lines, sep="\n", flush=True)

        def row(*cells: object) -> None:
            lines.append("| " + " | ".join(map(str, cells)) + " |")
            print(lines[-1], flush=True)

        yield row
        self.write(name, "\n".join([*lines, "", f"{caption}. *{stamp}*"]))

    def write(self, name: str, text: str) -> None:
        """Put text between the markers of `name`."""
        if self.path is None:
            return
        start, end = self._place(name).span(1)
        page = self._text()
        self.path.write_text(f"{page[:start]}\n{text}\n{page[end:]}", encoding="utf-8")

    def _text(self) -> str:
        return self.path.read_text(encoding="utf-8")

    def _place(self, name: str) -> re.Match[str] | None:
        return re.search(rf"<!-- {name} -->\n(.*?)<!-- /{name} -->", self._text(), re.DOTALL)


def provenance() -> str:
    """When, at which commit, and how busy the machine was with other work just before."""
    now = datetime.now(UTC).strftime("%Y-%m-%d %H:%M")
    busy = psutil.cpu_percent(interval=2)  # of all processors; nothing of ours runs meanwhile
    return f"{now} UTC, {commit()}, {busy:.0f}% busy before"


def commit() -> str:
    """The commit that is measured; the page itself may differ from it."""

    def git(*arguments: str) -> str:
        command = ["git", *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    changes = git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs")
    return git("rev-parse", "--short", "HEAD") + (" with changes" if changes else "")
