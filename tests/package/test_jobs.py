"""Long work reports progress, leaves Python free, and stops when told."""

from __future__ import annotations

import _thread
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import spectral_tv
from pulled_sphere import large
from shapes import icosphere


@pytest.fixture(scope="module")
def mesh():
    return spectral_tv.Mesh(*icosphere(5))


def test_progress_rises_to_one(mesh):
    seen = []
    split = spectral_tv.decompose(mesh, "m3", steps=40, progress=seen.append)
    assert split.times[-1] > 0
    assert len(seen) > 2
    assert seen == sorted(seen)
    assert 0 <= seen[0] < 1
    assert seen[-1] == 1


@pytest.mark.bare
def test_an_exception_from_progress_ends_the_work(mesh):
    def stop(fraction):
        raise RuntimeError("enough")

    started = time.perf_counter()
    with pytest.raises(RuntimeError, match="enough"):
        spectral_tv.decompose(mesh, steps=20_000, progress=stop)
    assert time.perf_counter() - started < 30


@pytest.fixture
def own_ctrl_c():
    """Ctrl-C as Python has it: what other tests show may have taken it."""
    former = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, former or signal.SIG_DFL)


@pytest.mark.bare
def test_ctrl_c_ends_the_work(mesh, own_ctrl_c):
    timer = threading.Timer(0.3, _thread.interrupt_main)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        spectral_tv.decompose(mesh, steps=20_000)
    timer.join()


@pytest.mark.bare
def test_the_gil_is_free_during_work(mesh):
    """Another thread keeps running while the main one waits for a result."""
    ticks = []
    done = threading.Event()

    def tick():
        while not done.wait(0.002):
            ticks.append(time.perf_counter())

    thread = threading.Thread(target=tick)
    thread.start()
    spectral_tv.decompose(mesh, steps=100)
    done.set()
    thread.join()
    assert len(ticks) > 20


def test_a_job_gives_what_the_call_gives(mesh):
    job = spectral_tv.start_decompose(mesh, "m2", steps=12, p=3)
    assert 0 <= job.progress <= 1
    result = job.result()
    assert job.done
    assert job.progress == 1
    assert job.result() is result
    expected = spectral_tv.decompose(mesh, "m2", steps=12)
    np.testing.assert_array_equal(result.residual, expected.residual)


def test_a_cancelled_job_does_not_wait_for_another(mesh):
    for _ in range(6):
        first = spectral_tv.start_decompose(mesh, steps=10_000)
        second = spectral_tv.start_decompose(mesh, steps=10_000)
        while min(first.progress, second.progress) < 0.002:
            time.sleep(0.001)
        first.cancel()
        while not first.done:
            time.sleep(0.001)
        assert not second.done
        second.cancel()


def test_a_cancelled_job_says_so(mesh):
    job = spectral_tv.start_decompose(mesh, steps=20_000)
    assert not job.done
    job.cancel()
    with pytest.raises(spectral_tv.Cancelled):
        job.result()
    assert job.done
    job.cancel()


def test_a_job_passes_refusals_on(mesh):
    job = spectral_tv.start_decompose(mesh, times=[0.0, -1.0])
    for _ in range(2):
        with pytest.raises(spectral_tv.MeshError, match="times must increase"):
            job.result()


@pytest.mark.bare
def test_a_forgotten_job_does_not_keep_python_alive():
    code = (
        "import spectral_tv; from shapes import icosphere;"
        "job = spectral_tv.start_decompose(spectral_tv.Mesh(*icosphere(5)), steps=20_000)"
    )
    paths = f"import sys; sys.path[:0] = {sys.path!r};"
    subprocess.run([sys.executable, "-c", paths + code], check=True, timeout=60)


def test_results_do_not_depend_on_the_run(mesh):
    first, second = (spectral_tv.decompose(mesh, steps=10).residual for _ in range(2))
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("kind", [spectral_tv.Deformer, spectral_tv.Poser])
def test_what_is_kept_between_calls_can_be_made_by_a_job(kind):
    mesh, indices, targets = large()
    job = kind.start(mesh, indices)
    assert not job.done
    job.cancel()
    with pytest.raises(spectral_tv.Cancelled):
        job.result()
    made = kind.start(mesh, indices).result()
    expected = kind(mesh, indices).drag(targets)
    np.testing.assert_array_equal(made.drag(targets).vertices, expected.vertices)
    with pytest.raises(spectral_tv.MeshError, match="there are no constraints"):
        kind.start(mesh, [])
