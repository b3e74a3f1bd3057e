"""Images in Blender, in every color space: bands of what is seen, in the values of the file."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from image_files import fill, new, raw, stored, write_png16

filter_image = bpy.ops.spectral_tv.filter_image
KEEP = {"preset": "GAINS", "gains": "1 1", "bands": 2, "steps": 4}
HALVE = {"preset": "GAINS", "gains": "0.5 1", "bands": 2, "steps": 4}
SPACES = bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items.keys()
HALF_STEP = 0.501 / 65535

pytestmark = pytest.mark.usefixtures("no_images")


def noise(side: int = 12) -> np.ndarray:
    """Values of 16 bits, (H, W, 4), some of them transparent and half transparent."""
    rng = np.random.default_rng(0)
    found = rng.random((side, side + 3, 4))
    found[..., 3] = rng.choice([0, 0.25, 0.5, 1], size=found.shape[:2])
    return np.rint(65535 * found) / 65535


@pytest.mark.parametrize("space", SPACES)
def test_a_file_of_16_bits_comes_back_in_every_color_space(space, tmp_path):
    """What is seen, and what is in the file; so it does after the .blend was saved and opened."""
    values = noise()
    image = bpy.data.images.load(str(write_png16(tmp_path / "noise.png", values[::-1])))
    image.colorspace_settings.name = space
    name, seen = image.name, stored(image)
    assert filter_image(image=name, **KEEP) == {"FINISHED"}
    result = bpy.data.images[f"{name} Filtered"]
    assert result.colorspace_settings.name == space
    assert result.is_float
    np.testing.assert_allclose(stored(result), seen, rtol=1e-6, atol=1e-6)
    assert np.abs(raw(result) - values).max() < HALF_STEP
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "images.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "images.blend"))
    again = stored(bpy.data.images[f"{name} Filtered"])
    np.testing.assert_allclose(again, seen, rtol=1e-6, atol=1e-6)


def test_it_is_filtered_in_the_values_of_its_file(tmp_path):
    """Halving a band does to 16 bits what it does to the same values as data."""
    values = noise()
    values[..., 3] = 1
    path = str(write_png16(tmp_path / "noise.png", values[::-1]))
    seen, data = bpy.data.images.load(path), bpy.data.images.load(path)
    data.colorspace_settings.is_data = True
    found = []
    for image in (seen, data):
        filter_image(image=image.name, **HALVE)
        found.append(raw(bpy.data.images[f"{image.name} Filtered"]))
    np.testing.assert_allclose(found[0], found[1], atol=1e-6)
    assert np.abs(found[0] - values).max() > 0.01


def test_a_result_of_16_bits_is_saved_as_what_it_was(tmp_path):
    values = noise()
    image = bpy.data.images.load(str(write_png16(tmp_path / "noise.png", values[::-1])))
    filter_image(image=image.name, **KEEP)
    result = bpy.data.images[f"{image.name} Filtered"]
    result.file_format = "PNG"
    result.save(filepath=str(tmp_path / "saved.png"))
    saved = raw(bpy.data.images.load(str(tmp_path / "saved.png")))
    # As near as Blender comes to a file that it has only read; with soft alpha that is not near.
    opaque = values[..., 3] == 1
    assert np.abs(saved - values)[opaque].max() < 3e-5


@pytest.mark.parametrize("space", ["sRGB", "Non-Color", "Linear Rec.709", "ACEScg", "Filmic sRGB"])
@pytest.mark.parametrize("mode", ["STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"])
def test_a_file_of_8_bits_comes_back_whatever_its_settings(space, mode, tmp_path):
    """Also after the result was read anew from what is packed."""
    values = np.rint(255 * noise()) / 255
    image = new("Noise", values)
    image.filepath_raw, image.file_format = str(tmp_path / "noise.png"), "PNG"
    image.save()
    bpy.data.images.remove(image)
    image = bpy.data.images.load(str(tmp_path / "noise.png"))
    image.colorspace_settings.name, image.alpha_mode = space, mode
    seen = stored(image)
    filter_image(image=image.name, **KEEP)
    result = bpy.data.images[f"{image.name} Filtered"]
    assert result.colorspace_settings.name == space and not result.is_float
    result.buffers_free()
    np.testing.assert_array_equal(stored(result), seen)


@pytest.mark.parametrize("space", ["sRGB", "Non-Color", "ACEScg", "Filmic sRGB"])
def test_a_generated_image_with_floats_comes_back(space):
    """What Blender holds of it is scene-linear, whatever its color space is."""
    pixels = noise() * [0.4, 0.3, 0.5, 1]
    pixels[..., :3] *= pixels[..., 3:]
    image = bpy.data.images.new("Floats", 15, 12, alpha=True, float_buffer=True)
    image.colorspace_settings.name = space
    fill(image, pixels)
    seen = stored(image)
    filter_image(image="Floats", **KEEP)
    result = stored(bpy.data.images["Floats Filtered"])
    np.testing.assert_allclose(result, seen, atol=2e-4)
    np.testing.assert_array_equal(result[..., 3], seen[..., 3])


@pytest.mark.parametrize("is_deep", [False, True])
def test_what_is_painted_and_not_saved_is_filtered(is_deep, tmp_path):
    values = noise()
    values[..., 3] = 1
    if is_deep:
        image = bpy.data.images.load(str(write_png16(tmp_path / "noise.png", values[::-1])))
    else:
        image = new("Noise", values)
    painted = stored(image)
    painted[3:6, 4:9, :3] = (0.9, 0.1, 0.2)
    fill(image, painted)
    assert image.is_dirty
    filter_image(image=image.name, **KEEP)
    result = stored(bpy.data.images[f"{image.name} Filtered"])
    np.testing.assert_allclose(result, stored(image), atol=1e-4)
    np.testing.assert_allclose(stored(image), painted, atol=0.5 / 255)


def test_bands_of_premultiplied_colors_add_up_to_them():
    pixels = noise()
    pixels[..., :3] *= pixels[..., 3:]
    image = new("Soft", pixels, True, alpha_mode="PREMUL")
    filter_image(image="Soft", result="BANDS", bands=2, steps=6)
    names = ["Soft Band 1", "Soft Band 2", "Soft Rest"]
    total = sum(stored(bpy.data.images[name])[..., :3] for name in names)
    np.testing.assert_allclose(total, stored(image)[..., :3], atol=1e-5)


def test_how_many_pixels_were_cut_off_is_told_and_floats_keep_them(capfd):
    values = noise()
    values[..., 3] = 1
    for is_float in (False, True):
        new("Float" if is_float else "Byte", values, is_float)
    strong = {**KEEP, "gains": "6 6"}
    filter_image(image="Byte", **strong)
    cut = stored(bpy.data.images["Byte Filtered"])
    assert cut.min() == 0 and cut.max() == 1
    assert "pixels of 'Byte Filtered' were cut off at black and white" in capfd.readouterr().out
    filter_image(image="Float", **strong)
    kept = stored(bpy.data.images["Float Filtered"])
    assert kept.min() < -0.05 and kept.max() > 1.05
    assert "cut off" not in capfd.readouterr().out
