"""Posing: what is refused and how, jobs, and what is left alone."""

from __future__ import annotations

import inspect
import time

import numpy as np
import pytest
import spectral_tv
from pulled_sphere import COUNT, HIGH, INDICES, LOW, TARGETS, TRIANGLES, VERTICES, changed
from pulled_sphere import large as large_sphere

BODIES = np.repeat([-1, 0], [len(LOW), len(HIGH)])


@pytest.fixture(scope="module")
def mesh():
    return spectral_tv.Mesh(VERTICES, TRIANGLES)


@pytest.fixture(scope="module")
def large():
    return large_sphere()


BAD_HANDLES = {
    "none": ([], [], {}, "there are no constraints"),
    "all exact": (np.arange(162), VERTICES, {}, "nothing is left to deform"),
    "beyond": (changed(INDICES, 2, 162), TARGETS, {}, "vertex 162, but the vertices are 0 to 161"),
    "negative": (changed(INDICES, 2, -1), TARGETS, {}, "refers to vertex -1"),
    "contradiction": (
        np.append(INDICES, INDICES[4]),
        np.vstack([TARGETS, TARGETS[4] + [0, 0, 0.1]]),
        {},
        f"vertex {INDICES[4]} has two exact targets",
    ),
    "nan": (INDICES, changed(TARGETS, (3, 1), np.nan), {}, f"target of vertex {INDICES[3]} is"),
    "infinite": (INDICES, changed(TARGETS, (5, 0), np.inf), {}, f"of vertex {INDICES[5]} is not"),
    "one target less": (INDICES, TARGETS[1:], {}, rf"\({COUNT}\), not {COUNT - 1}"),
    "flat targets": (INDICES, TARGETS[:, :2], {}, r"targets must have the shape \(rows, 3\)"),
    "text": (INDICES, "up", {}, "targets must be an array of numbers"),
    "a mask of another mesh": (np.arange(99) > 9, TARGETS, {}, "99 truth values, .* 162 vert"),
    "fractions": (INDICES + 0.5, TARGETS, {}, "indices must be an array of integers"),
    "one weight less": (
        INDICES,
        TARGETS,
        {"weights": np.ones(COUNT - 1)},
        rf"\({COUNT}\), not {COUNT - 1}",
    ),
    "a single weight": (INDICES, TARGETS, {"weights": 0.5}, "weights must be a list"),
    **{
        f"weight {weight}": (
            INDICES,
            TARGETS,
            {"weights": changed(np.ones(COUNT), 6, weight)},
            rf"weight of vertex {INDICES[6]} must be in \(0, 1\], not",
        )
        for weight in (0.0, -0.5, 1.5, np.nan, np.inf)
    },
    "one body less": (
        INDICES,
        TARGETS,
        {"bodies": BODIES[1:]},
        rf"bodies must have one number per constrained vertex \({COUNT}\), not {COUNT - 1}",
    ),
    "a body below -1": (
        INDICES,
        TARGETS,
        {"bodies": changed(BODIES, 3, -2)},
        r"bodies\[3\] must be .1 or more, not -2",
    ),
    "a mask of bodies": (
        INDICES,
        TARGETS,
        {"bodies": BODIES >= 0},
        "bodies must be an array of integers, not of bool",
    ),
    "broken bodies": (
        INDICES,
        TARGETS,
        {"bodies": BODIES + 0.5},
        "bodies must be an array of integers, not of float64",
    ),
    "a table of bodies": (INDICES, TARGETS, {"bodies": BODIES[None]}, "bodies must be a list"),
    "a vertex in two bodies": (
        np.append(INDICES, HIGH[0]),
        np.vstack([TARGETS, TARGETS[len(LOW)]]),
        {"bodies": np.append(BODIES, 1)},
        f"vertex {HIGH[0]} is in two free bodies",
    ),
}


