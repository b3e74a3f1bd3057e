"""bpy.ops.spectral_tv.filter_image: images in, images out."""

from __future__ import annotations

import time
from importlib import import_module

import bpy
import numpy as np
import pytest
import spectral_tv
from conftest import MODULE

filter_image = bpy.ops.spectral_tv.filter_image
SIDE = (36, 28)

pytestmark = pytest.mark.usefixtures("no_images")


def stored(image: bpy.types.Image) -> np.ndarray:
    flat = np.empty(image.size[0] * image.size[1] * image.channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    return flat.reshape(image.size[1], image.size[0], image.channels)


def discs(is_float: bool, name: str = "Photo") -> bpy.types.Image:
    """A large and a small disc of different colors on grey, half transparent on the left."""
    width, height = SIDE
    y, x = np.mgrid[:height, :width]
    pixels = np.full((height, width, 4), 0.25, dtype=np.float32)
    pixels[np.hypot(x - 12, y - 14) < 8] = (0.75, 0.5, 0.25, 1)
    pixels[np.hypot(x - 29, y - 14) < 2] = (0.25, 0.75, 0.5, 1)
    pixels[..., 3] = np.where(x < width // 2, 0.5, 1)
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=is_float)
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


@pytest.mark.parametrize("is_float", [False, True])
def test_bands_and_rest_add_up_to_the_image(is_float):
    image = discs(is_float)
    before, others = stored(image), {each.name for each in bpy.data.images}
    assert filter_image(image="Photo", result="BANDS", bands=3, steps=8) == {"FINISHED"}
    names = ["Photo Band 1", "Photo Band 2", "Photo Band 3", "Photo Rest"]
    assert {each.name for each in bpy.data.images} - others == set(names)
    parts = [bpy.data.images[name] for name in names]
    assert all(part.is_float and part.packed_file is not None for part in parts)
    total = sum(stored(part)[..., :3] for part in parts)
    np.testing.assert_allclose(total, before[..., :3], atol=1e-5)
    np.testing.assert_array_equal(stored(image), before)
    filter_image(image="Photo", result="BANDS", bands=2, steps=8)  # the third band goes
    left = {"Photo Band 1", "Photo Band 2", "Photo Rest"}
    assert {each.name for each in bpy.data.images} - others == left


def test_small_spots_vanish_and_large_ones_stay():
    image = discs(False)
    options = {"preset": "LOW_PASS", "bands": 2, "first": 2, "steps": 16, "exact": True}
    filter_image(image="Photo", finest=2.0, largest=30.0, **options)
    before, after = stored(image), stored(bpy.data.images["Photo Filtered"])
    assert not bpy.data.images["Photo Filtered"].is_float
    small, large, ground = ((14, 29), (14, 12), (2, 2))
    kept = [
        np.abs(after[at][:3] - after[ground][:3]).sum()
        / np.abs(before[at][:3] - before[ground][:3]).sum()
        for at in (small, large)
    ]
    assert kept[0] < 0.25 and kept[1] > 0.7
    np.testing.assert_array_equal(after[..., 3], before[..., 3])


def test_running_again_starts_from_the_source_and_replaces():
    image = discs(False)
    for preset in ("HIGH_PASS", "BAND_STOP"):
        filter_image(image="Photo", preset=preset, bands=3, steps=8)
    assert len(bpy.data.images) == 2
    once = stored(bpy.data.images["Photo Filtered"])
    bpy.data.images.remove(bpy.data.images["Photo Filtered"])
    filter_image(image="Photo", preset="BAND_STOP", bands=3, steps=8)
    np.testing.assert_array_equal(stored(bpy.data.images["Photo Filtered"]), once)
    assert bpy.data.images["Photo Filtered"].spectral_tv.source == image


def test_luminance_changes_all_channels_alike():
    image = discs(True)
    filter_image(
        image="Photo", channels="LUMINANCE", preset="GAINS", gains="0 2 1", bands=3, steps=8
    )
    change = (stored(bpy.data.images["Photo Filtered"]) - stored(image))[..., :3]
    assert np.abs(change).max() > 0.05
    np.testing.assert_allclose(change, change[..., :1] + 0 * change, atol=1e-6)


def test_without_the_rest_values_may_be_negative():
    discs(False)
    filter_image(image="Photo", preset="HIGH_PASS", bands=3, steps=8, keep_rest=False)
    result = bpy.data.images["Photo Filtered"]
    assert result.is_float and stored(result)[..., :3].min() < -0.01
    assert result.colorspace_settings.is_data


def test_it_is_the_package_on_the_stored_values():
    image = discs(False)
    filter_image(
        image="Photo", result="BANDS", bands=2, steps=6, metric="SURFACE", height=10,
        finest=0.5, largest=20,
    )  # fmt: skip
    values = stored(image)[..., :3].astype(float)
    contrast = np.linalg.norm(np.ptp(values, axis=(0, 1)))
    times = spectral_tv.graded_times(contrast * 0.5 / 4, contrast * 20 / 4, 6)
    flow = spectral_tv.decompose_image(values, "surface", times, height=10)
    band = flow.bands(flow.band_edges(2))[0]
    np.testing.assert_allclose(stored(bpy.data.images["Photo Band 1"])[..., :3], band, atol=1e-6)


def test_results_survive_saving(tmp_path):
    discs(True)
    filter_image(image="Photo", bands=3, steps=8)
    expected = stored(bpy.data.images["Photo Filtered"])
    path = str(tmp_path / "images.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    np.testing.assert_allclose(stored(bpy.data.images["Photo Filtered"]), expected, atol=2e-3)


def test_refusals():
    discs(True)
    bpy.data.images.new("Dot", 1, 1)
    broken = discs(True, "Broken")
    broken.pixels[4 * (3 * SIDE[0] + 5)] = np.nan
    movie = bpy.data.images.new("Movie", 8, 8)
    movie.source = "MOVIE"
    for options, message in (
        ({"image": "Nothing"}, "there is no image 'Nothing'"),
        ({}, "no image; open one in the Image Editor"),
        ({"image": "Dot"}, "Dot has 1 × 1 pixels, but 2 × 2 are needed"),
        ({"image": "Movie"}, "Movie is a movie; open one of its frames"),
        ({"image": "Broken"}, "Broken: the pixel at 5, 3 from the lower left is not a finite"),
        ({"image": "Photo", "bands": 8, "steps": 8}, "8 bands need more than 8 steps"),
        ({"image": "Photo", "finest": 5, "largest": 5}, "finest size is not below the largest"),
        ({"image": "Photo", "preset": "GAINS", "gains": "1 2"}, "5 bands need as many gains"),
    ):
        with pytest.raises(RuntimeError, match=message):
            filter_image(**options)
    assert not any("Filtered" in image.name for image in bpy.data.images)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"tiled": True}, "Other has several tiles .UDIM.; open one of them by itself"),
        ({"stereo3d": True}, "Other has several views; save one of them as an image"),
        ("SEQUENCE", "Other is a sequence of images; open one of them by itself"),
    ],
)
def test_images_that_are_no_single_picture_are_refused(settings, message):
    options = settings if isinstance(settings, dict) else {}
    image = bpy.data.images.new("Other", 8, 8, **options)
    if not options:
        image.source = settings
    with pytest.raises(RuntimeError, match=message):
        filter_image(image="Other")
    assert len(bpy.data.images) == 1


