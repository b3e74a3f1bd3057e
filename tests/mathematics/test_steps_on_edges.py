"""A step on edges against solvers that have nothing in common with it."""

from __future__ import annotations

import numpy as np
import pytest
import reference_edges
import set_meshes
import spectral_tv
from scipy.sparse.linalg import factorized
from shapes import bumpy_sphere

from tools.bench.primal_dual import PrimalDual


def test_an_exact_step_on_edges_is_that_of_a_cone_programme():
    vertices, triangles = bumpy_sphere(2)
    values, tau = (vertices[:, 2] > 0.3).astype(float), 0.1
    elements = reference_edges.edge_elements(vertices, triangles)
    data = elements.sample @ values
    expected = reference_edges.proximal_step(elements, data, tau)
    mesh = spectral_tv.Mesh(vertices, triangles)
    flow = spectral_tv.flow(mesh, values, [0, tau], tolerance=1e-8)
    assert flow.gap[0] <= 1e-8
    assert flow.total_variation[0] == pytest.approx(elements.total_variation(data))
    assert flow.total_variation[1] == pytest.approx(elements.total_variation(expected), rel=1e-4)
    state = reference_edges.interpolate(elements, triangles, expected)
    np.testing.assert_allclose(flow.states[1], state, atol=2e-3)


def test_an_exact_step_on_edges_is_that_of_primal_dual_iteration():
    # By first-order steps, on more triangles than a cone programme takes in a second.
    make_set, make_mesh = set_meshes.SETS["cap of 1.0, regular"]
    known = make_set(make_mesh(1_000))
    elements = reference_edges.edge_elements(*known.mesh)
    data, tau = elements.sample @ known.members.astype(float), 0.1
    solver = PrimalDual(
        elements.gradient, elements.areas, elements.mass, factorized(elements.mass.tocsc())
    )
    expected, gap, _ = solver.step(data, tau, 1e-5)
    assert gap <= 1e-5
    mesh = spectral_tv.Mesh(*known.mesh)
    flow = spectral_tv.flow(mesh, known.members.astype(float), [0, tau], tolerance=1e-6)
    assert flow.total_variation[1] == pytest.approx(elements.total_variation(expected), rel=1e-3)
    state = reference_edges.interpolate(elements, known.mesh[1], expected)
    np.testing.assert_allclose(flow.states[1], state, atol=5e-3)
