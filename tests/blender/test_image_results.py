"""Which images are results: what the user made, copied or changed is never written over."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
import pytest
from conftest import MODULE
from image_files import fill, new, stored

filter_image = bpy.ops.spectral_tv.filter_image
source_of = import_module(f"{MODULE}.images.results").source_of
SMALL = {"bands": 2, "steps": 4}
BANDS = {"result": "BANDS", "steps": 6}

pytestmark = pytest.mark.usefixtures("no_images")


@pytest.fixture
def image() -> bpy.types.Image:
    return new("I", np.random.default_rng(0).random((12, 14, 4)) * [1, 1, 1, 0] + [0, 0, 0, 1])


def filtered(gains: str = "0 0") -> set[str]:
    """Filter I, and return the names of the images that there are then."""
    assert filter_image(image="I", preset="GAINS", gains=gains, **SMALL) == {"FINISHED"}
    return set(bpy.data.images.keys())


def test_a_copy_of_a_result_stays_and_the_result_is_written_over(image):
    filtered("0 0")
    first = stored(bpy.data.images["I Filtered"])
    bpy.data.images["I Filtered"].copy().name = "A"
    assert filtered("1 1") == {"I", "I Filtered", "A"}
    np.testing.assert_array_equal(stored(bpy.data.images["A"]), first)
    np.testing.assert_allclose(stored(bpy.data.images["I Filtered"]), stored(image), atol=1e-6)


def test_a_copy_stays_where_the_result_itself_is_gone(image):
    filtered()
    copy = bpy.data.images["I Filtered"].copy()
    copy.name = "Keep"
    kept = stored(copy)
    bpy.data.images.remove(bpy.data.images["I Filtered"])
    assert filtered("1 1") == {"I", "I Filtered", "Keep"}
    np.testing.assert_array_equal(stored(bpy.data.images["Keep"]), kept)


def test_a_copy_that_has_the_name_of_the_result_is_not_the_result(image):
    filtered()
    result = bpy.data.images["I Filtered"]
    copy = result.copy()
    result.name, copy.name = "Mine", "I Filtered"
    kept = stored(copy)
    assert filtered("1 1") == {"I", "I Filtered", "Mine"}
    np.testing.assert_array_equal(stored(bpy.data.images["I Filtered"]), kept)
    np.testing.assert_allclose(stored(bpy.data.images["Mine"]), stored(image), atol=1e-6)


def test_an_image_of_the_users_that_has_the_name_stays(image):
    own = new("I Filtered", np.full((12, 14, 4), 0.5))
    assert filtered() == {"I", "I Filtered", "I Filtered.001"}
    assert (np.abs(stored(own) - 0.5) < 0.01).all()


@pytest.mark.parametrize("packs", [False, True])
def test_a_result_that_was_painted_over_stays_and_is_told(image, packs, capfd):
    filtered()
    result = bpy.data.images["I Filtered"]
    painted = stored(result)
    painted[2:5, 2:5, :3] = (1, 0, 0)
    fill(result, painted)
    if packs:
        result.pack()
    assert filtered("1 1") == {"I", "I Filtered", "I Filtered.001"}
    np.testing.assert_allclose(stored(result), painted, atol=0.5 / 255)
    assert "I: 'I Filtered' was changed since, and is kept" in capfd.readouterr().out
    assert filtered("0 1") == {"I", "I Filtered", "I Filtered.001"}
    np.testing.assert_allclose(stored(result), painted, atol=0.5 / 255)


def test_copies_of_bands_stay_where_bands_become_fewer(image, capfd):
    filter_image(image="I", bands=3, **BANDS)
    bpy.data.images["I Band 3"].copy().name = "Third"
    bpy.data.images["I Band 1"].copy()
    filter_image(image="I", bands=2, **BANDS)
    names = set(bpy.data.images.keys())
    assert names == {"I", "I Band 1", "I Band 1.001", "I Band 2", "I Rest", "Third"}
    assert "is kept" not in capfd.readouterr().out


def test_a_surplus_band_that_is_used_stays_and_is_told(image, capfd):
    filter_image(image="I", bands=3, **BANDS)
    texture = bpy.data.textures.new("Texture", "IMAGE")
    texture.image = bpy.data.images["I Band 3"]
    filter_image(image="I", bands=2, **BANDS)
    assert texture.image.name == "I Band 3"
    assert "'I Band 3' is of an earlier run; it is used, and is kept" in capfd.readouterr().out
    bpy.data.textures.remove(texture)


def test_results_are_known_in_all_scenes_and_after_saving(image, tmp_path):
    filtered()
    bpy.data.images["I Filtered"].name = "Renamed"
    other = bpy.data.scenes.new("Other")
    with bpy.context.temp_override(scene=other):
        assert filtered("1 1") == {"I", "Renamed"}
    bpy.data.scenes.remove(other)
    path = str(tmp_path / "images.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert filtered("0 0") == {"I", "Renamed"}
    assert source_of(bpy.data.images["Renamed"]) == bpy.data.images["I"]


def test_a_copied_scene_knows_them_too(image, capfd):
    filtered()
    copy = bpy.context.scene.copy()
    assert filtered("0 1") == {"I", "I Filtered"}
    with bpy.context.temp_override(scene=copy):
        assert filtered("1 1") == {"I", "I Filtered"}
    assert "is kept" not in capfd.readouterr().out
    bpy.data.scenes.remove(copy)


def test_a_copy_of_the_source_has_results_of_its_own(image):
    filtered()
    first = stored(bpy.data.images["I Filtered"])
    copy = image.copy()
    copy.name = "J"
    assert filter_image(image="J", preset="GAINS", gains="1 1", **SMALL) == {"FINISHED"}
    assert set(bpy.data.images.keys()) == {"I", "I Filtered", "J", "J Filtered"}
    np.testing.assert_array_equal(stored(bpy.data.images["I Filtered"]), first)


def test_what_an_image_was_written_of_is_known_while_both_are_there(image):
    """A copy, or a result whose source was cleared or removed, is an image like any other."""
    filtered()
    result = bpy.data.images["I Filtered"]
    copy = result.copy()
    assert source_of(result) == image
    assert source_of(image) is None and source_of(copy) is None
    result.spectral_tv.source = None
    assert source_of(result) is None
    assert "I Filtered.002" in filtered()
    again = bpy.data.images["I Filtered.002"]
    bpy.data.images.remove(image)
    assert source_of(again) is None
    assert filter_image(image="I Filtered.002", preset="GAINS", gains="1 1", **SMALL)
    assert "I Filtered.002 Filtered" in bpy.data.images


def test_a_result_of_another_size_takes_the_place_of_the_former_everywhere(image):
    filtered()
    texture = bpy.data.textures.new("Texture", "IMAGE")
    texture.image = bpy.data.images["I Filtered"]
    image.scale(9, 11)
    assert filtered() == {"I", "I Filtered"}
    assert tuple(texture.image.size) == (9, 11)
    bpy.data.textures.remove(texture)


def test_long_names_leave_room_for_what_an_image_is():
    new("x" * 63, np.random.default_rng(0).random((8, 8, 4)))
    filter_image(image="x" * 63, bands=2, **BANDS)
    names = {image.name[-6:] for image in bpy.data.images}
    assert names == {"x" * 6, "Band 1", "Band 2", "x Rest"}
