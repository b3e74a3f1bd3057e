"""Writing a file by an operator of Blender, with the file's name in errors."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from spectral_tv.command_line.errors import reason
from spectral_tv.command_line.signals import heed
from spectral_tv.files.whole import NotWritten, written


@contextmanager
def written_by_blender(target: Path, with_others: bool = False) -> Iterator[Path]:
    """Do as `written`, and name the file in what Blender says if it fails."""
    try:
        with written(target, with_others) as place:
            yield place
    except RuntimeError as error:
        heed()
        raise NotWritten(target, reason(error)) from error
