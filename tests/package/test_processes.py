"""Everything works in other processes and threads, however they came about, or says why not."""

from __future__ import annotations

import multiprocessing
import sys
import threading
from pathlib import Path

import numpy as np
import pool_work
import pytest
import spectral_tv
from own_process import output
from shapes import icosphere

TESTS = Path(__file__).resolve().parents[1]
METHODS = multiprocessing.get_all_start_methods()
FORKS = pytest.mark.skipif("fork" not in METHODS, reason="this system does not fork")

START = f"""
import copy, os, signal, sys, threading, time, warnings
sys.path.insert(0, {str(TESTS)!r})
warnings.simplefilter("ignore", DeprecationWarning)  # of threads in a process that forks
import numpy as np, pool_work, spectral_tv
from shapes import icosphere

def in_a_fork(work):
    process = os.fork()
    if process == 0:
        signal.alarm(60)
        try:
            work()
            os._exit(0)
        finally:
            import traceback
            traceback.print_exc()
            os._exit(1)
    assert os.waitpid(process, 0)[1] == 0

def refused(call, text):
    try:
        call()
    except RuntimeError as error:
        assert text in str(error), error
    else:
        raise AssertionError("nothing was raised")
"""


def run(code: str) -> str:
    """The output of a process of its own, which ends even where it would hang."""
    return output(START + code, timeout=300)


@FORKS
def test_a_fork_of_a_process_that_used_everything_uses_everything():
    run("""
here = pool_work.everything()
def work():
    assert pool_work.everything() == here
    in_a_fork(lambda: spectral_tv.Mesh(*icosphere(1)))
in_a_fork(work)
assert pool_work.everything() == here
""")


@FORKS
def test_a_fork_keeps_what_was_there():
    run("""
mesh = spectral_tv.Mesh(*icosphere(2))
split = spectral_tv.decompose(mesh, steps=6)
deformer = spectral_tv.Deformer(mesh, [0, 9])
targets = mesh.vertices[[0, 9]] + [[0, 0, 0], [1, 0, 0]]
first = deformer.solve(targets).vertices
poser = spectral_tv.Poser(mesh, [0, 9])
poser.solve(targets)
job = spectral_tv.start_decompose(mesh, steps=6)
while not job.done:
    time.sleep(0.001)
asked_late = spectral_tv.start_decompose(mesh, steps=6)
time.sleep(1)
residual = split.residual
def work():
    assert (split.residual == residual).all()
    assert (job.result().residual == residual).all()
    assert asked_late.done and (asked_late.result().residual == residual).all()
    assert (deformer.solve(targets).vertices == again).all()
    assert (poser.drag(targets).vertices == posed).all()
posed = copy.copy(poser).drag(targets).vertices
again = spectral_tv.Deformer(mesh, [0, 9])
again.solve(targets)
again = again.solve(targets).vertices
in_a_fork(work)
""")


@FORKS
def test_a_fork_is_told_what_goes_on_in_its_parent_alone():
    run("""
mesh = spectral_tv.Mesh(*icosphere(5))
ends = np.flatnonzero(np.abs(mesh.vertices[:, 2]) > 0.95)
shift = np.where(mesh.vertices[ends, 2:] > 0, 1, 0) * [1, 0, 0]
deformer = spectral_tv.Deformer(mesh, ends)
frames = [mesh.vertices[ends] + k * shift for k in np.linspace(0.1, 1, 2000)]
job = spectral_tv.start_decompose(mesh, steps=20_000)
busy = deformer.start_solve_sequence(frames, tolerance=1e-6)
poser = spectral_tv.Poser(mesh, ends)
posing = poser.start_solve_sequence(frames, tolerance=1e-9)
while min(job.progress, busy.progress, posing.progress) < 1e-5:
    time.sleep(0.001)
def work():
    global job, busy, posing
    number = str(os.getppid())
    for running in (job, busy, posing):
        for ask in (lambda: running.done, lambda: running.progress, running.cancel, running.result):
            refused(ask, f"started in process {number}")
    refused(lambda: deformer.drag(frames[0]), f"process {number}")
    refused(lambda: deformer.solve(frames[0]), "make a new one here")
    refused(lambda: copy.copy(deformer), "make a new one here")
    refused(lambda: poser.drag(frames[0]), f"process {number}")
    refused(lambda: poser.set_parameters(stiffness=1), "make a new one here")
    refused(lambda: copy.copy(poser), "make a new one here")
    anew = spectral_tv.start_decompose(mesh, steps=3)
    anew.result()
    del job, busy, posing, running
in_a_fork(work)
def fork(fraction):
    process = os.fork()
    if process:
        assert os.waitpid(process, 0)[1] == 0
        raise KeyError("enough")
    signal.alarm(60)
try:
    spectral_tv.decompose(mesh, steps=20_000, progress=fork)
except KeyError:
    pass
except RuntimeError as error:
    os._exit(0 if "of which this one is a fork" in str(error) else 1)
job.cancel(), busy.cancel(), posing.cancel()
""")


