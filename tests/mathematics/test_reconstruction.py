"""What an all-pass filter gives back, and what the bands' own errors are.

Brokman et al. 2024, Sec. 9.2 and the figure of the reconstruction error: with the transform of
the paper the all-pass error grows with the time steps. Here it is rounding at any step.
"""

from __future__ import annotations

import numpy as np
import pytest
import reference
import spectral_tv
from band_errors import relative_errors, soft_bands
from shapes import bumpy_sphere, grid, icosphere

# Some meshes are bad on purpose.
pytestmark = pytest.mark.filterwarnings("ignore::spectral_tv.MeshWarning")

VERTICES, TRIANGLES = bumpy_sphere(4, amplitude=0.3)


@pytest.fixture(scope="module")
def mesh():
    return spectral_tv.Mesh(VERTICES, TRIANGLES)


def size(mesh, distances):
    """Root mean squares over the surface, relative to the size of the shape."""
    return np.sqrt(distances**2 @ mesh.vertex_areas) / mesh.area


def velocity(ops, u, epsilon):
    """p(u) of M1 (Brokman et al. 2024, Eq. 54)."""
    weights = 1 / np.sqrt(ops.gradient_norm(u) ** 2 + epsilon**2)
    return (ops.laplacian(weights) @ u) / ops.vertex_areas[:, None]


@pytest.mark.parametrize("steps", [6, 20])
def test_the_papers_error_is_that_of_its_formulas(mesh, steps):
    """φ = t u_tt by central differences, its integral by trapezia, R = T p(u(T)) + u(T)."""
    ops = reference.Operators(VERTICES, TRIANGLES)
    epsilon = 1e-3 * np.sqrt(2)
    scales = 1e-5 * mesh.area, 3e-3 * mesh.area
    times = spectral_tv.graded_times(*scales, steps)
    u = reference.semi_implicit_flow(ops, VERTICES, times, epsilon, "tv")
    before, after = np.diff(times)[:-1, None, None], np.diff(times)[1:, None, None]
    rates = np.diff(u, axis=0) / np.diff(times)[:, None, None]
    second = 2 * np.diff(rates, axis=0) / (before + after)
    phi = times[1:-1, None, None] * second
    integral = (phi * (before + after) / 2).sum(axis=0)
    residual = times[-1] * velocity(ops, u[-1], epsilon) + u[-1]
    expected = np.linalg.norm(integral + residual - VERTICES, axis=1)
    measured = spectral_tv.accuracy(mesh, "m1", [steps], scales=scales).paper_all_pass[0]
    np.testing.assert_allclose(measured, expected, atol=1e-7)


def test_the_papers_error_grows_with_the_step_and_ours_is_rounding(mesh):
    found = spectral_tv.accuracy(mesh, "m1", [4, 8, 16, 32], refinement=2)
    paper = size(mesh, found.paper_all_pass)
    print("all-pass error of the paper's transform at 4, 8, 16, 32 steps:", paper)
    assert (paper[:-1] > 1.6 * paper[1:]).all()
    assert found.all_pass.max() < 1e-13
    assert paper.min() > 1e-5


@pytest.mark.parametrize("method", ["m1", "m2", "m3", "naive", "heat"])
def test_all_methods_give_the_shape_back_and_their_bands_converge(mesh, method):
    found = spectral_tv.accuracy(mesh, method, [8, 16, 32])
    assert found.all_pass.max() < 1e-12
    errors = found.relative.mean(axis=1)
    assert (np.diff(errors) < 0).all()
    assert (np.diff(size(mesh, found.bands)) < 0).all()
    # The default step is the better one.
    assert errors[-1] < 0.8 * found.paper_relative.mean(axis=1)[-1]


@pytest.mark.parametrize(("method", "channels"), [("m2", 3), ("m3", 1)])
def test_errors_of_bands_are_those_against_the_refined_flow(mesh, method, channels):
    found = spectral_tv.accuracy(mesh, method, [10, 20], bands=4, refinement=3)
    flows = [spectral_tv.decompose(mesh, method, steps=steps).flow for steps in (10, 20, 60)]
    shape = (-1, len(VERTICES), channels)
    *coarse, fine = (
        soft_bands(flow.times, flow.states.reshape(shape), found.edges) for flow in flows
    )
    for row, bands in enumerate(coarse):
        expected = relative_errors(mesh.vertex_areas, bands, fine)
        np.testing.assert_allclose(found.relative[row], expected, rtol=1e-6)
        distance = np.sqrt(((bands - fine) ** 2).sum(axis=(0, 2)))
        np.testing.assert_allclose(found.bands[row], distance, atol=1e-9)


