"""Whatever the poses and the filter: finite caricatures and errors, or a refusal."""

from __future__ import annotations

import numpy as np
import spectral_tv
from hypothesis import given
from hypothesis import strategies as st
from nasty_meshes import meshes
from patience import result
from test_any_mesh import EXACT, METHODS, SCHEMES, SOLVERS, made
from test_any_value import MESH, NUMBERS, refusable

STEPPED = [name for name, facts in spectral_tv.METHODS.items() if facts.takes_steps]


@given(
    st.lists(meshes(), min_size=1, max_size=3),
    st.sampled_from(METHODS),
    st.tuples(st.floats(0, 1e-3), st.floats(1e-3, 1, exclude_min=True)),
    st.floats(-5, 5),
    st.floats(0, 1e-2),
)
def test_any_poses_are_exaggerated(all_arrays, method, band, gain, smooth):
    found = [mesh for arrays in all_arrays if (mesh := made(*arrays)) is not None]
    job = spectral_tv.start_caricature(found, band, gain, smooth, method, steps=5)
    shapes = result(job)
    assert [shape.shape for shape in shapes] == [mesh.vertices.shape for mesh in found]
    assert all(np.isfinite(shape).all() for shape in shapes)


@given(st.tuples(NUMBERS, NUMBERS), NUMBERS, NUMBERS)
def test_any_filter_exaggerates(band, gain, smooth):
    shapes = refusable(lambda: spectral_tv.start_caricature([MESH], band, gain, smooth, steps=4))
    if shapes is not None and abs(gain) < 1e100:
        assert np.isfinite(shapes[0]).all()


@given(
    meshes(),
    st.sampled_from(STEPPED),
    st.sampled_from(SCHEMES),
    st.sampled_from(SOLVERS),
    st.lists(st.integers(4, 6), min_size=1, max_size=2),
)
def test_any_mesh_has_errors_that_are_numbers(arrays, method, scheme, solver, steps):
    mesh = made(*arrays)
    scheme = scheme if scheme != "exact" or method in EXACT else "lagged"
    job = spectral_tv.start_accuracy(
        mesh, method, steps, bands=3, refinement=2, scheme=scheme, solver=solver
    )
    errors = result(job)
    for part in (errors.all_pass, errors.bands, errors.paper_bands, errors.relative):
        assert np.isfinite(part).all()
        assert (part >= 0).all()
    size = np.abs(arrays[0]).max() + np.abs(errors.bands).max()
    assert errors.all_pass.max() <= 1e-9 * size


@given(NUMBERS, NUMBERS, st.integers(1, 40))
def test_any_scales_make_times(finest, largest, steps):
    times = refusable(lambda: spectral_tv.graded_times(finest, largest, steps))
    if times is not None:
        assert len(times) == steps + 1
        assert times[0] == 0
        assert np.isfinite(times).all()
        assert times[-1] == largest or abs(times[-1] / largest - 1) < 1e-6


@given(meshes(), st.sampled_from(METHODS), st.sampled_from([0.5, 0.2]))
def test_any_mesh_is_decomposed_to_an_accuracy(arrays, method, accuracy):
    mesh = made(*arrays)
    split = refusable(lambda: spectral_tv.start_decompose(mesh, method, accuracy=accuracy))
    if split is None:
        return
    assert np.isfinite(split.residual).all()
    assert np.isfinite(split.spectrum).all()
