"""A step on edges against a solver that has nothing in common with it."""

from __future__ import annotations

import numpy as np
import pytest
import reference_edges
import spectral_tv
from shapes import bumpy_sphere


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
