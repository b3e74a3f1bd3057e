"""The command line without Blender: ``spectral-tv VERB INPUT -o OUTPUT``.

It needs trimesh and meshio, which read and write the files: ``pip install "spectral-tv[cli]"``.
"""

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from typing import Any

PROGRAM = "spectral-tv"
ADVICE = 'pip install "spectral-tv[cli]"'


def main() -> None:
    """Do what the command line says, and exit with its code."""
    try:
        from spectral_tv.cli.verbs import run  # noqa: PLC0415 - needs what may be missing
    except ModuleNotFoundError as error:
        sys.exit(f"{PROGRAM}: {error.name} is missing: {ADVICE}")
    sys.exit(run(sys.argv[1:]))


def process_files(
    verb: str,
    inputs: Sequence[str | os.PathLike[str]],
    output: str | os.PathLike[str],
    *,
    executor: Executor | None = None,
    **options: Any,
) -> Iterator[dict[str, Any]]:
    """Do what the command line does, with many files, and tell of each as it is done.

    Parameters
    ----------
    verb : str
        One of the command line, such as "decompose".
    inputs : sequence of paths
        Files, folders and patterns.
    output : path
        A file, or a folder that exists.
    executor : concurrent.futures.Executor, optional
        Who does it: a pool of processes or threads, or what Dask, Ray or MPI have like that. Each
        of its workers starts a process for the files, so one that ends it ends itself alone.
        Without an executor, the option ``jobs`` says how many processes of this machine do it.
    **options
        Options of the command line, with _ for -: ``bands=3``, ``skip_existing=True``,
        ``gain={1: 0}`` for ``--gain 1=0``, a list for one that is given several times.

    Yields
    ------
    dict
        What a line of the report has: ``input``, ``output``, ``status`` ("done", "skipped" or
        "failed"), ``error``, ``seconds`` and more.

    Raises
    ------
    ValueError
        If the arguments make no sense; the message is that of the command line.
    """
    from spectral_tv.cli.verbs import batch  # noqa: PLC0415 - needs what may be missing

    arguments = [verb, *(os.fspath(each) for each in inputs), "-o", os.fspath(output)]
    for name, value in options.items():
        flag = f"--{name.replace('_', '-')}"
        arguments += [text for each in _values(value) for text in (flag, *each)]
    for entry in batch(arguments, executor).results():
        yield entry.recorded()


def _values(value: Any) -> list[list[str]]:
    """The values that follow an option, once for each time that it is given."""
    if value is None or value is False:
        return []
    if value is True:
        return [[]]
    if isinstance(value, Mapping):
        return [[f"{key}={each}"] for key, each in value.items()]
    if isinstance(value, (list, tuple)):
        return [[str(each)] for each in value]
    return [[str(value)]]
