"""How much memory this process has taken, and how much it may take."""

import re
from contextlib import suppress
from pathlib import Path

try:
    import resource
except ImportError:  # Windows has none
    resource = None  # type: ignore[assignment]

_STATUS, _RESET = Path("/proc/self/status"), Path("/proc/self/clear_refs")
# What resets the peak; see proc(5).
_PEAK = "5"


def forget_peak() -> None:
    """Have the peak count from now on, where the system can do that: on Linux."""
    with suppress(OSError):
        _RESET.write_text(_PEAK)


def peak() -> int | None:
    """The most memory that this process has had since then, in bytes; None if nobody tells.

    On macOS it counts from the beginning of the process.
    """
    found = _from_status("VmHWM")
    if found is not None or resource is None:
        return found
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def limit_memory(more: int) -> None:
    """Have requests fail that would take more bytes than this beside what is taken (Linux)."""
    taken = _from_status("VmData")
    if taken is None or resource is None:
        return
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    limit = taken + more
    if hard != resource.RLIM_INFINITY:
        limit = min(limit, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (limit, hard))


def _from_status(name: str) -> int | None:
    """An amount of memory that Linux tells of this process, in bytes."""
    try:
        found = re.search(rf"^{name}:\s+(\d+) kB", _STATUS.read_text(), re.MULTILINE)
    except OSError:
        return None
    return int(found[1]) * 1024 if found else None