def test_the_result_of_a_render_is_refused():
    scene = bpy.context.scene
    bpy.ops.object.camera_add()
    scene.camera, scene.render.engine = bpy.context.object, "CYCLES"
    scene.cycles.samples, scene.render.resolution_x, scene.render.resolution_y = 1, 8, 8
    bpy.ops.render.render()
    with pytest.raises(RuntimeError, match="Render Result is what a render or a node shows"):
        filter_image(image="Render Result")


def test_the_job_of_a_window_is_polled_and_notices_changes():
    """What a window runs in a thread gives the same; a changed image is not the same subject."""
    jobs = import_module(f"{MODULE}.job.jobs")
    bands = import_module("spectral_tv.images.bands")
    results = import_module(f"{MODULE}.images.results")
    sources = import_module(f"{MODULE}.images.sources")
    image = discs(True)
    choice = bpy.context.scene.spectral_tv_images.settings()
    prepared = bands.prepare(sources.read(image), choice)
    jobs.start(prepared.request.start(), image.name, sources.state_of(image), "Flowing")
    while not jobs.running().job.done:
        time.sleep(0.01)
    assert jobs.running().state == sources.state_of(image)
    names = results.write(image, prepared, jobs.running().job.result())
    assert names == ["Photo Filtered"]
    image.pixels[0] = 0.9
    assert jobs.running().state != sources.state_of(image)
    jobs.finish()
