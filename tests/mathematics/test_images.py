"""Spectral TV of images: known extinctions, and finite differences on the pixels."""

from __future__ import annotations

import numpy as np
import pytest
import reference_image as reference
import spectral_tv
from band_errors import remainder, soft_bands

EXACT = {"scheme": "exact", "tolerance": 1e-3}


def disc(side: int, radius: float, centre: tuple[float, float] | None = None) -> np.ndarray:
    """1 in a disc, 0 outside, and in between where it covers pixels in part."""
    row, column = centre or ((side - 1) / 2, (side - 1) / 2)
    y, x = np.mgrid[:side, :side]
    return np.clip(radius - np.hypot(y - row, x - column) + 0.5, 0, 1)


def extinction(flow: spectral_tv.Flow) -> float:
    """Where the spectrum has its peak."""
    return flow.times[1:-1][flow.spectrum.argmax()]


@pytest.mark.parametrize(("radius", "height", "error"), [(10, 1.0, 0.08), (20, 3.0, 0.06)])
def test_a_disc_is_one_component(radius, height, error):
    """At h r/2 in the plane; on a finite image sooner, as the rest rises meanwhile."""
    side = 81
    image = 5 + height * disc(side, radius)
    ratio = np.pi * radius**2 / ((side - 1) ** 2 - np.pi * radius**2)
    end = height * radius / 2 / (1 + ratio)
    flow = spectral_tv.decompose_image(image, times=np.linspace(0, 1.5 * end, 61), **EXACT)
    # Sooner by what curved edges are too long on the grid.
    assert (1 - error) * end < extinction(flow) < end
    near = np.abs(flow.times[1:-1] - extinction(flow)) < 0.15 * end
    assert flow.spectrum[near].sum() > 0.75 * flow.spectrum.sum()


def test_a_square_loses_its_corners_before_it_vanishes():
    """Its Cheeger set has the constant h = (2 + √π)/side; the middle falls at the rate h."""
    side = 24
    image = np.zeros((73, 73))
    image[25 : 25 + side, 25 : 25 + side] = 1
    rate = (2 + np.sqrt(np.pi)) / side
    flow = spectral_tv.decompose_image(image, times=np.linspace(0, 0.5 / rate, 21), **EXACT)
    middle, corner = flow.states[:, 36, 36], flow.states[:, 25, 25]
    assert -np.polyfit(flow.times, middle, 1)[0] == pytest.approx(rate, rel=0.05)
    assert corner[4] < 0.6 * middle[4]


def test_contrast_and_size_of_spots_both_count():
    """The brighter of two discs outlasts the other, and so does the larger."""
    weak, strong = disc(81, 6, (20, 20)), 2 * disc(81, 6, (60, 60))
    flow = spectral_tv.decompose_image(weak + strong, times=np.linspace(0, 4, 9), **EXACT)
    assert abs(flow.states[-1][20, 20] - flow.states[-1][20, 60]) < 0.02
    assert flow.states[-1][60, 60] - flow.states[-1][20, 60] > 0.4


@pytest.mark.parametrize("channels", [1, 3])
def test_it_is_the_spectral_tv_of_finite_differences(channels):
    """The bands of both discretizations differ by what the grid's anisotropy makes."""
    side = 40
    y, x = np.mgrid[:side, :side] / side
    image = np.stack(
        [0.8 * disc(side, 9, (15, 16 + 3 * c)) + 0.5 * disc(side, 4, (30, 29)) + 0.3 * x * y
         for c in range(channels)],
        axis=-1,
    )  # fmt: skip
    times = spectral_tv.graded_times(0.05, 6.0, 16)
    flow = spectral_tv.decompose_image(image, times=times, **EXACT)
    expected = reference.flow(image, times)
    scale = np.linalg.norm(image - image.mean(axis=(0, 1)))
    for found, other in zip(flow.states, expected, strict=True):
        assert np.linalg.norm(found - other) < 0.07 * scale
    assert np.linalg.norm(flow.residual - remainder(times, expected)) < 0.08 * scale
    edges = np.array([0, 0.5, 2.0, times[-1]])
    for found, other in zip(flow.bands(edges), soft_bands(times, expected, edges), strict=True):
        assert np.linalg.norm(found - other) < 0.15 * scale


