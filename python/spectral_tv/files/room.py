"""Finding a place with enough room for a file that must not be written in part."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir

try:
    import resource
except ImportError:  # Windows has none
    resource = None  # type: ignore[assignment]


class NoRoom(OSError):
    """No disk has room for a file; the message says how much it may take."""


@contextmanager
def with_room(place: Path, most: int) -> Iterator[Path]:
    """Yield ``place``, or a path of the same name on another disk, where so many bytes have room.

    What was written there is copied to ``place`` at the end, which may fail, but does so cleanly.
    Raises NoRoom.
    """
    if resource is not None:
        limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
        if limit != resource.RLIM_INFINITY and limit < most:
            raise NoRoom(f"it may take {most / 1e6:.1f} MB, and files of {limit} bytes are allowed")
    if shutil.disk_usage(place.parent).free > most:
        yield place
        return
    if shutil.disk_usage(gettempdir()).free <= most:
        raise NoRoom(f"it may take {most / 1e6:.1f} MB, for which there is no room on any disk")
    with TemporaryDirectory(prefix="spectral_tv_") as folder:
        elsewhere = Path(folder) / place.name
        yield elsewhere
        shutil.copyfile(elsewhere, place)
