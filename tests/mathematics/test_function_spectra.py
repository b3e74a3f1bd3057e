"""Spectra, bands, filters and means of functions on a mesh."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import icosphere


@pytest.fixture(scope="module")
def sphere():
    vertices, triangles = icosphere(4)
    return vertices, spectral_tv.Mesh(vertices, triangles)


def functions(vertices):
    x, y, z = vertices.T
    return {"scalar": np.sin(7 * x) + z, "vector": np.column_stack([np.sin(7 * x), y, y * z, z])}


@pytest.mark.parametrize("operator", ["tv", "heat"])
@pytest.mark.parametrize("name", ["scalar", "vector"])
def test_bands_and_residual_are_the_function(sphere, name, operator):
    vertices, mesh = sphere
    values = functions(vertices)[name]
    flow = spectral_tv.flow(mesh, values, spectral_tv.graded_times(0.01, 0.5, 12), operator)
    bands = flow.bands(flow.band_edges(4))
    assert bands.shape == (4, *values.shape)
    np.testing.assert_allclose(bands.sum(axis=0) + flow.residual, values, atol=1e-12)
    np.testing.assert_allclose(flow.filter(np.ones(11)), values, atol=1e-12)
    gains = np.linspace(-1, 2, 11)
    edge = flow.band_edges(4)[2]
    low = flow.filter(lambda time: float(time >= edge))
    components = np.stack([flow.filter(gain) - flow.residual for gain in np.eye(11)])
    # They agree but for what is within the edge.
    near = np.searchsorted(flow.times[1:-1], edge) + np.array([-1, 0])
    within = sum(np.linalg.norm(component) for component in components[near])
    assert np.linalg.norm(low - bands[2:].sum(axis=0) - flow.residual) < within
    expected = np.tensordot(gains, components, axes=1) + flow.residual
    np.testing.assert_allclose(flow.filter(gains), expected, atol=1e-12)
    sizes = np.abs(components) if name == "scalar" else np.linalg.norm(components, axis=2)
    np.testing.assert_allclose(flow.spectrum, sizes @ mesh.vertex_areas, rtol=1e-12)


def test_spectrum_of_a_cap_is_a_spike_at_its_extinction(sphere):
    """An eigenset's ψ is one component, at t = 1/λ = |C|/per(C)."""
    vertices, mesh = sphere
    inside = vertices[:, 2] > np.cos(1.0)
    area = mesh.vertex_areas[inside].sum()
    psi = np.where(inside, 1.0, -area / (mesh.area - area))
    extinction = (1 - np.cos(1.0)) / np.sin(1.0)
    flow = spectral_tv.flow(mesh, psi, np.linspace(0, 1.5 * extinction, 31), exact=True)
    assert flow.times[1:-1][flow.spectrum.argmax()] == pytest.approx(extinction, rel=0.1)
    near = np.abs(flow.times[1:-1] / extinction - 1) < 0.13
    assert flow.spectrum[near].sum() > 0.8 * flow.spectrum.sum()
    np.testing.assert_allclose(flow.residual, 0, atol=1e-3)


def test_mean_of_a_part(sphere):
    vertices, mesh = sphere
    values = functions(vertices)["vector"]
    flow = spectral_tv.flow(mesh, values, [0, 0.05, 0.1])
    part = vertices[:, 0] > 0.3
    areas = mesh.vertex_areas * part
    expected = np.einsum("kvc,v->kc", flow.states, areas) / areas.sum()
    np.testing.assert_allclose(flow.mean(part), expected, atol=1e-12)
    np.testing.assert_allclose(flow.mean(3 * part.astype(int)), expected, atol=1e-12)
    everything = flow.mean(np.ones(len(vertices)))
    np.testing.assert_allclose(everything, everything[[0, 0, 0]], atol=1e-9)
    alone = spectral_tv.flow(mesh, values[:, 1], [0, 0.05, 0.1])
    one = np.arange(len(vertices)) == 17
    np.testing.assert_allclose(alone.mean(one), alone.states[:, 17], atol=1e-15)


def test_means_of_nothing_are_refused(sphere):
    vertices, mesh = sphere
    flow = spectral_tv.flow(mesh, vertices, [0, 0.05])
    for weights, message in (
        (np.zeros(len(vertices)), "give no vertex any area"),
        (np.ones(3), "one value per vertex"),
        (np.full(len(vertices), -1.0), r"weights\[0\] must be 0 or more"),
        (np.full(len(vertices), np.nan), r"weights\[0\] must be 0 or more"),
        (vertices, "list of numbers"),
    ):
        with pytest.raises(spectral_tv.MeshError, match=message):
            flow.mean(weights)


def test_a_job_gives_the_flow_that_the_call_gives(sphere):
    vertices, mesh = sphere
    options = {"values": vertices[:, 0], "times": [0, 0.1, 0.3], "exact": True}
    job = spectral_tv.start_flow(mesh, **options)
    expected = spectral_tv.flow(mesh, **options)
    np.testing.assert_array_equal(job.result().states, expected.states)
    with pytest.raises(spectral_tv.MeshError, match="operator must be"):
        spectral_tv.start_flow(mesh, **options, operator="wave")
