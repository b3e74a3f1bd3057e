"""Setting the number of threads within a block."""

from collections.abc import Iterator
from contextlib import contextmanager

from spectral_tv._native import _use_threads


@contextmanager
def use_threads(count: int | None) -> Iterator[None]:
    """Have the calls and the new jobs of this thread use so many threads within a `with` block.

    Other threads of Python are not concerned; see `set_threads` for all of them.

    Parameters
    ----------
    count : int or None
        At least 1; None for the number that all threads use.

    Raises
    ------
    MeshError
        If count is 0, or more than can be.
    """
    before = _use_threads(count)
    try:
        yield
    finally:
        _use_threads(before)
