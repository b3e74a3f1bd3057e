"""The parent's side of a worker: a process that does one task after the other.

A task that ends the process, or takes too long, ends itself alone: the next one gets a new process.
"""

import atexit
import base64
import json
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
import uuid
import weakref
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from spectral_tv.batches.child import SERVE
from spectral_tv.batches.task import Limits, Task
from spectral_tv.command_line.report import INTERRUPTED, Entry
from spectral_tv.files import whole

Heard = Callable[[float], object]
# What starts this package's program on this machine.
HERE = (sys.executable, "-m", "spectral_tv.cli")
# It says within so many seconds that it has begun.
START = 300.0
# Asked to end, a process has so many seconds to clean up.
PATIENCE = 3.0


def treat_task(task: Task) -> Entry:
    """Do a task in the process that this thread has for them, and say what became of it.

    Any executor may call this, on any machine.
    """
    return _crew.treat(task)


class Crew:
    """Workers, one for each thread that has tasks."""

    def __init__(self) -> None:
        """Begin without any."""
        self._own = threading.local()
        self._all: weakref.WeakSet[Worker] = weakref.WeakSet()
        self._is_stopped = False

    def treat(self, task: Task, heard: Heard | None = None) -> Entry:
        """Do a task; ``heard`` is told the fraction that is done."""
        worker: Worker | None = getattr(self._own, "worker", None)
        if worker is None or not worker.serves(task):
            if worker is not None:
                worker.stop()
            worker = self._own.worker = Worker(task)
            self._all.add(worker)
        if self._is_stopped:
            worker.stop()
        return worker.do(task, heard)

    def stop(self) -> "list[Worker]":
        """End all processes, and what they are at, for good; the workers that had them."""
        self._is_stopped = True
        stopped = list(self._all)
        for worker in stopped:
            worker.stop()
        return stopped


_crew = Crew()
# Those of a program that ends would find out by themselves, but later.
atexit.register(_crew.stop)


class Worker:
    """A process that does tasks, started when there is one."""

    def __init__(self, task: Task) -> None:
        """Do tasks like this one."""
        self._limits = replace(task.limits, seconds=None)
        self._child = task.child
        self._mark = uuid.uuid4().hex
        self._process: subprocess.Popen[bytes] | None = None
        self._lines: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._is_stopped = False

    def serves(self, task: Task) -> bool:
        """Whether it was started for tasks like this one."""
        limits = replace(task.limits, seconds=None)
        return not self._is_stopped and (self._child, self._limits) == (task.child, limits)

    def do(self, task: Task, heard: Heard | None = None) -> Entry:
        """Do a task; what ends it is told in the entry."""
        started = time.monotonic()
        entry = Entry(str(task.source))
        try:
            return self._told(self._message(task, heard))
        except _Ended as error:
            last = self._end(task.folders)
            if last is not None:
                return last
            entry.fail(INTERRUPTED if self._is_stopped else str(error))
            entry.seconds = round(time.monotonic() - started, 3)
        return entry

    def stop(self) -> None:
        """End the process, and what it is at; another thread may wait for that."""
        self._is_stopped = True
        process = self._process
        if process is not None and process.poll() is None:
            with suppress(OSError):
                process.terminate()

    @staticmethod
    def _told(message: dict[str, Any]) -> Entry:
        return Entry(**message["entry"], messages=message["messages"])

    def wait(self) -> None:
        """Wait for the end of the process, when it was stopped and nobody waits for a task."""
        self._end(())

    def _message(self, task: Task, heard: Heard | None) -> dict[str, Any]:
        """What the process says of the task at its end; raises _Ended if it does not."""
        if self._process is None or self._process.poll() is not None:
            self._start()
        if self._is_stopped:  # before the start, or meanwhile
            raise _Ended(INTERRUPTED)
        self._tell(task)
        self._heard_within(START, "its process did not start")
        seconds = task.limits.seconds
        deadline = None if seconds is None else time.monotonic() + seconds
        while True:
            left = None if deadline is None else deadline - time.monotonic()
            message = self._heard_within(left, f"it took longer than {seconds or 0:g} s")
            if "entry" in message:
                return message
            if heard is not None:
                heard(message["fraction"])

    def _heard_within(self, seconds: float | None, otherwise: str) -> dict[str, Any]:
        """The next message of the process; raises _Ended, with what is wrong, if none comes."""
        try:
            line = self._lines.get(timeout=None if seconds is None else max(0.0, seconds))
        except queue.Empty:
            raise _Ended(otherwise) from None
        if line is None:
            self._lines.put(None)  # the end stays the end
            raise _Ended(self._reason())
        message: dict[str, Any] = json.loads(line)
        return message

    def _start(self) -> None:
        """Start the process."""
        command = self._child or HERE
        self._lines = queue.SimpleQueue()
        try:
            self._process = subprocess.Popen(
                [*command, SERVE, self._mark],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                # The terminal's Ctrl-C is for the parent, which ends its children.
                start_new_session=True,
            )
        except OSError as error:
            raise _Ended(f"{command[0]} cannot be started: {error}") from error
        # A thread that ends leaves its worker to nobody.
        weakref.finalize(self, _release, self._process)
        threading.Thread(
            target=_pass_on, args=(self._process, self._mark, self._lines), daemon=True
        ).start()
        self._tell(self._limits)

    def _tell(self, thing: Task | Limits) -> None:
        assert self._process is not None
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(base64.b64encode(pickle.dumps(thing)) + b"\n")
            self._process.stdin.flush()
        except OSError as error:
            raise _Ended(self._reason()) from error

    def _reason(self) -> str:
        """Why a process ended."""
        assert self._process is not None
        code = self._process.wait()
        if code >= 0:
            return f"its process ended (exit code {code})"
        name = _signal_name(-code)
        more = "; so systems do when memory runs out" if name == "SIGKILL" else ""
        return f"its process was ended by {name}{more}"

    def _end(self, folders: Iterable[Path]) -> Entry | None:
        """End the process, and remove what it was writing; what it still says of its task."""
        process, self._process = self._process, None
        if process is None:
            return None
        with suppress(OSError):
            process.terminate()
        try:
            process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            with suppress(OSError):
                os.killpg(process.pid, signal.SIGKILL) if hasattr(os, "killpg") else process.kill()
            process.wait()
        last = self._last_word()
        for stream in (process.stdin, process.stdout):
            with suppress(OSError):
                if stream is not None:
                    stream.close()
        for folder in folders:
            whole.remove_tagged(folder, self._mark[: whole.TAG])
        return last

    def _last_word(self) -> Entry | None:
        """What a process that was ended says of a task that it had done before."""
        with suppress(queue.Empty):
            while (line := self._lines.get(timeout=PATIENCE)) is not None:
                message = json.loads(line)
                if "entry" in message:
                    return self._told(message)
        return None


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:  # a signal for real time
        return f"signal {number}"


class _Ended(Exception):
    """A process ended before its task; the message says why."""


def _release(process: "subprocess.Popen[bytes]") -> None:
    """Have a process end by itself, as no further task comes."""
    with suppress(OSError):
        if process.stdin is not None:
            process.stdin.close()


def _pass_on(
    process: "subprocess.Popen[bytes]", mark: str, lines: "queue.SimpleQueue[bytes | None]"
) -> None:
    """Pass on the messages of a process, and None at its end."""
    assert process.stdout is not None
    start = mark.encode()
    with suppress(OSError, ValueError):
        for line in process.stdout:
            if line.startswith(start):
                lines.put(line[len(start) :])
    lines.put(None)
