"""Dask as the engine of a batch: a scheduler that is there, or workers on this machine."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any

import dask.config
import distributed

from spectral_tv.batches.engines import outcome
from spectral_tv.batches.options import LOCAL, cores, free_memory
from spectral_tv.batches.task import Task
from spectral_tv.batches.worker import treat_task
from spectral_tv.command_line.progress import say
from spectral_tv.command_line.report import Entry
from spectral_tv.refusal import Refusal

library: Any = distributed  # its functions have no types
# The resource of Dask's workers that tasks ask for, in bytes.
RESOURCE = "memory"
# So long a scheduler may take to answer.
PATIENCE = "30s"
# So many seconds may pass until it has taken leave; else it is left to find out.
LEAVE = 10
# What watches workers many times a second takes a part of the cores that they share. These hold for
# workers on this machine, where the user has not set them.
CALM = {
    "distributed": {
        "worker": {"profile": {"enabled": False}, "memory": {"monitor-interval": "1s"}},
        "admin": {
            "tick": {"interval": "1s", "cycle": "2s"},
            "system-monitor": {"interval": "2s"},
        },
    }
}


class OnDask:
    """Has Dask's workers do tasks, each on one that has the memory for it.

    A task whose worker is lost comes to another one, as often as Dask's configuration
    ``distributed.scheduler.allowed-failures`` says. One that fails does not come again.
    """

    def __init__(self, address: str, needs: Sequence[int]) -> None:
        """Find the scheduler, or start workers for tasks that need so many bytes.

        Raises Refusal if no scheduler answers.
        """
        self._needs = needs
        self._futures: dict[Any, Task] = {}
        self._cluster: Any = _local_cluster(max(needs, default=0)) if address == LOCAL else None
        try:
            self._client: Any = library.Client(self._cluster or address, timeout=PATIENCE)
        except (OSError, ValueError, TypeError) as error:
            raise Refusal(f"--scheduler {address}: {error}") from error
        say(f"dashboard: {self._client.dashboard_link}")

    def results(self, tasks: Sequence[Task]) -> Iterator[Entry]:
        """What became of each, as it is done."""
        most = self._most()
        for task, need in zip(tasks, self._needs, strict=True):
            asked = {"resources": {RESOURCE: min(need, most)}} if most is not None else {}
            # What is done twice is written twice, the same.
            future = self._client.submit(treat_task, task, pure=False, retries=0, **asked)
            self._futures[future] = task
        done = library.as_completed(list(self._futures), raise_errors=False)
        for future in done:
            yield self._outcome(future)
            del self._futures[future]  # until it was taken, an end tells it
        self._close()

    def stop(self) -> list[Entry]:
        """Have no further one begun, and tell of those that are done.

        Workers elsewhere bring to its end what they are at; that is found there next time.
        """
        done = [future for future in self._futures if future.status == "finished"]
        found = []
        for future in done:
            with suppress(Exception):  # of a scheduler that is gone
                found.append(self._outcome(future))
        with suppress(Exception):
            self._client.cancel(list(self._futures), force=True)
        self._close()
        return found

    def _most(self) -> float | None:
        """The most memory that a worker declares; None if one declares nothing."""
        workers = self._client.scheduler_info(n_workers=-1)["workers"].values()
        declared = [worker.get("resources", {}).get(RESOURCE) for worker in workers]
        if not declared:
            say("the scheduler has no workers yet; the work begins when one comes")
        if not declared or None in declared:
            return None
        return max(declared)

    def _outcome(self, future: Any) -> Entry:
        # A result that was lost along with its worker is made again.
        return outcome(self._futures[future], future)

    def _close(self) -> None:
        for each in (self._client, self._cluster):
            if each is not None:
                with suppress(Exception):  # a scheduler that is gone
                    each.close(timeout=LEAVE)


def _local_cluster(need: int) -> Any:
    """Workers on this machine, as many as its cores and memory allow; it listens on loopback."""
    free = free_memory()
    count = cores()
    if free is not None and need:
        count = max(1, min(count, int(free / need)))
    share = {} if free is None else {RESOURCE: free / count}
    say(f"{count} workers on this machine")
    dask.config.update_defaults(CALM)
    return library.LocalCluster(
        n_workers=count,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",
        resources=share,
    )
