"""Whatever the arguments: a finite result, or an exception that says what is wrong."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import spectral_tv
from hypothesis import given
from hypothesis import strategies as st
from patience import result
from shapes import icosphere

VERTICES, TRIANGLES = icosphere(1)
COUNT = len(VERTICES)
MESH = spectral_tv.Mesh(VERTICES, TRIANGLES)

NUMBERS = st.one_of(
    st.sampled_from([0.0, -0.0, 1.0, -1.0, np.nan, np.inf, -np.inf, 5e-324, 1e-200, 1e99, 1e308]),
    st.floats(),
    st.floats(1e-6, 1e3),
)
COUNTS = st.one_of(
    st.integers(0, 8), st.sampled_from([10**6 + 1, 10**13, 2**62, 2**63]), st.integers(max_value=8)
)
SCALARS = st.one_of(NUMBERS, st.integers(), st.just(10**400))
DTYPES = ["f8", "f4", "f2", "g", "i8", "i1", "u2", "u8", "?", "c16", "O", "U3", "M8[s]", ">f8"]


def refusable(call):
    """What the call gives, or nothing where it is refused by a documented exception."""
    try:
        outcome = call()
        return result(outcome) if isinstance(outcome, spectral_tv.Job) else outcome
    except spectral_tv.MeshError as error:
        assert len(str(error)) > 10
        return None


@st.composite
def arrays(draw, shape):
    """The numbers of a mesh or noise, in some shape, dtype and layout, a few of them spoilt."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    array = rng.normal(size=shape)
    for _ in range(draw(st.integers(0, 2)) if array.size else 0):
        array.flat[draw(st.integers(0, array.size - 1))] = draw(NUMBERS)
    with np.errstate(all="ignore"):
        array = array.astype(draw(st.sampled_from(["f8"] * 6 + DTYPES)))
    layout = draw(st.sampled_from(["C", "F", "strided", "reversed", "read-only", "list"]))
    match layout:
        case "F":
            return np.asfortranarray(array)
        case "strided" if array.ndim:
            return np.repeat(array, 2, axis=0)[::2]
        case "reversed" if array.ndim:
            return array[::-1]
        case "read-only":
            array.setflags(write=False)
        case "list":
            return array.tolist()
    return array


SHAPES = st.sampled_from(
    [(COUNT,), (COUNT, 1), (COUNT, 3), (COUNT, 3), (COUNT, 0), (COUNT - 1, 3), (0,), (0, 3), ()]
)


@given(st.data(), SHAPES)
def test_any_values_and_times_flow(data, shape):
    values = data.draw(arrays(shape))
    times = data.draw(st.one_of(st.just([0, 0.01, 0.1]), st.lists(NUMBERS).map(sorted)))
    exact, solver = data.draw(st.booleans()), data.draw(st.sampled_from(["auto", "multigrid"]))
    operator = data.draw(st.sampled_from(["tv", "tv", "heat"]))
    flow = refusable(
        lambda: spectral_tv.start_flow(MESH, values, times, operator, exact, solver=solver)
    )
    if flow is not None:
        assert np.isfinite(flow.states).all()
        assert np.isfinite(flow.residual).all()
        assert np.isfinite(flow.total_variation).all()
    variation = refusable(lambda: spectral_tv.total_variation(MESH, values))
    assert variation is None or np.isfinite(variation)


@given(st.data())
def test_any_arrays_make_a_mesh_or_are_refused(data):
    vertices = data.draw(arrays(data.draw(SHAPES)))
    triangles = data.draw(
        st.one_of(
            st.just(TRIANGLES),
            arrays((4, 3)),
            st.lists(st.lists(st.integers(-1, COUNT), min_size=3, max_size=3)),
            st.lists(st.lists(st.integers(), min_size=3, max_size=3)),
        )
    )
    mesh = refusable(lambda: spectral_tv.Mesh(vertices, triangles))
    if mesh is not None:
        assert 0 < mesh.area < np.inf


