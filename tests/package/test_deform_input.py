"""Deformation: what is refused and how, jobs, and what is left alone."""

from __future__ import annotations

import time

import numpy as np
import pytest
import spectral_tv
from pulled_sphere import COUNT, INDICES, TARGETS, TRIANGLES, VERTICES, changed
from pulled_sphere import large as large_sphere


@pytest.fixture(scope="module")
def mesh():
    return spectral_tv.Mesh(VERTICES, TRIANGLES)


@pytest.fixture(scope="module")
def large():
    return large_sphere()


BAD_CONSTRAINTS = {
    "none": ([], [], None, "there are no constraints"),
    "empty arrays": (np.empty(0, int), np.empty((0, 3)), None, "there are no constraints"),
    "all exact": (np.arange(162), VERTICES, None, "nothing is left to deform"),
    "beyond": (
        changed(INDICES, 2, 162),
        TARGETS,
        None,
        "vertex 162, but the vertices are 0 to 161",
    ),
    "negative": (changed(INDICES, 2, -1), TARGETS, None, "refers to vertex -1"),
    "contradiction": (
        np.append(INDICES, INDICES[4]),
        np.vstack([TARGETS, TARGETS[4] + [0, 0, 0.1]]),
        None,
        f"vertex {INDICES[4]} has two exact targets",
    ),
    "nan": (INDICES, changed(TARGETS, (3, 1), np.nan), None, f"target of vertex {INDICES[3]} is"),
    "infinite": (INDICES, changed(TARGETS, (5, 0), np.inf), None, f"of vertex {INDICES[5]} is not"),
    "one target less": (INDICES, TARGETS[1:], None, rf"\({COUNT}\), not {COUNT - 1}"),
    "flat targets": (INDICES, TARGETS[:, :2], None, r"targets must have the shape \(rows, 3\)"),
    "one row": (INDICES, TARGETS[0], None, r"targets must have the shape \(rows, 3\)"),
    "text": (INDICES, "up", None, "targets must be an array of numbers"),
    "complex": (INDICES, TARGETS * 1j, None, "targets must be an array of numbers, not of complex"),
    "a mask of another mesh": (np.arange(99) > 9, TARGETS, None, "99 truth values, .* 162 vert"),
    "a mask and other targets": (
        VERTICES[:, 2] > 0.9,
        TARGETS,
        None,
        rf"\({(VERTICES[:, 2] > 0.9).sum()}\), not {COUNT}",
    ),
    "fractions": (INDICES + 0.5, TARGETS, None, "indices must be an array of integers"),
    "a table": (INDICES[None], TARGETS, None, "indices must be a list"),
    "one weight less": (INDICES, TARGETS, np.ones(COUNT - 1), rf"\({COUNT}\), not {COUNT - 1}"),
    "a single weight": (INDICES, TARGETS, 0.5, "weights must be a list"),
    **{
        f"weight {weight}": (
            INDICES,
            TARGETS,
            changed(np.ones(COUNT), 6, weight),
            rf"weight of vertex {INDICES[6]} must be in \(0, 1\], not",
        )
        for weight in (0.0, -0.5, 1.5, np.nan, np.inf)
    },
}