@FORKS
def test_forks_at_any_moment_of_other_threads_do_not_hang():
    run("""
mesh = spectral_tv.Mesh(*icosphere(3))
split = spectral_tv.decompose(mesh, steps=6)
arrays = mesh.vertices, mesh.triangles
is_over = threading.Event()
def keep_on(work):
    while not is_over.is_set():
        work()
works = [
    lambda: spectral_tv.Mesh(*arrays).findings,
    lambda: split.filter(np.ones(5)),
    lambda: spectral_tv.decompose(mesh, steps=2),
]
threads = [threading.Thread(target=keep_on, args=(work,)) for work in works]
for thread in threads:
    thread.start()
def work():
    again = spectral_tv.decompose(spectral_tv.Mesh(*arrays), steps=6)
    assert (again.residual == split.residual).all()
    assert (split.filter(np.ones(5)) == again.filter(np.ones(5))).all()
for _ in range(40):
    in_a_fork(work)
is_over.set()
for thread in threads:
    thread.join()
""")


@pytest.mark.parametrize("method", METHODS)
def test_pools_of_processes_work_by_every_way_to_start_them(method):
    code = f"""
import multiprocessing
from concurrent.futures import ProcessPoolExecutor

if __name__ == "__main__":
    here = pool_work.everything()
    context = multiprocessing.get_context({method!r})
    split = spectral_tv.decompose(spectral_tv.Mesh(*icosphere(2)), steps=6)
    with ProcessPoolExecutor(2, context) as pool:
        futures = [pool.submit(pool_work.everything) for _ in range(2)]
        assert [future.result(120) for future in futures] == [here, here]
        sent = pool.submit(pool_work.filtered, split, 0.5).result(120)
    assert (sent == pool_work.filtered(split, 0.5)).all()
    with context.Pool(2) as pool:
        assert pool.map_async(pool_work.number_of_everything, [None]).get(120)
"""
    run(code)


def test_joblib_sends_meshes_and_gets_decompositions_back():
    joblib = pytest.importorskip("joblib")
    meshes = [spectral_tv.Mesh(*icosphere(level)) for level in (1, 2)]
    task = joblib.delayed(spectral_tv.decompose)
    with joblib.parallel_config("loky", n_jobs=2):
        found = joblib.Parallel(timeout=120)(task(mesh, "m2", steps=5) for mesh in meshes)
    for mesh, split in zip(meshes, found, strict=True):
        expected = spectral_tv.decompose(mesh, "m2", steps=5)
        np.testing.assert_array_equal(split.residual, expected.residual)


def test_several_threads_work_at_once():
    expected = pool_work.everything()
    found = []
    threads = [
        threading.Thread(target=lambda: found.append(pool_work.everything())) for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
    assert found == [expected] * 4


def test_several_threads_wait_for_one_job_and_share_its_result():
    job = spectral_tv.start_decompose(spectral_tv.Mesh(*icosphere(4)), steps=40)
    found = []
    threads = [threading.Thread(target=lambda: found.append(job.result())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
    assert len(found) == 4
    assert all(result is job.result() for result in found)


@pytest.mark.skipif(sys.platform != "linux", reason="reads the names of threads")
def test_no_thread_is_one_of_the_pool_that_a_fork_would_miss():
    """Those of rayon's own pool have the name of the program."""
    names = run("""
os.environ["OPENBLAS_NUM_THREADS"] = "1"
before = set(os.listdir("/proc/self/task"))
pool_work.everything()
new = set(os.listdir("/proc/self/task")) - before
for thread in new:
    print(open(f"/proc/self/task/{thread}/comm").read().strip())
""").split()
    assert set(names) <= {"spectral_tv", "spectral_shared"}