def test_shapes_and_defaults_of_what_is_measured(mesh):
    found = spectral_tv.accuracy(mesh)
    assert found.steps.tolist() == [8, 16, 32]
    assert found.edges.shape == (6,)
    for table in (found.all_pass, found.paper_all_pass, found.bands, found.paper_bands):
        assert table.shape == (3, len(VERTICES))
    assert found.relative.shape == found.paper_relative.shape == (3, 5)
    job = spectral_tv.start_accuracy(mesh, "m1", [8], bands=2)
    alone = job.result()
    assert alone.relative.shape == (1, 2)
    assert job.progress == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"steps": []}, "at least one value"),
        ({"steps": [8, 1]}, "steps must be at least 2, not 1"),
        ({"steps": [-8]}, "steps must be at least 2, not -8"),
        ({"steps": [8.5]}, "steps must be an array of integers"),
        ({"bands": 40}, "number of bands"),
        ({"refinement": 1}, "refinement must be at least 2"),
        ({"scales": (2.0, 1.0)}, "finest scale"),
        ({"method": "lb"}, "take no time steps"),
        ({"method": "displacement"}, "take no time steps"),
    ],
)
def test_what_cannot_be_measured_is_refused(arguments, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.accuracy(spectral_tv.Mesh(*icosphere(2)), **arguments)


def test_vertices_that_all_but_touch_their_base_are_reconstructed_too(mesh):
    """Rounding leaves M3 no direction there, and must not leave a gap."""
    base = spectral_tv.conformal_flow(mesh, 1e-3 * mesh.area)
    touching = np.arange(0, len(VERTICES), 5)
    base[touching] = VERTICES[touching] + 5e-13 * np.sqrt(mesh.area / 3)
    split = spectral_tv.decompose(mesh, "m3", steps=8, base=base)
    whole = split.filter(np.ones(len(split.spectrum)))
    assert np.abs(whole - VERTICES).max() < 1e-14


def test_a_base_that_is_all_but_the_shape_leaves_nothing_to_filter():
    vertices = np.array([[0, 0, 3e4], [1, 0, 2], [0, 1, 3e-5], [1, 1, 700.0]])
    mesh = spectral_tv.Mesh(vertices, [[0, 1, 3], [0, 3, 2]])
    split = spectral_tv.decompose(mesh, "m3", steps=4, base_time=1e-153)
    np.testing.assert_array_equal(split.residual, vertices)
    np.testing.assert_array_equal(split.filter(np.ones(len(split.spectrum))), vertices)


@pytest.mark.parametrize("metric", ["surface", "base"])
def test_errors_are_those_of_the_flow_along_the_chosen_metric(metric):
    vertices, triangles = grid(16, 16, 16.0, 16.0)
    middle, corner = (np.hypot(*(vertices[:, :2] - at).T) for at in ((8, 8), (13, 3)))
    vertices[:, 2] = 6.0 * (middle < 5) + 6.0 * (corner < 2)
    relief, base = spectral_tv.Mesh(vertices, triangles), vertices * [1, 1, 0]
    scales, common = (0.5, 12.0), {"base": base, "metric": metric}
    flows = [
        spectral_tv.decompose(relief, "m3", spectral_tv.graded_times(*scales, steps), **common).flow
        for steps in (6, 18)
    ]
    common |= {"bands": 2, "scales": scales, "refinement": 3}
    found = spectral_tv.accuracy(relief, "m3", [6], **common)
    shape = (-1, len(vertices), 1)
    coarse, fine = (
        soft_bands(flow.times, flow.states.reshape(shape), found.edges) for flow in flows
    )
    distance = np.abs(coarse - fine)[..., 0]
    np.testing.assert_allclose(found.bands[0], np.sqrt((distance**2).sum(axis=0)), atol=1e-9)
    assert distance.max() > 1e-3
    again = spectral_tv.start_accuracy(relief, "m3", [6], **common).result()
    np.testing.assert_array_equal(again.bands, found.bands)


def test_the_metric_of_a_base_needs_one(mesh):
    with pytest.raises(spectral_tv.MeshError, match='metric is an option of the method "m3"'):
        spectral_tv.accuracy(mesh, "m1", [8], metric="base")
