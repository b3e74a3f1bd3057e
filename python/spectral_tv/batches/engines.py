"""Who does the tasks of a batch: workers of this program, or those that an executor has."""

import asyncio
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor, as_completed
from functools import partial
from typing import Any, Protocol

from spectral_tv.batches.task import Task
from spectral_tv.batches.worker import Crew, Worker, treat_task
from spectral_tv.command_line.report import Entry


class Engine(Protocol):
    """Does tasks."""

    def results(self, tasks: Sequence[Task]) -> Iterator[Entry]:
        """What became of each, as it is done."""

    def stop(self) -> list[Entry]:
        """End what is under work, as far as that can be, and tell what became of it."""


def outcome(task: Task, future: Any) -> Entry:
    """What became of a task, by its future; whoever has it may have lost it."""
    try:
        entry: Entry = future.result()
    except (Exception, asyncio.CancelledError) as error:  # of the executor, which may be any
        entry = Entry(str(task.source))
        entry.fail(f"its worker was lost: {str(error) or type(error).__name__}")
    return entry


class OnExecutor:
    """Has an executor of Python's do the tasks, on whatever machines it has.

    Messages come at the end of each task.
    """

    def __init__(self, executor: Executor) -> None:
        """Take who does them."""
        self.executor = executor
        self._futures: dict[Future[Entry], Task] = {}

    def results(self, tasks: Sequence[Task]) -> Iterator[Entry]:
        """What became of each, as it is done."""
        for task in tasks:
            self._futures[self._submit(task)] = task
        for future in as_completed(list(self._futures)):
            yield self._outcome(future)
            del self._futures[future]  # until it was taken, an end tells it

    def stop(self) -> list[Entry]:
        """Have no further one begun, and tell what became of those under work when they end."""
        running = [future for future in self._futures if not future.cancel()]
        return [self._outcome(future) for future in running]

    def _submit(self, task: Task) -> "Future[Entry]":
        return self.executor.submit(treat_task, task)

    def _outcome(self, future: "Future[Entry]") -> Entry:
        return outcome(self._futures[future], future)


class Here(OnExecutor):
    """Does so many tasks at a time in processes of this machine."""

    def __init__(self, jobs: int, heard: Callable[[str, float], object]) -> None:
        """``heard`` is told of a file, by its name, the fraction that is done."""
        super().__init__(ThreadPoolExecutor(jobs))
        self._crew = Crew()
        # Their threads keep them no longer than they live themselves.
        self._stopped: list[Worker] = []
        self._heard = heard

    def results(self, tasks: Sequence[Task]) -> Iterator[Entry]:
        """What became of each, as it is done."""
        try:
            yield from super().results(tasks)
        finally:
            self._stop_crew()
            self.executor.shutdown(cancel_futures=True)

    def stop(self) -> list[Entry]:
        """End what is under work at once."""
        for future in self._futures:
            future.cancel()
        self._stop_crew()
        found = super().stop()
        for worker in self._stopped:
            worker.wait()
        return found

    def _stop_crew(self) -> None:
        self._stopped += self._crew.stop()

    def _submit(self, task: Task) -> "Future[Entry]":
        heard = partial(self._heard, str(task.source))
        return self.executor.submit(self._crew.treat, task, heard)
