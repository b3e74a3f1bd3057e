"""The report: a line of JSON for every input, written as soon as the input is done."""

import errno
import io
import json
import os
from dataclasses import field, fields
from pathlib import Path
from typing import Any

from spectral_tv.dataclass import dataclass
from spectral_tv.files.whole import NotWritten, alone

DONE, SKIPPED, FAILED = "done", "skipped", "failed"
INTERRUPTED = "interrupted"


@dataclass
class Entry:
    """What became of an input.

    ``digest`` is the SHA-256 of the file, ``memory`` the most that the process had, in bytes.
    ``read`` and ``done`` say what was in it and what was done to it; ``warnings`` what the user was
    told besides: what was lost, guessed, skipped or changed. ``messages`` are lines for the user
    that have not been told yet.
    """

    input: str
    digest: str | None = None
    output: str | list[str] | None = None
    picture: str | None = None
    status: str = FAILED
    error: str | None = None
    seconds: float = 0.0
    memory: int | None = None
    read: dict[str, Any] | None = None
    done: dict[str, Any] | None = None
    warnings: list[str] = field(default_factory=list)
    messages: list[str] = field(default_factory=list)
    is_recorded: bool = False

    @property
    def is_good(self) -> bool:
        """Whether its output is there."""
        return self.status in (DONE, SKIPPED)

    def fail(self, reason: str) -> None:
        """Say why there is no result."""
        self.status, self.error = FAILED, reason
        label = "" if reason == INTERRUPTED else "error: "
        self.messages.append(f"{self.input}: {label}{reason}")

    def recorded(self) -> dict[str, Any]:
        """What a report has of it."""
        return {name: getattr(self, name) for name in FIELDS}


class Report:
    """A file that lines are added to, each as a whole; without a path they go nowhere."""

    def __init__(self, path: Path | None) -> None:
        """Make sure that it can be written; raises OSError."""
        self._path = path
        if path is not None:
            os.close(os.open(path, os.O_RDWR | os.O_APPEND | os.O_CREAT, 0o666))

    def add(self, entry: Entry) -> None:
        """Add a line; raises NotWritten, and adds nothing then."""
        if self._path is None or entry.is_recorded:
            return
        line = json.dumps(entry.recorded(), default=str, allow_nan=False).encode() + b"\n"
        try:
            with alone(self._path), self._path.open("a+b", buffering=0) as file:
                self._add(file, line, entry)
        except OSError as error:
            raise NotWritten(self._path, os.strerror(error.errno or errno.ENOSPC)) from error

    @staticmethod
    def _add(file: io.FileIO, line: bytes, entry: Entry) -> None:
        end = file.seek(0, os.SEEK_END)
        if end:
            file.seek(end - 1)
            if file.read(1) != b"\n":  # of a program that was ended while it wrote
                line = b"\n" + line
        try:
            if file.write(line) != len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            entry.is_recorded = True
            os.fsync(file.fileno())
        except OSError:
            entry.is_recorded = False
            file.truncate(end)
            raise


FIELDS = [item.name for item in fields(Entry) if item.name not in ("messages", "is_recorded")]
