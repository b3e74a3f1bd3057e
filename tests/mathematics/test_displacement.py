"""The displacement from a smooth base, exaggerated as a whole (Cignoni et al. 2005)."""

from __future__ import annotations

import numpy as np
import pytest
import reference
import spectral_tv
from shapes import bumpy_sphere

VERTICES, TRIANGLES = bumpy_sphere(4, amplitude=0.3)


@pytest.mark.parametrize("amount", [-1.0, 0.0, 0.8, 2.5])
def test_exaggeration_is_s_plus_k_times_s_minus_the_smoothed_shape(amount):
    mesh = spectral_tv.Mesh(VERTICES, TRIANGLES)
    times = np.linspace(0, 0.02 * mesh.area, 11)
    smooth = reference.conformal_flow(VERTICES, TRIANGLES, times, 2)[-1]
    split = spectral_tv.decompose(mesh, "displacement", base_time=times[-1])
    (band,) = split.bands(split.band_edges(1))
    expected = VERTICES + amount * (VERTICES - smooth)
    np.testing.assert_allclose(VERTICES + amount * band, expected, atol=1e-7)
    np.testing.assert_allclose(split.filter([1 + amount]), expected, atol=1e-7)
    np.testing.assert_allclose(split.residual, smooth, atol=1e-7)


def test_any_base_will_do_and_stays_the_residual():
    mesh = spectral_tv.Mesh(VERTICES, TRIANGLES)
    base = VERTICES * [1.0, 1.0, 0.5]
    split = spectral_tv.decompose(mesh, "displacement", base=base)
    np.testing.assert_array_equal(split.residual, base)
    np.testing.assert_allclose(split.filter([3.0]), 3 * VERTICES - 2 * base, atol=1e-12)


def test_its_base_is_that_of_m3():
    """So that the two compare: without any detail both are the smoothed shape."""
    mesh = spectral_tv.Mesh(VERTICES, TRIANGLES)
    smooth = spectral_tv.conformal_flow(mesh, 5e-3 * mesh.area)
    split = spectral_tv.decompose(mesh, "displacement")
    np.testing.assert_array_equal(split.filter([0.0]), smooth)
    m3 = spectral_tv.decompose(mesh, "m3")
    distance = np.linalg.norm(VERTICES - smooth, axis=1)
    np.testing.assert_allclose(np.abs(m3.flow.states[0]), distance, atol=1e-12)
