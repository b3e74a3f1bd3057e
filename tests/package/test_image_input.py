"""decompose_image: what it refuses, and its job."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv

IMAGE = np.random.default_rng(0).random((12, 9))


@pytest.mark.parametrize(
    ("image", "arguments", "message"),
    [
        (IMAGE[0], {}, r"shape \(H, W\) or \(H, W, C\), not \[9\]"),
        (IMAGE[:, :1], {}, "at least 2 × 2 pixels, not 12 × 1"),
        (IMAGE[..., None][..., :0], {}, r"not \[12, 9, 0\]"),
        (np.where(np.arange(9) == 4, np.nan, IMAGE), {}, "row 0, column 4, channel 0, is not fin"),
        (IMAGE.astype(str), {}, "image must be an array of numbers"),
        (IMAGE, {"metric": "round"}, 'metric must be "flat" or "surface", not "round"'),
        (IMAGE, {"metric": "surface", "height": 0.0}, "height must be above 0"),
        (IMAGE, {"metric": "surface", "height": np.inf}, "height must be above 0"),
        (IMAGE, {"times": [0.1, 1.0]}, r"times\[0\] must be 0"),
        (IMAGE, {"steps": 0}, "steps must be at least 1"),
        (IMAGE, {"scheme": "best"}, "scheme must be"),
    ],
)
def test_decompose_image_refuses(image, arguments, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.decompose_image(image, **arguments)


def test_integers_and_constant_images_will_do():
    flow = spectral_tv.decompose_image((255 * IMAGE).astype(np.uint8), steps=4)
    assert flow.states.shape == (5, 12, 9)
    flow = spectral_tv.decompose_image(np.full((4, 5, 3), 7.0), steps=4)
    np.testing.assert_allclose(flow.states, 7, atol=1e-12)


def test_the_unit_of_the_values_does_not_matter():
    """Default times follow the contrast, so 8-bit and normalised images have the same bands."""
    one = spectral_tv.decompose_image(IMAGE, "surface", steps=8)
    other = spectral_tv.decompose_image(100 + 255 * IMAGE, "surface", steps=8)
    np.testing.assert_allclose(other.times, 255 * one.times, rtol=1e-12)
    np.testing.assert_allclose(
        other.bands(other.band_edges(3)), 255 * one.bands(one.band_edges(3)), atol=0.05
    )


def test_the_job_has_progress_can_be_cancelled_and_gives_the_flow():
    image = np.random.default_rng(1).random((200, 200))
    job = spectral_tv.start_decompose_image(image, steps=20_000)
    assert 0 <= job.progress < 1 and not job.done
    job.cancel()
    with pytest.raises(spectral_tv.Cancelled):
        job.result()
    seen: list[float] = []
    flow = spectral_tv.decompose_image(IMAGE, steps=6, progress=seen.append)
    assert seen[-1] == 1
    result = spectral_tv.start_decompose_image(IMAGE, steps=6).result()
    np.testing.assert_array_equal(result.states, flow.states)
