"""Where memory runs out: a right result or a MemoryError, and never the end of the process.

Every call is tried in forks of a process under limits from tight to loose.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.bare,
    pytest.mark.skipif(sys.platform != "linux", reason="sets limits that Linux has"),
]

TESTS = Path(__file__).resolve().parents[1]
SIDE = 60
# What is left, in megabytes. The last is enough for all, with the scratch of threads on any
# processor, which is addresses for the most part.
LIMITS = [0, 4, 8, 12, 18, 26, 36, 50, 80, 8000]

START = f"""
import copy, os, pickle, resource, signal, sys
os.environ["SPECTRAL_TV_THREADS"] = "2"
sys.path.insert(0, {str(TESTS)!r})
import numpy as np, pool_work, spectral_tv
from shapes import grid

def reading(name):
    lines = open("/proc/self/status").read().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(name + ":"))

vertices, triangles = grid({SIDE}, {SIDE})
vertices[:, 2] += 0.1 * np.sin(9 * vertices[:, 0]) * np.cos(7 * vertices[:, 1])
mesh = spectral_tv.Mesh(vertices, triangles)
split = spectral_tv.decompose(mesh, steps=8)
ends = np.flatnonzero(np.abs(vertices[:, 0] - 0.5) > 0.4)
targets = vertices[ends] + np.where(vertices[ends, :1] > 0.5, 1, 0) * [0.2, 0.1, 0.3]
times = spectral_tv.graded_times(1e-4, 1e-2, 8)
soup = vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
image = vertices[:, 2].reshape({SIDE}, {SIDE})
deformer = spectral_tv.Deformer(mesh, ends)
poser = spectral_tv.Poser(mesh, ends)
spikes = 0.3 * np.sin(1e4 * vertices)

def trial(call, limit, used, room):
    read, write = os.pipe()
    process = os.fork()
    if process == 0:
        signal.alarm(100)
        if room is not None:
            resource.setrlimit(limit, (reading(used) + room, resource.RLIM_INFINITY))
        try:
            outcome = pool_work.digest(call())
        except MemoryError as error:
            outcome = "MemoryError"
        except BaseException as error:
            outcome = repr(error)
        resource.setrlimit(limit, (resource.RLIM_INFINITY,) * 2)
        os.write(write, outcome.encode())
        os._exit(0)
    os.close(write)
    with open(read) as pipe:
        outcome = pipe.read()
    assert os.waitpid(process, 0)[1] == 0, room
    return outcome
"""

CALLS = {
    **{
        f"decompose by {method}": f"spectral_tv.decompose(mesh, '{method}', steps=8).residual"
        for method in ("m1", "m2", "m3", "naive", "heat", "displacement")
    },
    "exact steps": "spectral_tv.decompose(mesh, steps=4, scheme='exact').residual",
    "multigrid": "spectral_tv.decompose(mesh, steps=8, solver='multigrid').residual",
    "accurate steps": "spectral_tv.decompose(mesh, accuracy=0.3).residual",
    "eigenpairs": "spectral_tv.eigenpairs(mesh, 30)",
    "lb": "spectral_tv.decompose(mesh, 'lb', eigenpairs=30).residual",
    "flow": "spectral_tv.flow(mesh, vertices[:, 2], times).states",
    "image": "spectral_tv.decompose_image(image, steps=8).residual",
    "accuracy": "spectral_tv.accuracy(mesh, steps=[4], bands=2, refinement=2).bands",
    "caricature": "spectral_tv.caricature([mesh, mesh], (1e-4, 1e-3), steps=6)",
    "cosegment": "spectral_tv.cosegment([split, split], 3)",
    "conformal flow": "spectral_tv.conformal_flow(mesh, 1e-3)",
    "eigenset test": "spectral_tv.eigenset_test(mesh, vertices[:, 0] < 0.4).values",
    "folds": "spectral_tv.folds(mesh, vertices[:, [1, 0, 2]]).flipped",
    "safe displacement": "spectral_tv.safe_displacement(mesh, spikes).displacement",
    "self-intersections": "spectral_tv.self_intersections(mesh, spikes)",
    **{
        f"deform by {algorithm}": "spectral_tv.deform(mesh, ends, targets, "
        f"algorithm='{algorithm}').vertices"
        for algorithm in ("convex", "paper", "harmonic", "biharmonic", "arap")
    },
    "deformer": "spectral_tv.Deformer(mesh, ends).solve(targets).vertices",
    "drag": "deformer.drag(targets).vertices",
    "sequence": "deformer.solve_sequence([targets, targets * 1.1])[-1].vertices",
    "pose": "spectral_tv.pose(mesh, ends, targets).vertices",
    "drag of a pose": "poser.drag(targets).vertices",
    "poses": "poser.solve_sequence([targets, targets * 1.1])[-1].rotations",
    "mesh": "spectral_tv.Mesh(vertices, triangles).vertex_areas",
    "weld": "spectral_tv.Mesh(*soup, weld=0.0).weld_map",
    "findings": "repr(spectral_tv.Mesh(vertices, triangles).findings)",
    "states": "split.flow.states",
    "bands": "split.bands(split.times)",
    "filter": "split.filter(np.ones(7))",
    "spectrum": "split.flow.spectrum",
    "mean": "split.flow.mean(np.ones(len(vertices)))",
    "total variation": "spectral_tv.total_variation(mesh, vertices)",
    "pickle": "pickle.loads(pickle.dumps(split, 5)).residual",
    "copy of a poser": "copy.copy(poser).drag(targets).vertices",
    "copy of a deformer": "copy.copy(deformer).solve(targets).vertices",
}


@pytest.mark.parametrize("limit", ["AS", "DATA"])
@pytest.mark.parametrize("call", CALLS)
def test_under_any_limit_it_is_right_or_a_memory_error(call, limit):
    code = f"""
limit, used = resource.RLIMIT_{limit}, {{"AS": "VmSize", "DATA": "VmData"}}["{limit}"]
call = lambda: {CALLS[call]}
right = trial(call, limit, used, None)
assert len(right) == 64, right  # a digest
outcomes = [trial(call, limit, used, room * 10**6) for room in {LIMITS}]
assert set(outcomes) <= {{right, "MemoryError"}}, outcomes
assert outcomes[-1] == right, outcomes
"""
    command = [sys.executable, "-c", START + code]
    done = subprocess.run(command, capture_output=True, text=True, timeout=500, check=False)
    assert done.returncode == 0, done.stderr
