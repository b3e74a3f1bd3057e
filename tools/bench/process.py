"""One flow in a process of its own: its time, and the process's peak memory."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from .meshes import Shape, bumpy_torus

# States that are kept for comparison, as parts of the flow.
KEPT = (0.1, 0.4, 0.7, 1.0)
WARM_UP = 500
# glibc keeps what is freed for the next arrays, as in a process that has worked before. A new one
# gives each large array back. Pardiso takes up to a third longer then, for new pages.
KEEPING = {"MALLOC_MMAP_THRESHOLD_": str(32 << 20), "MALLOC_TRIM_THRESHOLD_": str(64 << 20)}


@dataclass(frozen=True)
class Work:
    """Steps of a method on a mesh: `who` is one of SciPy's ways, or "spectral_tv"."""

    who: str
    method: str
    scheme: str = "lagged"
    solver: str = "auto"
    steps: int | None = None  # the default times, if a number is given


@dataclass(frozen=True)
class Outcome:
    """Seconds of the flow, the process's peak memory in MB, and states (4, V[, 3])."""

    seconds: float
    megabytes: float
    states: np.ndarray


class Bench:
    """A mesh and times on disk, for processes to read."""

    def __init__(self, shape: Shape, times: np.ndarray | None = None) -> None:
        """Write them to a folder that goes with this object."""
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name)
        vertices, triangles = shape
        none = np.zeros(0)
        times = none if times is None else times
        np.savez(self.path / "mesh.npz", vertices=vertices, triangles=triangles, times=times)

    def run(self, work: Work, environment: dict[str, str] | None = None) -> Outcome:
        """Do a work in a new process."""
        command = [sys.executable, "-m", "tools.bench.process", self.path, json.dumps(asdict(work))]
        environment = os.environ | KEEPING | (environment or {})
        done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
        return Outcome(states=np.load(self.path / "states.npy"), **json.loads(done.stdout))


def main() -> None:
    """Do the work of the command line; a small one goes ahead, so that everything is loaded."""
    folder, work = Path(sys.argv[1]), Work(**json.loads(sys.argv[2]))
    data = np.load(folder / "mesh.npz")
    times = data["times"]
    warming = bumpy_torus(WARM_UP)
    flow(work, *warming, np.array([0, 1e-3, 2e-3]))
    vertices, triangles = data["vertices"], data["triangles"]
    started = time.perf_counter()
    result = flow(work, vertices, triangles, times)
    seconds = time.perf_counter() - started
    peak = peak_memory()  # before states are read off, which copies them
    states = result.flow.states if work.who == "spectral_tv" else result
    kept = [round(part * (len(states) - 1)) for part in KEPT]
    np.save(folder / "states.npy", states[kept])
    print(json.dumps({"seconds": seconds, "megabytes": peak}))


def flow(work: Work, vertices: np.ndarray, triangles: np.ndarray, times: np.ndarray):
    """Steps by SciPy, or a decomposition."""
    if work.who != "spectral_tv":
        from .lagged import lagged_steps  # noqa: PLC0415 - neither loads the other

        return lagged_steps(vertices, triangles, times, work.method, work.who)
    import spectral_tv  # noqa: PLC0415

    mesh = spectral_tv.Mesh(vertices, triangles)
    schedule = {"times": times} if work.steps is None else {"steps": work.steps}
    return spectral_tv.decompose(
        mesh, work.method, scheme=work.scheme, solver=work.solver, **schedule
    )


def peak_memory() -> float:
    """The most memory this process had, in MB; getrusage would count what started it too."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    (line,) = (line for line in status.splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1000


if __name__ == "__main__":
    main()
