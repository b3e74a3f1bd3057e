"""caricature: what it refuses, its job, and its limits."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import bumpy_sphere

MESH = spectral_tv.Mesh(*bumpy_sphere(2))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"band": (1e-3, 1e-4)}, "band must be two increasing numbers"),
        ({"band": (-1.0, 1e-4)}, "band must be two increasing numbers"),
        ({"band": (1e-5, 1e-4), "smooth": -1.0}, "smooth must be 0 or more"),
        ({"band": (1e-5, 1e-4), "gain": np.nan}, "gain must be finite"),
        ({"band": (1e-5, 1e-4), "method": "m9"}, "method must be"),
    ],
)
def test_caricature_refuses(arguments, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.caricature([MESH], **arguments)


def test_a_gain_of_1_is_the_shape_and_none_is_none():
    (shape,) = spectral_tv.caricature([MESH], (0.0, 1.0), gain=1.0, smooth=0.5, steps=6)
    np.testing.assert_allclose(shape, MESH.vertices, atol=1e-12)
    assert spectral_tv.caricature([], (0.0, 1.0)) == []


def test_smoothing_spares_the_band():
    split = spectral_tv.decompose(MESH, "m3", steps=8)
    edges = split.band_edges(3) / MESH.area
    (found,) = spectral_tv.caricature([MESH], tuple(edges[:2]), gain=3, smooth=edges[2], steps=8)
    bands = split.bands(split.band_edges(3))
    np.testing.assert_allclose(found, MESH.vertices + 2 * bands[0] - bands[1], atol=1e-12)


def test_the_job_gives_the_same():
    job = spectral_tv.start_caricature([MESH, MESH], (1e-4, 1e-3), steps=8)
    shapes = job.result()
    expected = spectral_tv.caricature([MESH], (1e-4, 1e-3), steps=8)[0]
    for shape in shapes:
        np.testing.assert_array_equal(shape, expected)
