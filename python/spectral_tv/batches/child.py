"""The child's side of a worker: does the tasks that standard input names, until it ends.

A line of standard input is a task, pickled. A line of standard output is a message: the fraction
that is done, first 0, and then what became of the task.
"""

import base64
import contextlib
import json
import os
import pickle
import queue
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

import spectral_tv
from spectral_tv.batches.task import Limits, Task
from spectral_tv.command_line import progress
from spectral_tv.command_line.memory import limit_memory
from spectral_tv.command_line.report import Entry
from spectral_tv.command_line.signals import held, released
from spectral_tv.files import whole

# What the program is started with.
SERVE = "serve-a-batch"
# After so many seconds a child that nobody waits for ends itself the hard way.
GRACE = 3.0

Treat = Callable[[Task, Entry], None]


def serve(treat: Treat, mark: str) -> int:
    """Do tasks; every message begins with ``mark``, and all else on standard output is not ours."""
    tasks = _Tasks()
    limits: Limits = next(tasks)
    if limits.threads is not None:
        spectral_tv.set_threads(limits.threads)
    whole.tag = mark[: whole.TAG]
    _be_first_to_go()
    if limits.memory is not None:
        limit_memory(limits.memory)
    messages = _Messages(mark)
    for task in tasks:
        entry = Entry(str(task.source))
        messages.send({"fraction": 0.0})
        with held():  # what became of it is told whenever the signal comes
            try:
                with released():
                    if task.place is not None:
                        os.chdir(task.place)
                    with progress.told_to(messages), tasks.wanted():
                        treat(task, entry)
            except OSError as error:
                entry.fail(f"this machine has no folder {task.place}: {error.strerror}")
            except KeyboardInterrupt:
                if entry.is_good:  # the end was asked for when the work was done
                    messages.close(entry)
                raise
            messages.close(entry)
    return 0


class _Tasks:
    """What is on standard input, as it comes; if that ends, so does the work."""

    def __init__(self) -> None:
        self._found: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._is_busy = False
        threading.Thread(target=self._listen, daemon=True).start()

    def __iter__(self) -> Iterator[Any]:
        return self

    def __next__(self) -> Any:
        line = self._found.get()
        if not line:
            raise StopIteration
        return pickle.loads(base64.b64decode(line))

    @contextlib.contextmanager
    def wanted(self) -> Iterator[None]:
        """Have the work end meanwhile when nobody waits for it any more."""
        self._is_busy = True
        try:
            yield
        finally:
            self._is_busy = False

    def _listen(self) -> None:
        with open(0, "rb", closefd=False) as stream:
            for line in stream:
                self._found.put(line)
        self._found.put(b"")
        if self._is_busy:
            if hasattr(signal, "pthread_kill"):
                signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGTERM)
            else:
                signal.raise_signal(signal.SIGTERM)
            threading.Event().wait(GRACE)
            os._exit(1)


def _be_first_to_go() -> None:
    """Where memory runs out, have Linux end this process and not the one that started it."""
    with contextlib.suppress(OSError), open("/proc/self/oom_score_adj", "w") as file:
        file.write("1000")


class _Messages:
    """Sends messages to the parent; lines wait for the end of the task."""

    def __init__(self, mark: str) -> None:
        self._mark = mark
        self._lines: list[str] = []

    def say(self, line: str) -> None:
        """Keep a line."""
        self._lines.append(line)

    def show(self, _label: str, fraction: float) -> None:
        """Tell the fraction that is done."""
        self.send({"fraction": fraction})

    def taken(self) -> list[str]:
        """The lines that were kept, once."""
        lines, self._lines = self._lines, []
        return lines

    def close(self, entry: Entry) -> None:
        """Tell what became of a task."""
        self.send({"entry": entry.recorded(), "messages": [*self.taken(), *entry.messages]})

    def send(self, message: dict[str, Any]) -> None:
        """Send a message."""
        print(self._mark + json.dumps(message), file=sys.stdout, flush=True)