@given(st.data(), st.sampled_from(["m1", "m2", "m3", "lb", "displacement"]))
def test_any_settings_decompose(data, method):
    settings = {
        "steps": COUNTS,
        "tolerance": SCALARS,
        "scheme": st.sampled_from(["lagged", "exact", "", "\0"]),
        "p": st.one_of(st.integers(0, 5), st.integers()),
        "base": arrays((COUNT, 3)),
        "base_time": SCALARS,
        "eigenpairs": COUNTS,
        "times": st.lists(NUMBERS).map(sorted),
    }
    names = data.draw(st.sets(st.sampled_from([*settings]), max_size=2))
    chosen = {"steps": 4, **{name: data.draw(settings[name]) for name in sorted(names)}}
    split = refusable(lambda: spectral_tv.start_decompose(MESH, method, **chosen))
    if split is None:
        return
    assert np.isfinite(split.residual).all()
    assert np.isfinite(split.spectrum).all()
    gains = data.draw(arrays((len(split.times) - 2,)))
    refusable(lambda: split.filter(gains))
    refusable(lambda: split.bands(data.draw(st.lists(NUMBERS))))
    refusable(lambda: split.band_edges(data.draw(COUNTS)))
    labels = refusable(lambda: spectral_tv.start_cosegment([split], data.draw(COUNTS)))
    assert labels is None or len(labels[0]) == COUNT


@given(st.data(), st.sampled_from(["convex", "paper", "harmonic", "biharmonic", "arap"]))
def test_any_targets_deform(data, algorithm):
    indices = data.draw(st.lists(st.integers(0, COUNT), min_size=1, max_size=4, unique=True))
    targets = data.draw(arrays((len(indices), 3)))
    weights = data.draw(st.one_of(st.none(), arrays((len(indices),))))
    softness = data.draw(st.one_of(st.just(0.0), SCALARS))
    bent = refusable(
        lambda: spectral_tv.start_deform(MESH, indices, targets, weights, softness, 1e-2, algorithm)
    )
    assert bent is None or np.isfinite(bent.vertices).all()


@given(st.data())
def test_any_members_are_tested(data):
    shape = data.draw(st.sampled_from([(COUNT,), (COUNT,), (3,), (0,), (), (COUNT, 1)]))
    test = refusable(lambda: spectral_tv.start_eigenset_test(MESH, data.draw(arrays(shape))))
    assert test is None or np.isfinite(test.rate)


@pytest.mark.parametrize("steps", [10**6 + 1, 10**13, 2**62, 2**63])
@pytest.mark.parametrize(
    "call",
    [
        "graded_times(1e-3, 1.0, STEPS)",
        "decompose(mesh, steps=STEPS)",
        "decompose(mesh, 'lb', steps=STEPS, eigenpairs=3)",
        "conformal_flow(mesh, 1.0, STEPS)",
        "accuracy(mesh, steps=[4], bands=2, refinement=STEPS)",
    ],
)
def test_more_steps_than_fit_are_refused(call, steps):
    """In a process of its own, which running out of memory would end."""
    code = f"""
import spectral_tv
mesh = spectral_tv.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
try:
    spectral_tv.{call.replace("STEPS", str(steps))}
except spectral_tv.MeshError as error:
    assert "steps must be at most 1000000" in str(error), error
else:
    raise SystemExit("not refused")
"""
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)


def test_a_decomposition_without_components_is_not_segmented():
    whole = spectral_tv.decompose(MESH, times=[0, 1e-3])
    with pytest.raises(spectral_tv.MeshError, match="decomposition 1 has no components"):
        spectral_tv.cosegment([spectral_tv.decompose(MESH, steps=4), whole], 3)


def test_members_that_are_no_numbers_are_refused():
    members = np.zeros(COUNT)
    members[7] = np.nan
    with pytest.raises(spectral_tv.MeshError, match=r"members\[7\] is not a number"):
        spectral_tv.eigenset_test(MESH, members)


@pytest.mark.parametrize("reach", [1e20, 1e99])
def test_rigid_deformation_to_the_horizon_ends(reach):
    """Neighbourhoods become lines, and no rotation of them is better than another."""
    targets = [[reach, reach, 0.0], [0.0, 0.0, 0.0]]
    bent = result(spectral_tv.start_deform(MESH, [0, 1], targets, algorithm="arap"))
    assert np.isfinite(bent.vertices).all()
