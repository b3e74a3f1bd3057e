"""How many threads work has is told by an argument or the environment, and makes no difference."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterator

import numpy as np
import pool_work
import pytest
import spectral_tv
from shapes import icosphere


@pytest.fixture(autouse=True)
def number_of_threads() -> Iterator[None]:
    yield
    spectral_tv.set_threads(None)


def told(**variables: str) -> str:
    """What a process with these variables tells."""
    kept = {k: v for k, v in os.environ.items() if not k.endswith("_THREADS")}
    code = """
import spectral_tv
try:
    print(spectral_tv.threads())
except spectral_tv.MeshError as error:
    print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=kept | variables,
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    return done.stdout.strip()


@pytest.mark.parametrize("count", [1, 2, 3, 8])
def test_results_have_the_same_bits_with_any_number_of_threads(count):
    expected = pool_work.everything()
    with spectral_tv.use_threads(count):
        assert pool_work.everything() == expected


def test_large_results_have_the_same_bits_with_any_number_of_threads():
    """Where work is shared out: meshes of some ten thousand vertices, by all solvers."""
    vertices, triangles = icosphere(5)
    mesh = spectral_tv.Mesh(vertices, triangles)
    soup, corners = vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
    ends = np.flatnonzero(np.abs(vertices[:, 2]) > 0.8)
    wave = 0.6 * np.sin(9 * vertices[:, [1, 2, 0]])
    targets = vertices[ends] + np.where(vertices[ends, 2:] > 0, 1, 0) * [0.3, 0, 0]
    found = {}
    for count in (1, 2, 5):
        with spectral_tv.use_threads(count):
            for solver in ("cholesky", "single", "multigrid"):
                for method in ("m1", "m2", "m3"):
                    split = spectral_tv.decompose(mesh, method, steps=4, solver=solver)
                    bits = pool_work.digest((split.residual, split.spectrum))
                    assert found.setdefault((method, solver), bits) == bits
            others = (
                spectral_tv.Mesh(soup, corners, weld=0.0).vertex_areas,
                spectral_tv.decompose(mesh, steps=2, scheme="exact").residual,
                spectral_tv.eigenpairs(mesh, 12),
                vars(spectral_tv.folds(mesh, wave)),
                vars(spectral_tv.safe_displacement(mesh, wave)),
                spectral_tv.self_intersections(mesh, wave),
                spectral_tv.deform(mesh, ends, targets).vertices,
                spectral_tv.pose(mesh, ends, targets).rotations,
                spectral_tv.deform(mesh, ends, targets, algorithm="arap", tolerance=0.1).vertices,
            )
            assert found.setdefault("others", pool_work.digest(others)) == pool_work.digest(others)


def test_the_number_is_that_of_the_innermost_block_then_that_of_the_function():
    spectral_tv.set_threads(5)
    assert spectral_tv.threads() == 5
    with spectral_tv.use_threads(3):
        assert spectral_tv.threads() == 3
        spectral_tv.set_threads(4)
        with spectral_tv.use_threads(2):
            assert spectral_tv.threads() == 2
        with spectral_tv.use_threads(None):
            assert spectral_tv.threads() == 4
        assert spectral_tv.threads() == 3
    assert spectral_tv.threads() == 4


def test_a_block_ends_where_an_exception_leaves_it():
    before = spectral_tv.threads()
    with pytest.raises(KeyError), spectral_tv.use_threads(before + 1):
        raise KeyError
    assert spectral_tv.threads() == before


def test_a_block_is_of_one_thread_of_python_and_the_function_of_all():
    spectral_tv.set_threads(5)
    found = []
    with spectral_tv.use_threads(3):
        thread = threading.Thread(target=lambda: found.append(spectral_tv.threads()))
        thread.start()
        thread.join()
    assert found == [5]


@pytest.mark.skipif(sys.platform != "linux", reason="counts the threads of the process")
@pytest.mark.parametrize("count", [1, 3, 6])
def test_work_has_as_many_threads_as_were_asked_for(count):
    code = f"""
import os, sys
sys.path[:0] = {sys.path!r}
import spectral_tv
from shapes import icosphere
mesh = spectral_tv.Mesh(*icosphere(4))
before = len(os.listdir("/proc/self/task"))
with spectral_tv.use_threads({count}):
    job = spectral_tv.start_decompose(mesh, steps=20_000)
while job.progress < 1e-4:
    pass
print(len(os.listdir("/proc/self/task")) - before)
job.cancel()
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    # One more waits for their result.
    assert int(done.stdout) == count + 1


def test_the_environment_tells_the_number():
    assert told(SPECTRAL_TV_THREADS="3") == "3"
    assert told(SPECTRAL_TV_THREADS="3", RAYON_NUM_THREADS="5") == "3"
    assert told(SPECTRAL_TV_THREADS="", RAYON_NUM_THREADS="5") == "5"
    assert told(RAYON_NUM_THREADS="0") == told()


@pytest.mark.parametrize("value", ["0", "-1", "many", "2.5", "99999999999999999999"])
def test_a_number_in_the_environment_that_is_none_is_refused(value):
    message = told(SPECTRAL_TV_THREADS=value)
    assert message.startswith("SPECTRAL_TV_THREADS must be a number of threads, from 1 to ")
    assert value in message


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="has no such call")
def test_by_default_it_is_that_of_the_processors_the_process_may_use():
    allowed = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(allowed)})
        assert told() == "1"
    finally:
        os.sched_setaffinity(0, allowed)


@pytest.mark.parametrize("count", [0, 10**9])
def test_a_number_that_cannot_be_is_refused(count):
    for function in (spectral_tv.set_threads, lambda n: spectral_tv.use_threads(n).__enter__()):
        with pytest.raises(spectral_tv.MeshError, match=f"count must be .* not {count}"):
            function(count)
    assert np.isfinite(spectral_tv.threads())
