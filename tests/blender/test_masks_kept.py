"""What becomes of masks where bands are cut, replaced, renamed, applied, written back and saved."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from ball import ball, saved_and_loaded
from deform_scene import evaluated, key_positions
from masked_ball import BANDS, MASKS, SMALL, heights, keys, mask, own, paint, select, weights
from sculpted_head import at_rest, sculpted_head

OPS = bpy.ops.spectral_tv
MASK = MASKS[1]


@pytest.fixture
def masked():
    """A ball with three bands, the second one at 1.5 and masked where z > 0."""
    obj = ball("Ball")
    OPS.decompose(**SMALL)
    keys(obj)[BANDS[1]].value = 1.5
    select(obj, heights(obj) > 0)
    OPS.fill_mask(band=2)
    return obj


def test_each_band_cut_of_a_masked_one_has_a_mask_of_its_own(masked):
    before, seen = mask(masked), evaluated(masked)
    OPS.cut(bands=6)
    masks = [key.vertex_group for key in keys(masked)][1:]
    names = [key.name for key in keys(masked)][1:]
    found = [index for index, name in enumerate(masks) if name]
    assert found == [2, 3]
    assert [masks[index] for index in found] == [f"{names[index]} Mask" for index in found]
    assert {*own(masked)} == {masks[index] for index in found}
    for index in found:
        np.testing.assert_array_equal(weights(masked, masks[index]), before)
    np.testing.assert_allclose(evaluated(masked), seen, atol=2e-6)
    paint(masked, masks[2], range(20))
    assert weights(masked, masks[3])[:20].any()
    OPS.cut(bands=3)
    assert keys(masked)[BANDS[1]].vertex_group == MASK


def test_a_band_in_the_place_of_several_has_the_mean_of_their_masks(masked, capfd):
    """Of values times masks; the former masks stay as groups."""
    for band, value in ((1, 1.0), (3, 0.5)):
        keys(masked)[band].value = value
    OPS.paint_mask(band=3, weight=0.25)
    OPS.paint_mask(band=3)
    record = masked.data.spectral_tv.decompositions[0]
    ends = [band.end for band in record.bands]
    counts = np.diff([0, *np.searchsorted(record.kept_spectrum[:, 0], ends)])
    up = mask(masked)
    capfd.readouterr()
    OPS.cut(bands=1)
    (key,) = [*keys(masked)][1:]
    value = counts @ [1, 1.5, 0.5] / counts.sum()
    assert key.value == pytest.approx(value, rel=1e-5)
    expected = (counts[0] + 1.5 * counts[1] * up + 0.5 * 0.25 * counts[2]) / counts.sum() / value
    np.testing.assert_allclose(weights(masked, key.vertex_group), expected, atol=1e-5)
    said = capfd.readouterr().out
    assert f"has the mean of the masks of {', '.join(map(repr, BANDS))}" in said
    assert f"stay as vertex groups: {MASK}, {BANDS[2]} Mask" in said
    assert own(masked) == [key.vertex_group] == [MASKS[0]]
    np.testing.assert_array_equal(weights(masked, MASK), up)


def test_masks_change_places_with_their_bands(masked):
    """Where each takes the name that another one had."""
    OPS.copy_mask(band=2)
    for band in (1, 2, 3):
        paint(masked, MASKS[band - 1], [0], band / 4)
    there = keys(masked)
    for key, name in ((there[1], "Spare"), (there[2], BANDS[0]), (there[1], BANDS[1])):
        key.name = name
    OPS.decompose(bands=3, steps=12)
    assert {*masked.vertex_groups.keys()} == {
        "Cap",
        *MASKS,
    }
    for key in [*keys(masked)][1:]:
        assert key.vertex_group == f"{key.name} Mask"
    assert mask(masked, 1)[0] == pytest.approx(0.5) and mask(masked, 2)[0] == pytest.approx(0.25)


def test_replacing_and_keeping_limbs_keep_masks(masked):
    before = mask(masked)
    OPS.decompose(bands=3, steps=12)
    assert keys(masked)[BANDS[1]].vertex_group == MASK and own(masked) == [MASK]
    np.testing.assert_array_equal(mask(masked), before)
    masked.data.spectral_tv_limbs.keep = 0.25
    assert keys(masked)[BANDS[1]].vertex_group == MASK
    OPS.decompose(bands=2, steps=12, vertex_group="Cap")
    assert [key.vertex_group for key in keys(masked)][1:] == ["Cap", "Cap"]
    assert MASK in masked.vertex_groups and own(masked) == []


def test_masks_follow_the_name_of_their_decomposition(masked):
    before = mask(masked)
    OPS.choose_mask(band=1, group="Cap")
    OPS.choose_mask(band=3, group=MASK)
    masked.data.spectral_tv.decompositions[0].name = "Skin"
    assert [key.vertex_group for key in keys(masked)][1:] == ["Cap", *2 * ["Skin Band 2 Mask"]]
    assert own(masked) == ["Skin Band 2 Mask"] and MASK not in masked.vertex_groups
    np.testing.assert_array_equal(weights(masked, "Skin Band 2 Mask"), before)


@pytest.mark.parametrize("place", ["HERE", "COPY"])
def test_the_look_is_applied_within_masks_which_stay_as_groups(masked, place, capfd):
    seen, before = evaluated(masked), mask(masked)
    OPS.apply_look(place=place)
    obj = bpy.context.active_object
    np.testing.assert_allclose(evaluated(obj), seen, atol=2e-6)
    assert f"which stay as vertex groups: {MASK}" in capfd.readouterr().out
    np.testing.assert_array_equal(weights(obj, MASK), before)
    assert own(obj) == [] and (own(masked) == [MASK]) == (place == "COPY")
    # It can be chosen for new bands.
    OPS.decompose(**SMALL)
    OPS.choose_mask(band=1, group=MASK)
    np.testing.assert_array_equal(mask(obj, 1), before)


def test_removing_the_decomposition_leaves_masks_as_groups(masked, capfd):
    OPS.remove_decomposition()
    assert f"which stay as vertex groups: {MASK}" in capfd.readouterr().out
    assert MASK in masked.vertex_groups and own(masked) == []


def test_bake_mix_bake_safe_and_folds_heed_masks(masked):
    seen = evaluated(masked)
    OPS.bake()
    np.testing.assert_allclose(key_positions(masked, "Filtered"), seen, atol=2e-6)
    OPS.bake_safe(stretch=100)
    np.testing.assert_allclose(key_positions(masked, "Safe"), seen, atol=2e-6)


def test_bands_are_taken_from_another_object_within_masks(masked):
    other = ball("Other")
    for vertex in other.data.vertices:
        vertex.co *= 1 + 0.05 * np.sin(20 * vertex.co.x)
    OPS.decompose(**SMALL)
    masked.select_set(True)
    bpy.context.view_layer.objects.active = masked
    below = heights(masked) <= 0
    bare = key_positions(masked, "Basis")
    OPS.take_bands(first=2, last=2)
    assert keys(masked)[f"Other {BANDS[1]}"].vertex_group == MASK
    moved = np.abs(evaluated(masked) - bare).max(axis=1)
    assert moved[below].max() < 1e-6
    assert moved[~below].max() > 1e-3


def test_a_masked_work_object_is_written_back_into_the_levels():
    head = sculpted_head()
    before = at_rest(head, 3)
    OPS.work_object()
    work = bpy.context.object
    OPS.decompose(**SMALL)
    keys(work)[3].value = 1
    select(work, heights(work) > 0)
    OPS.fill_mask(band=3)
    seen = evaluated(work)
    assert OPS.write_back() == {"FINISHED"}
    after = at_rest(head, 3)
    np.testing.assert_allclose(after, seen, atol=1e-4)
    moved = np.abs(after - before).max(axis=1)
    below = before[:, 2] < -0.01
    assert moved[below].max() < 1e-4
    assert moved[~below].max() > 0.03


def test_a_modifier_is_applied_with_its_masks(masked):
    masked.modifiers.new("Subdivision", "SUBSURF")
    seen = evaluated(masked)
    OPS.apply_modifier(modifier="Subdivision")
    assert keys(masked)[BANDS[1]].vertex_group == MASK and own(masked) == [MASK]
    assert len(masked.data.vertices) == len(seen)
    OPS.invert_mask(band=2)
    assert masked.vertex_groups.keys() == ["Cap", MASK]


def test_a_file_keeps_masks_and_that_they_were_made(masked, tmp_path: Path):
    before = mask(masked)
    obj = saved_and_loaded(masked, tmp_path / "masked.blend")
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    np.testing.assert_array_equal(mask(obj), before)
    OPS.invert_mask(band=2)
    assert obj.vertex_groups.keys() == ["Cap", MASK]
    OPS.remove_mask(band=2)
    assert obj.vertex_groups.keys() == ["Cap"]
