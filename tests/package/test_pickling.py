"""Everything can be pickled and copied, to the bit, but jobs; what is read is checked."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
import threading
from dataclasses import fields, is_dataclass

import numpy as np
import pytest
import spectral_tv
from shapes import bumpy_sphere, grid

VERTICES, TRIANGLES = bumpy_sphere(2)
MESH = spectral_tv.Mesh(VERTICES, TRIANGLES)
UPPER = VERTICES[:, 2] > 0.3
ENDS = np.flatnonzero(np.abs(VERTICES[:, 2]) > 0.7)
TARGETS = VERTICES[ENDS] + np.where(VERTICES[ENDS, 2:] > 0, 1, 0) * [0.4, 0.1, 0.2]
TIMES = spectral_tv.graded_times(1e-4, 1e-1, 6)
PROTOCOLS = range(2, pickle.HIGHEST_PROTOCOL + 1)


def welded():
    soup = VERTICES[TRIANGLES].reshape(-1, 3)
    soup = np.vstack([soup, [[np.nan] * 3]])
    triangles = np.arange(3 * len(TRIANGLES)).reshape(-1, 3)
    with pytest.warns(spectral_tv.MeshWarning):
        return spectral_tv.Mesh(soup, triangles, weld=0.0, broken="drop")


def deformer():
    made = spectral_tv.Deformer(MESH, ENDS, np.full(len(ENDS), 0.9), softness=0.1)
    made.solve(TARGETS)
    return made


def poser():
    bodies = np.where(VERTICES[ENDS, 2] > 0, 3, -1)
    made = spectral_tv.Poser(MESH, ENDS, np.full(len(ENDS), 0.9), bodies, stiffness=0.01)
    made.solve(TARGETS)
    made.set_parameters(joint_softness=0.5)
    return made


# What goes on from where it was.
KEPT = {"deformer": deformer, "poser": poser}
FLOWS = {
    "scalar": lambda: spectral_tv.flow(MESH, VERTICES[:, 2], TIMES),
    "one channel": lambda: spectral_tv.flow(MESH, VERTICES[:, 2:], TIMES),
    "heat": lambda: spectral_tv.flow(MESH, VERTICES, TIMES, "heat"),
    "one step": lambda: spectral_tv.flow(MESH, VERTICES, [0.0, 0.1]),
    "image": lambda: spectral_tv.decompose_image(VERTICES[:120, 2].reshape(10, 12), steps=5),
    "colors": lambda: spectral_tv.decompose_image(VERTICES[:120].reshape(12, 10, 3), steps=5),
    **{
        f"{method} by {solver}": lambda method=method, solver=solver: spectral_tv.decompose(
            MESH, method, steps=5, solver=solver
        )
        for method in ("m1", "m2", "m3", "naive", "lb", "displacement")
        for solver in ("cholesky", "multigrid")
    },
    "m3 on a base": lambda: spectral_tv.decompose(MESH, "m3", steps=5, metric="base"),
}
OTHERS = {
    "mesh": lambda: MESH,
    "welded mesh": welded,
    "findings": lambda: welded().findings,
    "accuracy": lambda: spectral_tv.accuracy(MESH, steps=[4, 6], bands=2, refinement=2),
    "deformation": lambda: spectral_tv.deform(MESH, ENDS, TARGETS),
    "pose": lambda: spectral_tv.pose(MESH, ENDS, TARGETS),
    "drag": lambda: spectral_tv.Poser(MESH, ENDS).drag(TARGETS),
    "eigenset test": lambda: spectral_tv.eigenset_test(MESH, UPPER),
    "folds": lambda: spectral_tv.folds(MESH, -2 * VERTICES * [0, 0, 1]),
    "safe displacement": lambda: spectral_tv.safe_displacement(MESH, 2 * VERTICES[:, ::-1]),
    "estimate": lambda: spectral_tv.estimate(MESH),
}


def round_trips(thing):
    for protocol in PROTOCOLS:
        yield pickle.loads(pickle.dumps(thing, protocol))
    buffers: list[pickle.PickleBuffer] = []
    head = pickle.dumps(thing, 5, buffer_callback=buffers.append)
    yield pickle.loads(head, buffers=buffers)
    yield copy.copy(thing)
    yield copy.deepcopy(thing)
    yield copy.deepcopy([thing])[0]


def properties(thing):
    names = [
        name
        for name, member in vars(type(thing)).items()
        if type(member).__name__ == "getset_descriptor"
    ]
    if is_dataclass(thing):
        names = [part.name for part in fields(thing)]
    values = {name: getattr(thing, name) for name in names}
    assert values
    meshes = [name for name, value in values.items() if isinstance(value, spectral_tv.Mesh)]
    for name in meshes:
        values |= {f"{name}.{part}": each for part, each in properties(values.pop(name)).items()}
    return {
        name: repr(value) if isinstance(value, spectral_tv.Flow) else value
        for name, value in values.items()
    }


def assert_same(one, other):
    assert type(one) is type(other)
    assert repr(one) == repr(other)
    expected = properties(one)
    for name, value in properties(other).items():
        np.testing.assert_array_equal(value, expected[name], strict=True, err_msg=name)


@pytest.mark.parametrize("name", OTHERS)
def test_a_round_trip_gives_the_same_bits(name):
    thing = OTHERS[name]()
    for again in round_trips(thing):
        assert_same(thing, again)


@pytest.mark.parametrize("name", FLOWS)
def test_a_round_trip_of_a_flow_gives_the_same_bits(name):
    flow = FLOWS[name]()
    for again in round_trips(flow):
        assert_same(flow, again)
        count = len(flow.spectrum)
        gains = np.linspace(-1, 2, count)
        np.testing.assert_array_equal(again.filter(gains), flow.filter(gains))
        edges = [0, *flow.times[1:]]
        np.testing.assert_array_equal(again.bands(edges), flow.bands(edges))
        if isinstance(flow, spectral_tv.Decomposition):
            assert_same(again.flow, flow.flow)
        else:
            weights = np.arange(len(pickled_masses(flow)))
            np.testing.assert_array_equal(again.mean(weights), flow.mean(weights))


def pickled_masses(flow):
    _, (_, _, _, parts) = flow.__reduce__()
    return parts["masses"]


@pytest.mark.parametrize("name", KEPT)
def test_a_deformer_or_poser_goes_on_from_where_it_was(name):
    made = KEPT[name]()
    others = list(round_trips(made))
    expected = made.drag(1.1 * TARGETS)
    for other in others:
        assert repr(other) == repr(made)
        assert_same(other.drag(1.1 * TARGETS), expected)


def test_a_poser_keeps_its_parameters():
    for other in round_trips(poser()):
        assert (other.joint_softness, other.stiffness) == (0.5, 0.01)
        assert other.stillness == spectral_tv.Poser(MESH, ENDS).stillness


@pytest.mark.parametrize("kind", [spectral_tv.Deformer, spectral_tv.Poser])
def test_what_was_not_used_goes_on_from_rest(kind):
    for weights in (None, np.full(len(ENDS), 0.5)):
        made = kind(MESH, ENDS, weights)
        again = pickle.loads(pickle.dumps(made))
        assert_same(again.solve(TARGETS), made.solve(TARGETS))


@pytest.mark.parametrize("name", KEPT)
def test_copies_of_a_deformer_or_poser_are_apart(name):
    made = KEPT[name]()
    other = copy.copy(made)
    expected = copy.copy(made).solve(0.9 * TARGETS)
    made.solve(3 * TARGETS)
    assert_same(other.solve(0.9 * TARGETS), expected)


@pytest.mark.parametrize("kind", [spectral_tv.Deformer, spectral_tv.Poser])
def test_a_deformer_or_poser_is_copied_once_its_work_has_ended(kind):
    made = kind(MESH, ENDS)
    job = made.start_solve_sequence([TARGETS * scale for scale in np.linspace(1, 2, 50)])
    again = copy.copy(made)
    job.cancel()  # too late
    last = job.result()[-1]
    np.testing.assert_allclose(last.vertices[ENDS], 2 * TARGETS, atol=1e-9)
    assert_same(again.solve(2 * TARGETS), made.solve(2 * TARGETS))


def test_what_shares_a_mesh_shares_it_after_a_round_trip():
    first, second = (spectral_tv.Deformer(MESH, ENDS) for _ in range(2))
    alone = len(pickle.dumps(first))
    assert len(pickle.dumps([first, second, MESH])) < 1.6 * alone


def test_a_decomposition_takes_up_little_more_than_its_states():
    # Where they are not exact, increments but the last three are in 16 bits, with arrays of units.
    short = 3 * 4 + 27 * 2
    for solver, numbers in (("cholesky", 30 * 8), ("single", short), ("multigrid", short)):
        split = spectral_tv.decompose(MESH, steps=30, solver=solver)
        size = len(pickle.dumps(split, 5))
        states = 3 * len(VERTICES) * (8 + numbers)
        assert states < size < 1.1 * states + 8 * len(VERTICES) + 10_000


def test_errors_keep_what_they_name():
    broken = VERTICES.copy()
    broken[[3, 8], 1] = np.nan
    with pytest.raises(spectral_tv.MeshError) as caught:
        spectral_tv.Mesh(broken, TRIANGLES)
    for again in round_trips(caught.value):
        assert type(again) is spectral_tv.MeshError
        assert str(again) == str(caught.value)
        np.testing.assert_array_equal(again.vertices, [3, 8])
        assert len(again.faces) == 0
    job = spectral_tv.start_decompose(MESH, steps=100_000)
    job.cancel()
    with pytest.raises(spectral_tv.Cancelled) as cancelled:
        job.result()
    assert all(str(again) == "cancelled" for again in round_trips(cancelled.value))


def test_a_job_is_refused_and_the_message_says_what_to_pickle():
    job = spectral_tv.start_decompose(MESH, steps=4)
    for take in (pickle.dumps, copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match=r"a Job cannot be pickled .* take its result\(\)"):
            take(job)
    assert pickle.loads(pickle.dumps(job.result())).times[0] == 0


def test_another_process_reads_what_this_one_wrote():
    split = spectral_tv.decompose(MESH, steps=4)
    code = "import pickle, sys; sys.stdout.buffer.write(pickle.load(sys.stdin.buffer).residual)"
    done = subprocess.run(
        [sys.executable, "-c", code], input=pickle.dumps(split), capture_output=True, check=True
    )
    assert done.stdout == split.residual.tobytes()


def test_another_format_is_refused_by_name():
    restore, (name, form, version, parts) = MESH.__reduce__()
    assert (name, version) == ("Mesh", spectral_tv.__version__)
    expected = f"pickled by spectral_tv 9.1 in format {form + 1}, but .* reads format {form} only"
    with pytest.raises(spectral_tv.MeshError, match=expected):
        restore(name, form + 1, "9.1", parts)
    with pytest.raises(spectral_tv.MeshError, match='pickles no "Job"'):
        restore("Job", form, version, {})


# What holds numbers alone is a dataclass, of whose fields nothing else is made.
CHECKED = {name: OTHERS[name] for name in ("mesh", "welded mesh")}
THINGS = {**FLOWS, **CHECKED, **KEPT}
SILLY = (
    None,
    "x",
    -1,
    2**70,
    np.nan,
    [],
    {},
    np.nan * np.ones(3),
    np.inf * np.ones((3, 162)),
    np.zeros((0, 0)),
    np.ones((2, 5)),
    np.ones((3, 162)),
    np.ones((162, 3), np.float32),
    np.ones(162),
    np.ones((1, 1, 1)),
    np.full(162, 10**9),
    [np.ones((3, 162), np.float32)] * 5,
    [np.nan * np.ones((3, 162))] * 5,
    np.ma.array([1.0, 2.0], mask=[0, 1]),
)


@pytest.mark.parametrize("name", THINGS)
def test_parts_that_are_forged_give_an_error_or_an_object_that_works(name):
    restore, (kind, form, version, parts) = THINGS[name]().__reduce__()
    fine = (spectral_tv.MeshError, TypeError, OverflowError, ValueError, AttributeError)
    for part, value in parts.items():
        others = {key: parts[key] for key in parts if key != part}
        with pytest.raises(spectral_tv.MeshError, match=f'a {kind} has no part "{part}"'):
            restore(kind, form, version, others)
        is_cut = hasattr(value, "__getitem__") and not isinstance(value, dict)
        cut = [value[:-1], value[1:], value[::-1]] if is_cut else []
        for silly in (*SILLY, *cut):
            try:
                made = restore(kind, form, version, {**others, part: silly})
            except fine as error:
                assert "internal error" not in str(error)
                continue
            if isinstance(made, spectral_tv.Flow | spectral_tv.Decomposition):
                properties(made)
                assert np.isfinite(made.filter(np.ones(len(made.spectrum)))).all()
                made.bands([0, *made.times[1:]])
            if isinstance(made, spectral_tv.Deformer | spectral_tv.Poser):
                made.solve(TARGETS)


def test_many_threads_pickle_one_object():
    split = spectral_tv.decompose(spectral_tv.Mesh(*grid(40, 40)), steps=8)
    found = []
    threads = [threading.Thread(target=lambda: found.append(pickle.dumps(split))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [pickle.dumps(split)] * 4
