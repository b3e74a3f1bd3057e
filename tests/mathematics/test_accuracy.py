"""How accurate bands are for the number of factorizations spent."""

from __future__ import annotations

import numpy as np
import pytest
import reference
import spectral_tv
from band_errors import band_errors
from shapes import bumpy_sphere, dumbbell


@pytest.fixture(scope="module")
def fine():
    vertices, triangles = bumpy_sphere(4, amplitude=0.3)
    mesh = spectral_tv.Mesh(vertices, triangles)
    flow = spectral_tv.decompose(mesh, "m1", times=graded(mesh, 1000)).flow
    return vertices, triangles, mesh, flow.times, flow.states


def graded(mesh, steps):
    """Times up to 2e-2 of the area, spaced as the default ones are."""
    onset, last = 3e-5 * mesh.area, 2e-2 * mesh.area
    return onset * ((1 + last / onset) ** (np.arange(steps + 1) / steps) - 1)


@pytest.mark.parametrize("steps", [16, 32])
def test_default_is_more_accurate_than_extrapolated_bdf2(fine, steps):
    """At the same number of factorizations, on the times each is best on."""
    vertices, triangles, mesh, times, states = fine
    ours = spectral_tv.decompose(mesh, "m1", times=graded(mesh, steps)).flow
    ours_error = band_errors(mesh.vertex_areas, ours.times, ours.states, times, states).mean()

    ops = reference.Operators(vertices, triangles)
    logarithmic = np.append(0.0, np.geomspace(times[-1] / 1000, times[-1], steps))
    bdf2_errors = [
        band_errors(
            mesh.vertex_areas,
            t,
            reference.bdf2_extrapolated_flow(ops, vertices, t, 1e-3 * 2**0.5),
            times,
            states,
        ).mean()
        for t in (logarithmic, ours.times)
    ]
    print(f"{steps} steps: mean error of bands {ours_error:.4f}, BDF2 {min(bdf2_errors):.4f}")
    assert ours_error < 0.75 * min(bdf2_errors)


def refined(method):
    """A mesh, its flow in many steps, and the shape of states with an axis for channels."""
    mesh = spectral_tv.Mesh(*bumpy_sphere(4, amplitude=0.3))
    fine = spectral_tv.decompose(mesh, method, steps=1000).flow
    return mesh, fine, (-1, len(mesh.vertex_areas), 1 if method == "m3" else 3)


@pytest.mark.parametrize("method", ["m1", "m2", "m3"])
def test_bands_converge_as_steps_refine(method):
    mesh, fine, shape = refined(method)
    errors = []
    for steps in (16, 32, 64):
        flow = spectral_tv.decompose(mesh, method, steps=steps).flow
        errors.append(
            band_errors(
                mesh.vertex_areas,
                flow.times,
                flow.states.reshape(shape),
                fine.times,
                fine.states.reshape(shape),
            ).mean()
        )
    print(method, errors)
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.6 * errors[0]


def test_a_shape_that_collapses_to_a_point_has_accurate_bands():
    """Masses fall by orders in one step: corrections go far, and with masses renewed."""
    mesh = spectral_tv.Mesh(*bumpy_sphere(4, amplitude=0.3))
    last = 0.03 * mesh.area
    flows = [
        spectral_tv.decompose(mesh, "m2", times=spectral_tv.graded_times(1.5e-3 * last, last, n))
        for n in (32, 1000)
    ]
    (times, states), fine = [(split.flow.times, split.flow.states) for split in flows]
    assert np.ptp(fine[1][-1], axis=0).max() < 1e-6 * np.ptp(fine[1][0], axis=0).max()
    errors = band_errors(mesh.vertex_areas, times, states, *fine)
    print(errors)
    assert errors.mean() < 0.04
    assert errors.max() < 0.1


@pytest.mark.parametrize(("method", "most"), [("m1", 0.02), ("m2", 0.08), ("m3", 0.1)])
@pytest.mark.parametrize("shape", [bumpy_sphere(4), dumbbell()])
def test_default_bands_are_near_those_of_fifteen_times_the_steps(shape, method, most):
    mesh = spectral_tv.Mesh(*shape)
    split = spectral_tv.decompose(mesh, method)
    edges = split.band_edges(5)
    expected = spectral_tv.decompose(mesh, method, steps=480).bands(edges)
    areas = mesh.vertex_areas[:, np.newaxis]
    norms = [
        np.sqrt((areas * bands**2).sum(axis=(1, 2)))
        for bands in (split.bands(edges) - expected, expected)
    ]
    # What has gone before the last edges has bands of nothing.
    there = norms[1] > 0.02 * norms[1].max()
    errors = norms[0][there] / norms[1][there]
    print(method, errors)
    assert there.sum() >= 3
    assert errors.mean() < most


@pytest.mark.parametrize("method", ["m1", "m2", "m3"])
def test_bands_do_not_depend_on_where_steps_fall(method):
    """The edges are as wide whatever the steps: another number moves no part over an edge."""
    mesh = spectral_tv.Mesh(*bumpy_sphere(4))
    edges = spectral_tv.decompose(mesh, method).band_edges(5)[:-1]
    bands = [spectral_tv.decompose(mesh, method, steps=n).bands(edges) for n in (120, 127)]
    sizes = np.linalg.norm(bands[0], axis=(1, 2))
    assert (np.linalg.norm(bands[1] - bands[0], axis=(1, 2)) < 0.05 * sizes).all()


@pytest.mark.parametrize("method", ["m1", "m2", "m3"])
def test_as_many_steps_as_an_accuracy_takes(method):
    mesh, fine, shape = refined(method)
    counts = []
    for accuracy in (0.2, 0.02):
        flow = spectral_tv.decompose(mesh, method, accuracy=accuracy).flow
        states, fine_states = flow.states.reshape(shape), fine.states.reshape(shape)
        errors = band_errors(mesh.vertex_areas, flow.times, states, fine.times, fine_states)
        print(method, accuracy, len(flow.times) - 1, errors.mean())
        assert errors.mean() < 1.5 * accuracy
        counts.append(len(flow.times) - 1)
    assert counts[0] < counts[1] < 1000


def test_an_accuracy_keeps_the_times_that_are_given():
    mesh = spectral_tv.Mesh(*bumpy_sphere(3))
    times = spectral_tv.graded_times(1e-4 * mesh.area, 1e-2 * mesh.area, 8)
    found = spectral_tv.decompose(mesh, "m1", times=times, accuracy=0.1).times
    assert len(found) > len(times)
    assert np.isin(times, found).all()