@pytest.mark.parametrize("case", BAD_HANDLES)
def test_handles_are_refused(mesh, case):
    indices, targets, options, message = BAD_HANDLES[case]
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.pose(mesh, indices, targets, **options)
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.start_pose(mesh, indices, targets, **options).result()
    for call in ("drag", "solve", "start_solve"):
        with pytest.raises(spectral_tv.MeshError, match=message):
            outcome = getattr(spectral_tv.Poser(mesh, indices, **options), call)(targets)
            outcome.result()


BAD_PARAMETERS = [
    (name, value, f"{name} must be a number from 0 to 1e6, not")
    for name in ("joint_softness", "stiffness", "stillness")
    for value in (-0.1, np.nan, np.inf, 1e300)
]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        *BAD_PARAMETERS,
        *(("tolerance", x, "tolerance must be between 0 and 1") for x in (0, 1, -1e-3, np.nan)),
    ],
)
def test_settings_are_refused(mesh, name, value, message):
    for call in (
        spectral_tv.pose,
        lambda *given, **named: spectral_tv.start_pose(*given, **named).result(),
    ):
        with pytest.raises(spectral_tv.MeshError, match=message):
            call(mesh, INDICES, TARGETS, **{name: value})


@pytest.mark.parametrize(("name", "value", "message"), BAD_PARAMETERS)
def test_a_poser_refuses_parameters_and_keeps_those_it_has(mesh, name, value, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.Poser(mesh, INDICES, **{name: value})
    poser = spectral_tv.Poser(mesh, INDICES, joint_softness=0.5, stiffness=0.01, stillness=1)
    others = {"joint_softness": 2.0, "stiffness": 0.1, "stillness": 0.0}
    with pytest.raises(spectral_tv.MeshError, match=message):
        poser.set_parameters(**{**others, name: value})
    assert (poser.joint_softness, poser.stiffness, poser.stillness) == (0.5, 0.01, 1)


def test_parameters_that_are_not_named_stay(mesh):
    poser = spectral_tv.Poser(mesh, INDICES, stiffness=0.01)
    poser.set_parameters(joint_softness=0.25)
    assert (poser.joint_softness, poser.stiffness) == (0.25, 0.01)
    poser.set_parameters(stillness=0)
    assert (poser.joint_softness, poser.stiffness, poser.stillness) == (0.25, 0.01, 0)
    with pytest.raises(TypeError, match="stiffness must be a number"):
        poser.set_parameters(stiffness="soft")
    with pytest.raises(AttributeError):
        poser.stiffness = 3


def test_parameters_that_are_set_are_those_of_the_next_pose(mesh):
    others = {"joint_softness": 0.3, "stiffness": 0.003, "stillness": 0.1}
    poser = spectral_tv.Poser(mesh, INDICES)
    poser.set_parameters(**others)
    expected = spectral_tv.pose(mesh, INDICES, TARGETS, **others)
    np.testing.assert_array_equal(poser.solve(TARGETS).vertices, expected.vertices)


def test_defaults_are_those_of_the_library_everywhere(mesh):
    poser = spectral_tv.Poser(mesh, INDICES)
    once = inspect.signature(spectral_tv.pose).parameters
    often = inspect.signature(spectral_tv.Poser).parameters
    for name in ("joint_softness", "stiffness", "stillness"):
        known = spectral_tv._native._POSING[name]
        assert once[name].default == often[name].default == getattr(poser, name) == known
    for method in ("solve", "solve_sequence", "start_solve", "start_solve_sequence"):
        default = inspect.signature(getattr(poser, method)).parameters["tolerance"].default
        assert default == once["tolerance"].default == spectral_tv._native._POSING["tolerance"]


def test_a_poser_refuses_bad_targets_and_goes_on(mesh):
    poser = spectral_tv.Poser(mesh, INDICES)
    before = poser.solve(TARGETS)
    for targets in (changed(TARGETS, (3, 1), np.nan), TARGETS[1:]):
        for call in (poser.drag, poser.solve, lambda t: poser.start_solve(t).result()):
            with pytest.raises(spectral_tv.MeshError):
                call(targets)
        with pytest.raises(spectral_tv.MeshError):
            poser.solve_sequence([TARGETS, targets])
    with pytest.raises(spectral_tv.MeshError, match="tolerance"):
        poser.solve(TARGETS, tolerance=0)
    after = poser.solve(TARGETS)
    assert after.energy == pytest.approx(before.energy, rel=1e-3)


def test_the_same_target_twice_is_no_contradiction(mesh):
    twice = spectral_tv.pose(
        mesh, np.tile(INDICES, 2), np.tile(TARGETS, (2, 1)), bodies=np.tile(BODIES, 2)
    )
    once = spectral_tv.pose(mesh, INDICES, TARGETS, bodies=BODIES)
    np.testing.assert_allclose(twice.vertices, once.vertices, atol=1e-9)


def test_a_mask_means_its_vertices(mesh):
    mask = np.zeros(len(VERTICES), bool)
    mask[INDICES] = True
    order = np.argsort(INDICES)
    expected = spectral_tv.pose(mesh, INDICES[order], TARGETS[order], bodies=BODIES[order])
    for meant in (mask, mask.tolist(), mask.astype(int)):
        posed = spectral_tv.pose(mesh, meant, TARGETS[order], bodies=BODIES[order])
        np.testing.assert_array_equal(posed.vertices, expected.vertices)


def test_shapes_and_words(mesh):
    posed = spectral_tv.pose(mesh, INDICES, TARGETS)
    assert posed.vertices.shape == VERTICES.shape
    assert posed.rotations.shape == (len(VERTICES), 4)
    np.testing.assert_allclose(np.linalg.norm(posed.rotations, axis=1), 1, rtol=1e-12)
    assert posed.unconstrained.shape == (0,)
    assert all(isinstance(getattr(posed, n), float) for n in ("energy", "decrement", "movement"))
    assert posed.iterations > 1
    assert f"iterations={posed.iterations}" in repr(posed)
    assert repr(spectral_tv.Poser(mesh, INDICES)) == f"Poser({COUNT} constraints on 162 vertices)"


def test_lists_and_narrow_types_will_do(mesh):
    weights = np.full(COUNT, 0.5)
    expected = spectral_tv.pose(mesh, INDICES, TARGETS, weights, BODIES)
    for convert in (np.ndarray.tolist, np.asfortranarray, lambda a: np.repeat(a, 2, axis=0)[::2]):
        posed = spectral_tv.pose(
            mesh, convert(INDICES), convert(TARGETS), convert(weights), convert(BODIES)
        )
        np.testing.assert_array_equal(posed.vertices, expected.vertices)
    narrow = spectral_tv.pose(
        mesh,
        INDICES.astype(np.uint16),
        TARGETS.astype(np.float32),
        [0.5] * COUNT,
        BODIES.astype(np.int8),
    )
    np.testing.assert_allclose(narrow.vertices, expected.vertices, atol=1e-2)


def test_bodies_of_minus_one_alone_are_as_none(mesh):
    found = spectral_tv.pose(mesh, INDICES, TARGETS, bodies=[-1] * COUNT)
    expected = spectral_tv.pose(mesh, INDICES, TARGETS)
    np.testing.assert_array_equal(found.vertices, expected.vertices)


def test_inputs_and_results_are_independent(mesh):
    given = [INDICES.copy(), TARGETS.copy(), np.full(COUNT, 0.9), BODIES.copy()]
    for array in given:
        array.setflags(write=False)
    posed = spectral_tv.pose(mesh, *given)
    vertices, rotations = posed.vertices.copy(), posed.rotations.copy()
    posed.vertices[:] = posed.rotations[:] = 0
    np.testing.assert_array_equal(posed.vertices, vertices)
    np.testing.assert_array_equal(posed.rotations, rotations)
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    np.testing.assert_array_equal(spectral_tv.pose(mesh, *given).vertices, vertices)


def test_an_earlier_result_of_a_poser_stays(mesh):
    poser = spectral_tv.Poser(mesh, INDICES)
    first = poser.drag(TARGETS)
    vertices, rotations = first.vertices, first.rotations
    poser.drag(VERTICES[INDICES] + 2 * (TARGETS - VERTICES[INDICES]))
    np.testing.assert_array_equal(first.vertices, vertices)
    np.testing.assert_array_equal(first.rotations, rotations)


def test_progress_rises_to_one(large):
    seen = []
    spectral_tv.pose(*large, tolerance=1e-9, progress=seen.append)
    assert len(seen) > 2
    assert seen == sorted(seen)
    assert 0 <= seen[0] < 1
    assert seen[-1] == 1


def test_an_exception_from_progress_ends_the_work(large):
    def stop(fraction):
        raise RuntimeError("enough")

    mesh, indices, targets = large
    with pytest.raises(RuntimeError, match="enough"):
        spectral_tv.pose(mesh, indices, targets, tolerance=1e-12, progress=stop)
    poser = spectral_tv.Poser(mesh, indices)
    for call in (poser.solve, lambda t, **named: poser.solve_sequence([t] * 9, **named)):
        with pytest.raises(RuntimeError, match="enough"):
            call(targets, tolerance=1e-12, progress=stop)
    assert poser.solve(targets).decrement <= 1e-4


def test_a_job_gives_what_the_call_gives(mesh):
    job = spectral_tv.start_pose(mesh, INDICES, TARGETS, bodies=BODIES)
    assert 0 <= job.progress <= 1
    result = job.result()
    assert job.done
    assert job.progress == 1
    assert job.result() is result
    expected = spectral_tv.pose(mesh, INDICES, TARGETS, bodies=BODIES)
    np.testing.assert_array_equal(result.vertices, expected.vertices)


def test_a_cancelled_job_says_so_and_a_poser_goes_on(large):
    mesh, indices, targets = large
    poser = spectral_tv.Poser(mesh, indices)
    for start in (
        lambda: spectral_tv.start_pose(mesh, indices, targets, tolerance=1e-12),
        lambda: poser.start_solve(targets, tolerance=1e-12),
        lambda: poser.start_solve_sequence([targets] * 99, tolerance=1e-12),
    ):
        job = start()
        assert not job.done
        job.cancel()
        with pytest.raises(spectral_tv.Cancelled):
            job.result()
        assert job.done
    solved = poser.solve(targets)
    assert solved.decrement <= 1e-4
    assert solved.energy == pytest.approx(spectral_tv.pose(*large).energy, rel=1e-2)


@pytest.mark.parametrize("delay", [0, 0.01, 0.03, 0.1])
def test_a_poser_whose_work_was_cancelled_while_all_moved_returns_to_rest(large, delay):
    """What most handles have in common must not be added twice."""
    mesh, indices, _ = large
    rest = mesh.vertices[indices]
    poser = spectral_tv.Poser(mesh, indices)
    job = poser.start_solve(rest + np.array([5, 0, 0]), tolerance=1e-12)
    time.sleep(delay)
    job.cancel()
    while not job.done:
        time.sleep(1e-3)
    np.testing.assert_allclose(poser.solve(rest).vertices, mesh.vertices, rtol=0, atol=1e-3)


def test_calls_wait_for_a_running_job(large):
    mesh, indices, targets = large
    poser = spectral_tv.Poser(mesh, indices)
    job = poser.start_solve(targets)
    poser.set_parameters(stiffness=0.1)
    assert poser.stiffness == 0.1
    expected = spectral_tv.pose(mesh, indices, targets)
    np.testing.assert_array_equal(job.result().vertices, expected.vertices)
