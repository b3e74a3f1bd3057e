"""Many threads of Python at once, on objects that they share and on their own.

In a Python without a GIL they really run side by side.
"""

from __future__ import annotations

import contextlib
import copy
import pickle
import sys
import sysconfig
import threading
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import spectral_tv
from pool_work import digest
from shapes import bumpy_sphere

COUNT = 8
ROUNDS = 3
VERTICES, TRIANGLES = bumpy_sphere(2)
ENDS = np.flatnonzero(np.abs(VERTICES[:, 2]) > 0.7)
REST = VERTICES[ENDS]
PULLED = REST + np.where(REST[:, 2:] > 0, 1, 0) * [0.4, 0.1, 0.2]
BODIES = np.where(REST[:, 2] > 0, 0, -1)
KINDS = {
    "deformer": lambda mesh: spectral_tv.Deformer(mesh, ENDS),
    "poser": lambda mesh: spectral_tv.Poser(mesh, ENDS),
    "poser of bodies": lambda mesh: spectral_tv.Poser(mesh, ENDS, bodies=BODIES),
}


def together(work: Callable[[int], Any], count: int = COUNT) -> list[Any]:
    """What `count` threads that begin at once get of `work`, which is told their numbers."""
    start = threading.Barrier(count)
    found: list[Any] = [None] * count
    raised = []

    def run(number: int) -> None:
        try:
            start.wait(60)
            found[number] = work(number)
        except BaseException as error:
            raised.append(error)

    threads = [threading.Thread(target=run, args=(number,)) for number in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if raised:
        raise raised[0]
    return found


@pytest.fixture
def mesh():
    """One of which nothing has been asked yet, as of what is found out when first asked for."""
    return spectral_tv.Mesh(VERTICES, TRIANGLES)


def wave(number: int) -> np.ndarray:
    return 0.4 * np.sin((3 + number) * VERTICES[:, [1, 2, 0]])


# What a thread does with objects that others use too.
SHARED = {
    "areas": lambda mesh, split, n: (mesh.vertex_areas, mesh.area, mesh.face_areas),
    "findings": lambda mesh, split, n: vars(mesh.findings),
    "thickness": lambda mesh, split, n: spectral_tv.thickness(mesh),
    "decompose": lambda mesh, split, n: (
        spectral_tv.decompose(mesh, ["m1", "m2", "m3", "lb"][n % 4], steps=4 + n % 3).residual
    ),
    "limbs": lambda mesh, split, n: split.bands(split.band_edges(2 + n % 3), keep_limbs=1.0),
    "filter": lambda mesh, split, n: split.filter(np.linspace(0, n, len(split.times) - 2)),
    "gains": lambda mesh, split, n: split.filter(lambda time: 1 + n * time),
    "flow": lambda mesh, split, n: (split.flow.states, split.flow.mean(VERTICES[:, 2] > 0.3)),
    "deform": lambda mesh, split, n: (
        spectral_tv.deform(mesh, ENDS, REST + (PULLED - REST) * (n + 1) / COUNT).vertices
    ),
    "pose": lambda mesh, split, n: spectral_tv.pose(mesh, ENDS, PULLED).rotations,
    "folds": lambda mesh, split, n: vars(spectral_tv.folds(mesh, wave(n))),
    "safe": lambda mesh, split, n: vars(spectral_tv.safe_displacement(mesh, wave(n))),
    "transfer": lambda mesh, split, n: spectral_tv.transfer(mesh, mesh).values(split.residual),
    "carry": lambda mesh, split, n: vars(
        spectral_tv.carry(mesh, wave(n)[np.newaxis], 1.1 * VERTICES[::7])
    ),
    "pickle": lambda mesh, split, n: pickle.loads(pickle.dumps(split)).residual,
    "copy": lambda mesh, split, n: copy.deepcopy(mesh).vertices,
}


@pytest.mark.parametrize("name", SHARED)
def test_one_object_in_many_threads_gives_what_it_gives_in_one(name, mesh):
    work = SHARED[name]
    apart = spectral_tv.Mesh(VERTICES, TRIANGLES)
    alone = spectral_tv.decompose(apart, steps=6)
    expected = [digest(work(apart, alone, number)) for number in range(COUNT)]
    split = spectral_tv.decompose(mesh, steps=6)
    for _ in range(ROUNDS):
        assert together(lambda number: digest(work(mesh, split, number))) == expected


def test_all_of_it_at_once_gives_what_each_gives(mesh):
    apart = spectral_tv.Mesh(VERTICES, TRIANGLES)
    alone = spectral_tv.decompose(apart, steps=6)
    works = [*SHARED.values()]
    expected = [digest(work(apart, alone, number)) for number, work in enumerate(works)]
    split = spectral_tv.decompose(mesh, steps=6)

    def turn(number: int) -> list[str]:
        order = np.roll(np.arange(len(works)), -2 * number)
        found = {int(k): digest(works[k](mesh, split, int(k))) for k in order}
        return [found[k] for k in range(len(works))]

    assert together(turn) == [expected] * COUNT


def steps(state: Any, number: int) -> list[np.ndarray]:
    """A session of a few moves."""
    moved = REST + (PULLED - REST) * (number + 1) / COUNT
    return [
        state.drag(moved).vertices,
        state.start_drag(PULLED).result().vertices,
        state.solve(moved).vertices,
        pickle.loads(pickle.dumps(state)).drag(PULLED).vertices,
        copy.copy(state).drag(PULLED).vertices,
    ]


@pytest.mark.parametrize("kind", KINDS)
def test_each_thread_with_a_state_of_its_own_gets_what_it_gets_alone(kind, mesh):
    expected = [digest(steps(KINDS[kind](mesh), number)) for number in range(COUNT)]
    assert together(lambda number: digest(steps(KINDS[kind](mesh), number))) == expected


@pytest.mark.parametrize("kind", ["deformer", "poser"])
def test_threads_that_share_a_state_take_turns(kind, mesh):
    """Whoever comes first: each shape goes exactly to where its own thread wants the handles."""
    state = KINDS[kind](mesh)

    def turn(number: int) -> None:
        moved = REST + (PULLED - REST) * (number + 1) / COUNT
        for _ in range(ROUNDS):
            shapes = [
                state.drag(moved),
                state.start_drag(moved).result(),
                state.solve(moved, tolerance=0.1),
                *state.solve_sequence([moved, moved], tolerance=0.1),
                pickle.loads(pickle.dumps(state)).drag(moved),
            ]
            for shape in shapes:
                np.testing.assert_allclose(shape.vertices[ENDS], moved, atol=1e-9)
            job = state.start_solve(moved)
            job.cancel()
            with contextlib.suppress(spectral_tv.Cancelled):  # it may have ended before
                np.testing.assert_allclose(job.result().vertices[ENDS], moved, atol=1e-9)

    together(turn)
    exact = state.solve(PULLED, tolerance=1e-6).vertices
    expected = KINDS[kind](mesh).solve(PULLED, tolerance=1e-6).vertices
    np.testing.assert_allclose(exact, expected, atol=0.02)


def test_a_job_gives_all_threads_the_same_object(mesh):
    for _ in range(20):
        job = spectral_tv.start_decompose(mesh, steps=3)
        found = together(lambda _, job=job: job.result())
        assert len({id(split) for split in found}) == 1
        assert job.done


def test_a_job_that_is_done_stays_so_while_threads_fetch_its_result(mesh):
    """Its result is a large array, which one of them makes."""
    values = np.tile(VERTICES[:120, 2].reshape(10, 12), (8, 8))
    for _ in range(10):
        job = spectral_tv.start_decompose_image(values, steps=3)
        while not job.done:
            pass

        def look(number: int, job: Any = job) -> bool:
            if number % 2:
                job.result()
            job.cancel()  # does nothing any more
            return all(job.done for _ in range(200))

        assert all(together(look))
        assert job.result() is job.result()


def test_a_job_that_is_cancelled_is_so_in_all_threads(mesh):
    for _ in range(5):
        job = spectral_tv.start_decompose(mesh, steps=20_000)

        def work(number: int, job: Any = job) -> bool:
            if number == 0:
                job.cancel()
            with pytest.raises(spectral_tv.Cancelled):
                job.result()
            return job.done

        assert all(together(work))


def test_threads_and_their_numbers_of_threads_do_not_mix(mesh):
    expected = digest(spectral_tv.decompose(mesh, steps=5).residual)

    def work(number: int) -> tuple[int, str]:
        with spectral_tv.use_threads(1 + number % 3):
            found = digest(spectral_tv.decompose(mesh, steps=5).residual)
            assert mesh.findings.open_edges == 0
            return spectral_tv.threads(), found

    assert together(work) == [(1 + number % 3, expected) for number in range(COUNT)]


def test_arrays_that_others_write_meanwhile_are_refused_or_taken(mesh):
    """What is read is a copy, which is checked: no result is of anything else."""
    split = spectral_tv.decompose(mesh, steps=4)
    gains, indices, moved = np.ones(3), ENDS.copy(), VERTICES.copy()
    done = threading.Event()

    def write() -> None:
        while not done.is_set():
            for value in (np.nan, 1.0):
                gains[1] = value
                moved[3] = value
            for value in (10**9, ENDS[0]):
                indices[0] = value

    writer = threading.Thread(target=write)
    writer.start()
    try:

        def read(_: int) -> None:
            for _ in range(50):
                with contextlib.suppress(spectral_tv.MeshError):
                    assert np.isfinite(split.filter(gains)).all()
                with contextlib.suppress(spectral_tv.MeshError):
                    assert np.isfinite(spectral_tv.Mesh(moved, TRIANGLES).vertices).all()
                with contextlib.suppress(spectral_tv.MeshError):
                    assert np.isfinite(spectral_tv.Deformer(mesh, indices).drag(REST).gap)

        together(read, 4)
    finally:
        done.set()
        writer.join()


def test_carrying_in_many_threads_leaves_warnings_as_they_are(mesh):
    """Which of them are shown is set for the process in most Pythons."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", spectral_tv.MeshWarning)
        filters = list(warnings.filters)
        together(lambda n: spectral_tv.carry(mesh, wave(n)[np.newaxis], 1.1 * VERTICES[::7]))
        assert warnings.filters == filters


@pytest.mark.skipif(
    not sysconfig.get_config_var("Py_GIL_DISABLED"), reason="this Python cannot do without a GIL"
)
def test_the_package_needs_no_gil():
    assert not sys._is_gil_enabled()