def test_all_directions_of_the_axes_are_alike():
    """Turning and mirroring the image does the same to its flow; so does shifting a spot."""
    rng = np.random.default_rng(0)
    image = disc(30, 7, (13, 17)) + 0.3 * rng.random((30, 30))
    times = [0, 0.2, 1.0]
    exact = {"times": times, "scheme": "exact", "tolerance": 1e-6}
    final = spectral_tv.decompose_image(image, **exact).states[-1]
    turned = spectral_tv.decompose_image(np.rot90(image), **exact).states[-1]
    mirrored = spectral_tv.decompose_image(image[:, ::-1], **exact).states[-1]
    np.testing.assert_allclose(turned, np.rot90(final), atol=2e-3)
    np.testing.assert_allclose(mirrored, final[:, ::-1], atol=2e-3)
    spots = []
    for shift in (0, 1):
        spot = np.zeros((21, 21))
        spot[10, 10 + shift] = 1
        flow = spectral_tv.decompose_image(spot, times=[0, 0.05, 0.1], scheme="exact")
        spots.append(flow.states[-1][10, 10 + shift])
    assert spots[0] == pytest.approx(spots[1], abs=1e-3)


def test_edges_along_the_axes_have_their_length_and_others_are_too_long():
    """By as much as the documentation of the grid says."""
    y, x = np.mgrid[:101, :101] - 50.0
    for degrees, sharp, soft in ((0, 1.0, 1.0), (22.5, 1.19, 1.03), (45, 1.10, 1.03)):
        turn = np.radians(degrees)
        along = x * np.cos(turn) + y * np.sin(turn)
        length = 100 / np.cos(turn)
        for width, expected in ((1e-9, sharp), (3, soft)):
            edge = np.clip(along / width + 0.5, 0, 1)
            flow = spectral_tv.decompose_image(edge, times=[0, 1e-9])
            assert flow.total_variation[0] / length == pytest.approx(expected, abs=0.015)


def test_a_height_field_under_m3_is_its_image():
    """A grid mesh with a flat base: the base's metric gives spectral TV, the surface's ATV."""
    side = 33
    heights = 4 * disc(side, 8) + 2 * disc(side, 3, (6, 24))
    y, x = np.mgrid[:side, :side].astype(float)
    corner = np.arange(side * side).reshape(side, side)
    a, b, c, d = (
        block.ravel()
        for block in (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1])
    )
    triangles = np.concatenate(
        [np.stack(each, axis=1) for each in ((a, b, c), (a, c, d), (a, b, d), (b, c, d))]
    )
    vertices = np.stack([x, y, heights], axis=-1).reshape(-1, 3)
    base = vertices * [1, 1, 0]
    times = spectral_tv.graded_times(0.1, 12.0, 12)
    mesh = spectral_tv.Mesh(vertices, triangles)
    for ours, theirs in (("base", "flat"), ("surface", "surface")):
        split = spectral_tv.decompose(
            mesh, "m3", times, base=base, metric=ours, scheme="exact", tolerance=1e-4
        )
        flow = spectral_tv.decompose_image(
            heights, theirs, times, height=np.ptp(heights), scheme="exact", tolerance=1e-4
        )
        found = split.residual[:, 2].reshape(side, side)
        np.testing.assert_allclose(found, flow.residual, atol=5e-3)
        np.testing.assert_allclose(split.residual[:, :2], base[:, :2], atol=1e-12)
        bands = split.bands(split.band_edges(3))[..., 2].reshape(3, side, side)
        np.testing.assert_allclose(bands, flow.bands(flow.band_edges(3)), atol=2e-2)


@pytest.mark.parametrize("height", [10.0, 30.0])
def test_on_the_surface_a_disc_falls_more_slowly_by_its_wall(height):
    """Half of the wall around it, of the area 2πrH, is its own: the rate is 2/(r + H), not 2/r."""
    radius = 9.5
    y, x = np.mgrid[:71, :71] - 35
    hard = (np.hypot(x, y) < radius).astype(float)
    for metric, expected in (("flat", 2 / radius), ("surface", 2 / (radius + height))):
        times = np.linspace(0, 0.5 / expected, 9)
        flow = spectral_tv.decompose_image(hard, metric, times, height=height, scheme="exact")
        rate = (flow.states[0, 35, 35] - flow.states[-1, 35, 35]) / times[-1]
        assert rate == pytest.approx(expected, rel=0.13)  # curved edges are too long by as much


def test_bands_add_up_whatever_the_scheme_and_metric():
    rng = np.random.default_rng(1)
    image = rng.random((17, 23, 3))
    for metric in ("flat", "surface"):
        flow = spectral_tv.decompose_image(image, metric, steps=8)
        bands = flow.bands(flow.band_edges(4))
        assert bands.shape == (4, 17, 23, 3)
        np.testing.assert_allclose(bands.sum(axis=0) + flow.residual, image, atol=1e-12)
        np.testing.assert_allclose(flow.filter(np.ones(7)), image, atol=1e-12)
        assert flow.mean(np.ones((17, 23))).shape == (9, 3)
