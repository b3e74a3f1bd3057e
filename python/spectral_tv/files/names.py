"""Whether several names are one file."""

import os
import unicodedata
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from spectral_tv.files.whole import new_name

# A name that is another one where small letters and accents by themselves count.
SMALL, LARGE = "a\u0308", "\u00c4"


def takes_alike(folder: Path) -> bool:
    """Whether a folder takes names for the same that differ in case or in how accents are coded.

    A folder that cannot be written tells nothing, and is taken for one that does not.
    """
    token = new_name()
    probe = folder / (token + SMALL)
    try:
        probe.touch()
        return any((folder / (token + name)).exists() for name in (LARGE, "\u00e4", "A\u0308"))
    except OSError:
        return False
    finally:
        with suppress(OSError):
            probe.unlink(missing_ok=True)


def file_keys(
    paths: Sequence[Path], takes_alike: Callable[[Path], bool] = takes_alike
) -> list[str]:
    """A key for each path: those of paths that are the same file are equal."""
    places = [os.path.realpath(path) for path in paths]
    folded = [
        unicodedata.normalize("NFC", unicodedata.normalize("NFC", place).casefold())
        for place in places
    ]
    groups: dict[str, set[str]] = {}
    for place, key in zip(places, folded, strict=True):
        groups.setdefault(key, set()).add(place)
    unsure = {key: min(group) for key, group in groups.items() if len(group) > 1}
    alike = {key for key, place in unsure.items() if takes_alike(Path(place).parent)}
    return [key if key in alike else place for place, key in zip(places, folded, strict=True)]
