"""Writing files beside their targets: checked, then put in place.

A file is there whole, or as it was before.
"""

import filecmp
import os
import shutil
import stat
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from spectral_tv.files.checks import Torn, check

try:
    import fcntl
except ImportError:  # Windows has none
    fcntl = None  # type: ignore[assignment]

PREFIX = ".spectral_tv_"
# What names that nobody else has begin with, after PREFIX; "" for nothing in common.
tag = ""
TAG = 6
# A file that was cut short, with less than this left on its disk, was so for lack of room; bytes.
FULL = 65536


class NotWritten(OSError):
    """A file was not written, and what was there before is as it was; the message says why."""

    def __init__(self, target: Path, reason: str) -> None:
        """Take the file and the reason, the end of a sentence."""
        super().__init__(f"{target} cannot be written: {reason}")


@contextmanager
def written(
    target: Path, with_others: bool = False, check: Callable[[Path], None] = check
) -> Iterator[Path]:
    """Yield a path to write to; what was written takes the place of ``target`` at the end.

    The path is in the same folder and has the same suffix, so that relative paths in the file are
    right. With ``with_others`` it has the same name, in a folder of its own beside the target; all
    that is written into that folder is put beside the target, the file itself last. ``check``
    raises Torn for a file that is not whole; if not given, it goes by the suffix.

    Whatever happens, there is all of it, or what was there before. A link stays one, and where it
    leads is written. Permissions are those of the former file, or those that new files get.
    Raises NotWritten.
    """
    place, former = _place(target)
    token = new_name()
    folder = place.parent / token
    temporary = folder / place.name if with_others else place.parent / (token + place.suffix)
    try:
        try:
            if with_others:
                folder.mkdir()
            yield temporary
            _make_sure(target, temporary, check)
            if former is not None:
                _make_like(temporary, former)
            if with_others:
                _put_all(folder, place)
            else:
                os.replace(temporary, place)
            _sync(place.parent)
        except Torn as error:
            raise NotWritten(target, _cut_short(error, place.parent)) from error
        except (OSError, RuntimeError):
            raise
        except Exception as error:  # who reads what was written may not know why it is wrong
            if not _is_full(place.parent):
                raise
            raise NotWritten(target, f"{error}; its disk is full") from error
        finally:
            _remove(place.parent, token)
    except BaseException as error:
        _remove(place.parent, token)  # once more: Ctrl-C may have kept it from being done
        if isinstance(error, NotWritten) or not isinstance(error, OSError):
            raise
        raise NotWritten(target, _reason(error)) from error


# What tells a file from another that takes its place; None where there is none.
Identity = tuple[int, int] | None


