"""Notes: what a user has to be told beside a result, as it was lost, guessed, skipped or changed.

Code notes it where it finds it, however deep. An operator reports its notes. The command line
prints them and writes them into the report.
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_notes: ContextVar[list[str] | None] = ContextVar("notes", default=None)


def note(text: str) -> None:
    """Note one fact, a sentence without its full stop; the same one is kept once."""
    found = _notes.get()
    if found is not None and text not in found:
        found.append(text)


# Of longer lists the user reads the beginning.
MOST_NAMES = 6


def listed(names: Iterable[str]) -> str:
    """Names as a user reads them, each once: the first few, and how many more there are."""
    distinct = list(dict.fromkeys(names))
    more = len(distinct) - MOST_NAMES
    return ", ".join(distinct[:MOST_NAMES]) + (f" and {more} more" if more > 0 else "")


def a(suffix: str) -> str:
    """A file of this suffix, with its article."""
    return f"an {suffix}" if suffix[1] in "aeo" else f"a {suffix}"


@contextmanager
def about(name: str) -> Iterator[None]:
    """Say in all notes meanwhile which of several objects they are about."""
    found: list[str] = []
    try:
        with gathered() as found:
            yield
    finally:
        for text in found:
            note(f"{name}: {text}")


@contextmanager
def gathered() -> Iterator[list[str]]:
    """Yield the list that all notes go into meanwhile."""
    found: list[str] = []
    token = _notes.set(found)
    try:
        yield found
    finally:
        _notes.reset(token)
