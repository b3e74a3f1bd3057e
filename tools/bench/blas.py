"""The BLAS that CHOLMOD runs on: OpenBLAS, or the reference BLAS that is Debian's default."""

from __future__ import annotations

from pathlib import Path

Environment = dict[str, str]


def reference() -> Environment | None:
    """The environment of a process on Debian's reference BLAS, if that is installed."""
    return _environment("blas")


def optimized(threads: int) -> Environment:
    """The environment of a process on OpenBLAS, with so many threads."""
    found = _environment("openblas-pthread")
    if found is None:
        raise FileNotFoundError("OpenBLAS is missing: apt-get install libopenblas0-pthread")
    return found | {"OPENBLAS_NUM_THREADS": str(threads)}


def _environment(folder: str) -> Environment | None:
    for library in Path("/usr/lib").glob(f"*/{folder}/libblas.so.3"):
        return {"LD_LIBRARY_PATH": str(library.parent)}
    return None
