"""A batch: the files that a command is for, who works on them, and what is told of each."""

import argparse
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import ClassVar, Protocol

from spectral_tv.batches.bar import Bar, sizes_of
from spectral_tv.batches.engines import Engine, Here, OnExecutor
from spectral_tv.batches.options import GIGABYTE, NAMES, cores, free_memory
from spectral_tv.batches.task import Limits, Task
from spectral_tv.command_line.progress import say
from spectral_tv.command_line.report import INTERRUPTED, SKIPPED, Entry, Report
from spectral_tv.command_line.signals import heed, held, released

# What the process of a task is not told.
OWN = {"run", "parser", "child", "inputs", "beneath", *NAMES}


class Works(Protocol):
    """A command, as a batch sees it."""

    name: ClassVar[str]
    # Whether all inputs are one work, which cannot be shared out.
    is_together: ClassVar[bool]
    choices: argparse.Namespace

    def targets(self, source: Path) -> list[Path]:
        """The files that are written for an input."""

    def need(self, source: Path) -> int:
        """About how much memory it takes for an input, in bytes."""

    def treat_input(self, source: Path, entry: Entry) -> None:
        """Do it, and say in ``entry`` what became of it."""


class Batch:
    """The files that a command is for; each is closed once, in the report and for the user."""

    def __init__(
        self, command: Works, report: Report, executor: Executor | None = None, quiet: bool = False
    ) -> None:
        """Take what is done, where what became of it is written, and who does it, if not we.

        Nothing is said to the user if ``quiet``.
        """
        self._command, self._report = command, report
        self._choices = command.choices
        self._executor, self._quiet = executor, quiet
        self._open = {str(source): source for source in self._choices.inputs}
        self._good: list[bool] = []
        self._skipped = 0
        self._bar: Bar | None = None

    def run(self) -> bool:
        """Treat every input, those that fail too; whether all of them succeeded."""
        try:
            for _ in self.results():
                pass
        except KeyboardInterrupt:
            for name in self._open:
                say(f"{name}: not begun")
            raise
        if len(self._good) > 1:
            more = f", {self._skipped} of them skipped" if self._skipped else ""
            say(f"{sum(self._good)} of {len(self._good)} inputs succeeded{more}")
        return all(self._good)

    def results(self) -> Iterator[Entry]:
        """Treat every input; what became of each, as it is done."""
        if self._choices.skip_existing:
            yield from self._skip()
        rest = list(self._open.values())
        yield from self._do_here(rest) if self._is_done_here(len(rest)) else self._hand_out(rest)

    def _skip(self) -> Iterator[Entry]:
        """Close the inputs whose outputs are there."""
        for name, source in list(self._open.items()):
            targets = self._command.targets(source)
            if targets and all(target.exists() for target in targets):
                self._skipped += 1
                yield self._close(Entry(name, output=str(targets[0]), status=SKIPPED))

    def _is_done_here(self, count: int) -> bool:
        """Whether this process does the work itself: one file, and nothing that guards it."""
        choices = self._choices
        is_guarded = any(
            getattr(choices, name, None) is not None
            for name in ("jobs", "timeout", "memory", "scheduler")
        )
        if self._command.is_together:
            return True
        if self._executor is not None:
            return False
        return choices.child is None or (count <= 1 and not is_guarded)

    def _do_here(self, sources: Sequence[Path]) -> Iterator[Entry]:
        for source in sources:
            entry = Entry(str(source))
            with held():  # what became of it is told whenever the signal comes
                try:
                    with released():
                        self._command.treat_input(source, entry)
                except KeyboardInterrupt:
                    if not entry.is_good and entry.error is None:
                        entry.fail(INTERRUPTED)
                    raise
                finally:
                    self._close(entry)
            yield entry
            heed()

    def _hand_out(self, sources: Sequence[Path]) -> Iterator[Entry]:
        engine = self._engine(sources)
        self._bar = None if self._quiet else Bar(sizes_of(sources))
        is_whole = False
        try:
            for entry in engine.results(self._tasks(sources)):
                yield self._close(entry)
            is_whole = True
        finally:
            if not is_whole:
                for entry in engine.stop():
                    self._close(entry)
            if self._bar is not None:
                self._bar.end()
            self._bar = None

    def _engine(self, sources: Sequence[Path]) -> Engine:
        """Who does it; raises Refusal if it cannot be found."""
        choices = self._choices
        if self._executor is not None:
            return OnExecutor(self._executor)
        scheduler = getattr(choices, "scheduler", None)
        if scheduler is None:
            return Here(choices.jobs or 1, self._hear)
        from spectral_tv.batches.on_dask import OnDask  # noqa: PLC0415 - needs what may be missing

        return OnDask(scheduler, [self._command.need(source) for source in sources])

    def _hear(self, name: str, fraction: float) -> None:
        """Take how much of a file is done, from any thread."""
        if self._bar is not None:
            self._bar.hear(name, fraction)

    def _tasks(self, sources: Sequence[Path]) -> list[Task]:
        choices = self._choices
        is_ours = self._executor is None and getattr(choices, "scheduler", None) is None
        jobs = choices.jobs or 1
        # Where others hand out the work, they have a worker for each core.
        shared = max(1, cores() // jobs) if jobs > 1 else None
        threads = shared if is_ours else 1
        limits = Limits(choices.timeout, self._memory(jobs, is_ours), threads)
        asked = {name: value for name, value in vars(choices).items() if name not in OWN}
        return [
            Task(
                source,
                self._command.name,
                asked | {"inputs": [source], "beneath": {source: choices.beneath[source]}},
                tuple({target.absolute().parent for target in self._command.targets(source)}),
                limits,
                tuple(choices.child) if is_ours else None,
                None if is_ours else Path.cwd(),
            )
            for source in sources
        ]

    def _memory(self, jobs: int, is_ours: bool) -> int | None:
        """What a task may take, in bytes."""
        if self._choices.memory is not None:
            return int(self._choices.memory * GIGABYTE)
        free = free_memory() if is_ours else None
        return None if free is None else int(free / jobs)

    def _close(self, entry: Entry) -> Entry:
        """Say and record what became of an input, once, whatever comes between."""
        with held():
            if entry.input in self._open:
                self._tell(entry)
        return entry

    def _tell(self, entry: Entry) -> None:
        is_good = entry.is_good
        try:
            self._report.add(entry)
        except OSError as error:
            entry.messages.append(f"{entry.input}: error: {error}")
            is_good = False
        del self._open[entry.input]
        self._good.append(is_good)
        if self._bar is not None:
            self._bar.close(entry.input, is_good, entry.messages)
        elif not self._quiet:
            for line in entry.messages:
                say(line)
