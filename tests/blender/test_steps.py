"""Jobs that follow one another: progress, cancelling, errors, as one job."""

from __future__ import annotations

import time
from importlib import import_module

import numpy as np
import pytest
import spectral_tv
from shapes import dumbbell

MESH = spectral_tv.Mesh(*dumbbell(n_around=16, n_along=30))


def steps_of(generator):
    return import_module("spectral_tv.jobs.steps").Steps(generator)


def flow(steps: int) -> spectral_tv.Job:
    return spectral_tv.start_decompose(MESH, "m1", steps=steps)


def two(second: int = 4):
    first = yield flow(4), 0.5
    other = yield flow(second), 1.0
    return first, other


def test_the_result_is_what_the_generator_makes_of_all_results():
    told = []
    first, other = steps_of(two(6)).result(told.append)
    assert len(first.times) == 5 and len(other.times) == 7
    assert told == sorted(told) and told[-1] == 1


def test_it_can_be_polled():
    steps, seen = steps_of(two()), []
    while not steps.done:
        seen.append(steps.progress)
        time.sleep(0.001)
    assert seen == sorted(seen) and steps.progress == 1
    assert len(steps.result()) == 2


def test_cancelling_ends_the_one_that_runs():
    steps = steps_of(two(second=100_000))
    while steps.progress <= 0.5:
        assert not steps.done
    steps.cancel()
    with pytest.raises(spectral_tv.Cancelled):
        steps.result()
    assert steps.done


def test_cancelling_between_two_jobs_starts_no_other():
    def once():
        yield flow(2), 0.5
        raise AssertionError("it went on")

    steps = steps_of(once())
    while steps.progress < 0.5:
        time.sleep(0.001)
    steps.cancel()
    with pytest.raises(spectral_tv.Cancelled):
        steps.result()


def test_an_error_is_that_of_the_job_that_failed():
    def refused():
        yield flow(4), 0.5
        yield spectral_tv.start_deform(MESH, [0], np.full((1, 3), np.nan)), 1.0

    with pytest.raises(spectral_tv.MeshError):
        steps_of(refused()).result()


def test_a_job_that_fails_ends_them():
    """It fails in its thread, and what comes later is not started."""

    def failing():
        index = np.arange(len(MESH.vertices))
        yield spectral_tv.start_deform(MESH, index, MESH.vertices), 0.5
        raise AssertionError("it went on")

    with pytest.raises(spectral_tv.MeshError, match="nothing is left to deform"):
        steps = steps_of(failing())
        while not steps.done:
            time.sleep(0.001)
        steps.result()


def test_jobs_in_turn_give_all_results():
    in_turn = import_module("spectral_tv.jobs.steps").in_turn
    steps = steps_of(in_turn([lambda: flow(4), lambda: flow(6)]))
    seen = []
    while not steps.done:
        seen.append(steps.progress)
        time.sleep(0.001)
    assert seen == sorted(seen) and steps.progress == 1
    assert [len(each.times) for each in steps.result()] == [5, 7]


def together(first, *others):
    return import_module("spectral_tv.jobs.together").Together(first, *others)


def test_jobs_at_the_same_time_give_the_result_of_the_first():
    told = []
    jobs = together(flow(4), flow(6))
    assert len(jobs.result(told.append).times) == 5
    assert jobs.done and jobs.progress == 1 and told[-1] == 1


def test_jobs_at_the_same_time_are_cancelled_together():
    endless = flow(100_000), flow(100_000)
    jobs = together(*endless)
    assert not jobs.done
    jobs.cancel()
    with pytest.raises(spectral_tv.Cancelled):
        jobs.result()
    while not jobs.done:
        time.sleep(0.001)
    assert all(each.done for each in endless)