@pytest.mark.parametrize("case", BAD_CONSTRAINTS)
def test_constraints_are_refused(mesh, case):
    indices, targets, weights, message = BAD_CONSTRAINTS[case]
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.deform(mesh, indices, targets, weights)
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.start_deform(mesh, indices, targets, weights).result()
    for call in ("drag", "solve", "start_solve"):
        with pytest.raises(spectral_tv.MeshError, match=message):
            outcome = getattr(spectral_tv.Deformer(mesh, indices, weights), call)(targets)
            outcome.result()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"softness": -0.1}, "softness must be a length, 0 or more, not -0.1"),
        ({"softness": np.nan}, "softness must be a length, 0 or more, not NaN"),
        ({"softness": np.inf}, "softness must be a length"),
        *(
            ({"softness": 0.1, "algorithm": name}, "softness is for the convex algorithm only")
            for name in ("paper", "harmonic", "biharmonic", "arap")
        ),
        *(({"tolerance": x}, "tolerance must be between 0 and 1") for x in (0, 1, -1e-3, np.nan)),
        ({"tolerance": 2, "algorithm": "arap"}, "tolerance must be between 0 and 1"),
        ({"algorithm": "magic"}, 'algorithm must be .* not "magic"'),
    ],
)
def test_settings_are_refused(mesh, arguments, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.deform(mesh, INDICES, TARGETS, **arguments)
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.start_deform(mesh, INDICES, TARGETS, **arguments).result()


def test_a_deformer_refuses_bad_targets_and_goes_on(mesh):
    deformer = spectral_tv.Deformer(mesh, INDICES)
    before = deformer.solve(TARGETS)
    for targets in (changed(TARGETS, (3, 1), np.nan), TARGETS[1:]):
        for call in (deformer.drag, deformer.solve, lambda t: deformer.start_solve(t).result()):
            with pytest.raises(spectral_tv.MeshError):
                call(targets)
    with pytest.raises(spectral_tv.MeshError, match="tolerance"):
        deformer.solve(TARGETS, tolerance=0)
    with pytest.raises(spectral_tv.MeshError, match="softness"):
        spectral_tv.Deformer(mesh, INDICES, softness=-1)
    after = deformer.solve(TARGETS)
    assert after.total_variation == pytest.approx(before.total_variation, rel=1e-3)


def test_the_same_target_twice_is_no_contradiction(mesh):
    twice = spectral_tv.deform(mesh, np.tile(INDICES, 2), np.tile(TARGETS, (2, 1)))
    once = spectral_tv.deform(mesh, INDICES, TARGETS)
    np.testing.assert_allclose(twice.vertices, once.vertices, atol=1e-12)


def test_one_constraint_takes_everything_along(mesh):
    result = spectral_tv.deform(mesh, [7], [VERTICES[7] + [1, 2, 3]])
    np.testing.assert_allclose(result.vertices, VERTICES + np.array([1, 2, 3]), atol=1e-12)


def test_shapes_and_words(mesh):
    result = spectral_tv.deform(mesh, INDICES, TARGETS)
    assert result.vertices.shape == VERTICES.shape
    assert result.unconstrained.shape == (0,)
    assert isinstance(result.total_variation, float)
    assert isinstance(result.gap, float)
    assert result.iterations > 1
    assert f"iterations={result.iterations}" in repr(result)


def test_lists_and_narrow_types_will_do(mesh):
    expected = spectral_tv.deform(mesh, INDICES, TARGETS, np.full(COUNT, 0.5))
    for convert in (np.ndarray.tolist, np.asfortranarray, lambda a: np.repeat(a, 2, axis=0)[::2]):
        result = spectral_tv.deform(
            mesh, convert(INDICES), convert(TARGETS), convert(np.full(COUNT, 0.5))
        )
        np.testing.assert_array_equal(result.vertices, expected.vertices)
    narrow = spectral_tv.deform(
        mesh, INDICES.astype(np.uint16), TARGETS.astype(np.float32), [0.5] * COUNT
    )
    np.testing.assert_allclose(narrow.vertices, expected.vertices, atol=1e-2)


@pytest.mark.parametrize("algorithm", ["convex", "paper", "harmonic", "biharmonic", "arap"])
def test_inputs_and_results_are_independent(mesh, algorithm):
    indices, targets, weights = INDICES.copy(), TARGETS.copy(), np.full(COUNT, 0.9)
    for array in (indices, targets, weights):
        array.setflags(write=False)
    result = spectral_tv.deform(mesh, indices, targets, weights, algorithm=algorithm)
    vertices = result.vertices.copy()
    result.vertices[:] = 0
    np.testing.assert_array_equal(result.vertices, vertices)
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    again = spectral_tv.deform(mesh, indices, targets, weights, algorithm=algorithm)
    np.testing.assert_array_equal(again.vertices, vertices)


def test_an_earlier_result_of_a_deformer_stays(mesh):
    deformer = spectral_tv.Deformer(mesh, INDICES)
    first = deformer.drag(TARGETS)
    vertices = first.vertices
    deformer.drag(VERTICES[INDICES] + 2 * (TARGETS - VERTICES[INDICES]))
    np.testing.assert_array_equal(first.vertices, vertices)


def test_progress_rises_to_one(large):
    seen = []
    spectral_tv.deform(*large, tolerance=1e-6, progress=seen.append)
    assert len(seen) > 2
    assert seen == sorted(seen)
    assert 0 <= seen[0] < 1
    assert seen[-1] == 1


def test_an_exception_from_progress_ends_the_work(large):
    def stop(fraction):
        raise RuntimeError("enough")

    mesh, indices, targets = large
    with pytest.raises(RuntimeError, match="enough"):
        spectral_tv.deform(mesh, indices, targets, tolerance=1e-12, progress=stop)
    deformer = spectral_tv.Deformer(mesh, indices)
    with pytest.raises(RuntimeError, match="enough"):
        deformer.solve(targets, tolerance=1e-12, progress=stop)
    assert deformer.solve(targets).gap <= 1e-3


@pytest.mark.parametrize("algorithm", ["convex", "paper", "arap"])
def test_a_job_gives_what_the_call_gives(mesh, algorithm):
    job = spectral_tv.start_deform(mesh, INDICES, TARGETS, algorithm=algorithm)
    assert 0 <= job.progress <= 1
    result = job.result()
    assert job.done
    assert job.progress == 1
    assert job.result() is result
    expected = spectral_tv.deform(mesh, INDICES, TARGETS, algorithm=algorithm)
    np.testing.assert_array_equal(result.vertices, expected.vertices)


@pytest.mark.parametrize("algorithm", ["convex", "paper", "arap"])
def test_a_cancelled_job_says_so(large, algorithm):
    mesh, indices, targets = large
    job = spectral_tv.start_deform(mesh, indices, targets, tolerance=1e-12, algorithm=algorithm)
    assert not job.done
    job.cancel()
    with pytest.raises(spectral_tv.Cancelled):
        job.result()
    assert job.done


def test_a_deformer_goes_on_after_a_cancelled_job(large):
    mesh, indices, targets = large
    deformer = spectral_tv.Deformer(mesh, indices)
    job = deformer.start_solve(targets, tolerance=1e-12)
    assert not job.done
    job.cancel()
    with pytest.raises(spectral_tv.Cancelled):
        job.result()
    solved = deformer.solve(targets)
    assert solved.gap <= 1e-3
    fresh = spectral_tv.deform(*large)
    assert solved.total_variation == pytest.approx(fresh.total_variation, rel=1e-3)
    again = deformer.start_solve(targets, tolerance=1e-4).result()
    assert again.gap <= 1e-4


def test_calls_wait_for_a_running_job(large):
    mesh, indices, targets = large
    deformer = spectral_tv.Deformer(mesh, indices)
    job = deformer.start_solve(targets, tolerance=1e-4)
    while job.progress == 0 and not job.done:
        time.sleep(1e-3)
    dragged = deformer.drag(targets)
    assert dragged.total_variation == pytest.approx(job.result().total_variation, rel=5e-3)
