"""What is transparent takes no part in the filtering of an image."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from image_files import new, stored

filter_image = bpy.ops.spectral_tv.filter_image
LOW_PASS = {"preset": "GAINS", "gains": "0 0 0", "bands": 3, "steps": 12, "largest": 40.0}
SIDE = 40

pytestmark = pytest.mark.usefixtures("no_images")


def cover(radius: float) -> np.ndarray:
    """How much of each pixel a disc covers."""
    y, x = np.mgrid[:SIDE, :SIDE] - (SIDE - 1) / 2
    return np.clip(radius - np.hypot(x, y) + 0.5, 0, 1)


@pytest.mark.parametrize("is_float", [False, True])
@pytest.mark.parametrize("exact", [False, True])
def test_a_disc_of_one_color_on_nothing_keeps_its_color(is_float, exact):
    """Black and white under alpha 0 do not bleed into it, and stay; soft edges keep the color."""
    alpha = cover(14)
    pixels = np.full((SIDE, SIDE, 4), 0.8, dtype=np.float32)
    pixels[..., 3] = alpha
    pixels[alpha == 0, :3] = np.random.default_rng(0).choice([0, 1], size=((alpha == 0).sum(), 1))
    if is_float:
        pixels[..., :3] *= alpha[..., None]
    image = new("Disc", pixels, is_float, **({"alpha_mode": "PREMUL"} if is_float else {}))
    before = stored(image)
    assert filter_image(image="Disc", exact=exact, **LOW_PASS) == {"FINISHED"}
    after = stored(bpy.data.images["Disc Filtered"])
    np.testing.assert_array_equal(after[..., 3], before[..., 3])
    seen = alpha > 0
    colors = after[seen, :3] / (alpha[seen, None] if is_float else 1)
    assert np.abs(colors - 0.8).max() < 0.01
    if not is_float:
        np.testing.assert_array_equal(after[~seen], before[~seen])


@pytest.mark.parametrize("metric", ["FLAT", "SURFACE"])
@pytest.mark.parametrize("is_float", [False, True])
def test_the_rest_is_filtered_as_if_the_transparent_did_not_exist(metric, is_float):
    """A part of an image alone, and the same with nothing around it."""
    grey = np.random.default_rng(1).random((14, 17, 1)).astype(np.float32)
    part = np.concatenate([np.repeat(grey, 3, axis=2), np.ones_like(grey)], axis=2)
    whole = np.zeros((SIDE, SIDE, 4), dtype=np.float32)
    whole[5:19, 9:26] = part
    results = []
    for name, pixels in (("Part", part), ("Whole", whole)):
        new(name, pixels, is_float)
        filter_image(image=name, metric=metric, **LOW_PASS)
        results.append(stored(bpy.data.images[f"{name} Filtered"]))
    np.testing.assert_allclose(results[1][5:19, 9:26], results[0], atol=2e-3)
    assert np.abs(results[0] - part).max() > 0.1
    outside = np.ones((SIDE, SIDE), dtype=bool)
    outside[5:19, 9:26] = False
    assert (results[1][outside] == 0).all()


def test_islands_do_not_know_of_each_other():
    """A dark and a bright one: however far the flow goes, each keeps its own mean."""
    pixels = np.zeros((20, 30, 4), dtype=np.float32)
    noise = np.random.default_rng(2).uniform(-0.1, 0.1, (16, 12, 1))
    pixels[2:18, 2:14, :3], pixels[2:18, 16:28, :3] = 0.2 + noise, 0.8 + noise
    pixels[2:18, 2:14, 3] = pixels[2:18, 16:28, 3] = 1
    new("Islands", pixels, True)
    filter_image(image="Islands", **{**LOW_PASS, "largest": 1000.0, "steps": 24})
    after = stored(bpy.data.images["Islands Filtered"])[..., 0]
    for columns, mean in ((slice(2, 14), 0.2), (slice(16, 28), 0.8)):
        island = after[2:18, columns]
        assert island.mean() == pytest.approx(mean, abs=0.02)
        assert island.std() < 0.02


def test_light_that_covers_nothing_does_not_bleed_and_stays():
    """Around a disc, colors multiplied by alpha that are far brighter than alpha allows."""
    alpha = cover(10)
    pixels = np.zeros((SIDE, SIDE, 4), dtype=np.float32)
    pixels[..., :3] = 0.5 * alpha[..., None]
    glow = (alpha == 0) & (cover(16) > 0)
    pixels[..., 3] = np.where(glow, 0.01, alpha)
    pixels[glow, :3] = 3.0
    image = new("Glow", pixels, True, alpha_mode="PREMUL")
    filter_image(image="Glow", **LOW_PASS)
    after = stored(bpy.data.images["Glow Filtered"])
    np.testing.assert_allclose(after, stored(image), atol=1e-3)


def test_an_alpha_that_is_no_opacity_counts_nothing():
    """Packed channels are filtered wherever alpha is 0, as they are without it."""
    pixels = np.random.default_rng(3).random((16, 16, 4)).astype(np.float32)
    pixels[..., 3] = np.random.default_rng(4).choice([0, 1], size=(16, 16))
    new("Packed", pixels, alpha_mode="CHANNEL_PACKED")
    new("Plain", np.concatenate([pixels[..., :3], np.ones((16, 16, 1))], axis=2))
    results = []
    for name in ("Packed", "Plain"):
        filter_image(image=name, **LOW_PASS)
        results.append(stored(bpy.data.images[f"{name} Filtered"]))
    np.testing.assert_array_equal(results[0][..., :3], results[1][..., :3])
    np.testing.assert_array_equal(results[0][..., 3], pixels[..., 3])


@pytest.mark.parametrize(
    ("alpha", "told"),
    [
        (np.zeros((12, 12)), "all of it is transparent: there is nothing to filter"),
        (np.eye(12), "no four pixels that can be seen make a square: there is nothing to filter"),
    ],
)
def test_what_cannot_flow_stays_and_is_told(alpha, told, capfd):
    pixels = np.random.default_rng(5).random((12, 12, 4)).astype(np.float32)
    pixels[..., 3] = alpha
    image = new("Sparse", pixels)
    assert filter_image(image="Sparse", **LOW_PASS) == {"FINISHED"}
    np.testing.assert_array_equal(stored(bpy.data.images["Sparse Filtered"]), stored(image))
    assert f"Sparse: {told}" in capfd.readouterr().out


def test_one_color_stays_and_is_told(capfd):
    image = new("Plain", np.full((8, 8, 4), 0.25))
    assert filter_image(image="Plain", **LOW_PASS) == {"FINISHED"}
    np.testing.assert_array_equal(stored(bpy.data.images["Plain Filtered"]), stored(image))
    assert "Plain: all of its pixels are the same" in capfd.readouterr().out