def identity(path: Path) -> Identity:
    """The identity of the file at ``path``, as of now."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns


def new_name() -> str:
    """A name that nobody else has, for a while."""
    return PREFIX + (tag + uuid.uuid4().hex)[:12]


def remove_tagged(folder: Path, tag: str) -> None:
    """Remove what a process left behind that was ended; its names had this tag."""
    _remove(folder, PREFIX + tag)


def ensure_writable(target: Path) -> None:
    """Raise NotWritten if ``target`` cannot be written, before the work that makes it."""
    place, _ = _place(target)
    probe = place.parent / new_name()
    try:
        probe.touch()
    except OSError as error:
        raise NotWritten(target, _reason(error)) from error
    finally:
        with suppress(OSError):
            probe.unlink(missing_ok=True)


def write_text(target: Path, text: str) -> None:
    """Write a text in UTF-8; raises NotWritten."""
    with written(target) as path:
        path.write_text(text, encoding="utf-8")


def _place(target: Path) -> tuple[Path, os.stat_result | None]:
    """Where ``target`` really is, and what is there; raises NotWritten if it has to stay."""
    try:
        place = Path(os.path.realpath(target))
        try:
            former = place.stat()
        except FileNotFoundError:
            former = None
        if not place.parent.is_dir():
            raise NotWritten(target, f"there is no folder {place.parent}")
    except NotWritten:
        raise
    except (OSError, ValueError) as error:  # a name that is too long, links in a circle, a null
        raise NotWritten(target, _reason(error)) from error
    if former is not None:
        if stat.S_ISDIR(former.st_mode):
            raise NotWritten(target, "it is a folder")
        if not stat.S_ISREG(former.st_mode):
            raise NotWritten(target, "it is no file")
        # Who may all, as root, would overwrite what is protected without noticing.
        if not former.st_mode & 0o222 or not os.access(place, os.W_OK):
            raise NotWritten(target, "it is read-only")
    return place, former


def _reason(error: OSError | ValueError) -> str:
    code = error.errno if isinstance(error, OSError) else None
    return os.strerror(code) if code is not None else str(error)


def _make_sure(target: Path, temporary: Path, check: Callable[[Path], None]) -> None:
    """Bring the file to the disk; raises NotWritten if there is none, Torn if it is not whole."""
    if not temporary.is_file():
        raise NotWritten(target, "nothing was written")
    if _is_full(temporary.parent) and _has_hole(temporary):
        raise Torn("it has holes")
    check(temporary)
    _sync(temporary, os.O_RDWR)


def _is_full(folder: Path) -> bool:
    return shutil.disk_usage(folder).free < FULL


def _has_hole(path: Path) -> bool:
    """Whether a part of a file was never written, where the system can tell."""
    if not hasattr(os, "SEEK_HOLE"):
        return False
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        try:
            return size > 0 and os.lseek(file.fileno(), 0, os.SEEK_HOLE) < size
        except OSError:
            return False


def _cut_short(error: Torn, folder: Path) -> str:
    return f"it was cut short ({error})" + (", as its disk is full" if _is_full(folder) else "")


def _sync(path: Path, flags: int = os.O_RDONLY) -> None:
    """Have the disk hold a file, or the names in a folder."""
    try:
        descriptor = os.open(path, flags)
    except OSError:  # a folder on Windows
        if path.is_dir():
            return
        raise
    try:
        os.fsync(descriptor)
    except OSError:  # a folder on some file systems
        if not path.is_dir():
            raise
    finally:
        os.close(descriptor)


def _make_like(temporary: Path, former: os.stat_result) -> None:
    """Give a file the owner and the permissions of the one that it replaces."""
    with suppress(OSError, AttributeError):  # only root gives files away; Windows has no owners
        os.chown(temporary, former.st_uid, former.st_gid)
    with suppress(OSError):
        temporary.chmod(stat.S_IMODE(former.st_mode))


def _put_all(folder: Path, place: Path) -> None:
    """Put all files of a folder beside ``place``, that one last; all of them, or none."""
    main = folder / place.name
    others = [path for path in sorted(folder.rglob("*")) if path.is_file() and path != main]
    for path in others:
        _sync(path, os.O_RDWR)
    aside = folder.with_name(folder.name + "_former")
    aside.mkdir()
    put: list[tuple[Path, Path, Path]] = []
    with alone(place.parent):
        try:
            for number, path in enumerate(others):
                goal = place.parent / path.relative_to(folder)
                former = aside / str(number)
                _make_room(goal, path, place)
                put.append((path, goal, former))
                if goal.exists():
                    os.replace(goal, former)
                os.replace(path, goal)
            os.replace(main, place)
        except BaseException:
            for path, goal, former in reversed(put) if main.exists() else ():
                if former.exists():
                    os.replace(former, goal)
                elif not path.exists():
                    goal.unlink(missing_ok=True)
            raise


def _make_room(goal: Path, path: Path, place: Path) -> None:
    """Make sure that ``path`` can be put at ``goal``; raises NotWritten if something else is there.

    What has the name of the main file was written along with an earlier one, and may be replaced.
    """
    goal.parent.mkdir(parents=True, exist_ok=True)
    is_own = goal.relative_to(place.parent).parts[0].startswith(place.stem)
    if goal.is_dir():
        raise NotWritten(goal, "it is a folder")
    if not goal.exists():
        return
    if not is_own and not filecmp.cmp(goal, path, shallow=False):
        raise NotWritten(goal, f"there is another file of that name, which {place.name} needs")
    _make_like(path, goal.stat())


@contextmanager
def alone(path: Path) -> Iterator[None]:
    """Wait until no other process is within this for the path, where the system can tell."""
    if fcntl is None:
        yield
        return
    descriptor = os.open(path, os.O_RDONLY)
    try:
        with suppress(OSError):  # some file systems know no locks
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _remove(folder: Path, token: str) -> None:
    """Remove all that was written under a temporary name and not put in its place."""
    with suppress(OSError):
        for path in folder.iterdir():
            if path.name.startswith(token):
                if path.is_dir():
                    shutil.rmtree(path, ignore_errors=True)
                else:
                    with suppress(OSError):
                        path.unlink(missing_ok=True)
