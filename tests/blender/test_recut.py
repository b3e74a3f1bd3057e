"""Cut Again: what was set of the bands goes over to the new ones, and nothing old is left."""

from __future__ import annotations

import warnings
from importlib import import_module

import bpy
import numpy as np
import pytest
from ball import bumpy_ball
from conftest import MODULE

STEPS = 13  # twelve components, so that 2, 3, 4, 6 and 12 bands are of equal numbers
SIX = [f"Shape Detail Band {band}" for band in range(1, 7)]


def actions(keys: bpy.types.Key) -> list:
    channels = import_module(f"{MODULE}.scene.channels")
    return channels.actions_of(keys)


def curves(keys: bpy.types.Key) -> dict[str, bpy.types.FCurve]:
    found = [curve for each in actions(keys) for curve in each.curves or ()]
    return {curve.data_path: curve for curve in found}


def path(name: str, what: str = "value") -> str:
    return f'key_blocks["{name}"].{what}'


def cut(obj, bands: int) -> dict[str, bpy.types.ShapeKey]:
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.spectral_tv.cut(bands=bands) == {"FINISHED"}
    return {key.name: key for key in obj.data.shape_keys.key_blocks if "Band" in key.name}


@pytest.fixture
def banded():
    """A bumpy ball with six bands, of two components each."""
    obj = bumpy_ball()
    bpy.ops.spectral_tv.decompose(bands=6, steps=STEPS)
    bpy.ops.spectral_tv.widen_sliders()
    return obj


@pytest.fixture
def keys(banded):
    return banded.data.shape_keys.key_blocks


def told(capfd) -> str:
    return capfd.readouterr().out


def test_values_are_means_of_those_that_were_there(banded, keys):
    before = [-1, 0, 0.5, 2, 3, 4]
    for name, value in zip(SIX, before, strict=True):
        keys[name].value = value
    assert [key.value for key in cut(banded, 3).values()] == pytest.approx([-0.5, 1.25, 3.5])
    halves = [-0.5, -0.5, 1.25, 1.25, 3.5, 3.5]
    assert [key.value for key in cut(banded, 6).values()] == pytest.approx(halves)
    # Components 1 to 3 and 4 to 6 of twelve, so that the second of six bands is shared.
    for key, value in zip(cut(banded, 6).values(), before, strict=True):
        key.value = value
    quarters = [-2 / 3, 1 / 3, (2 * 2 + 3) / 3, (3 + 2 * 4) / 3]
    assert [key.value for key in cut(banded, 4).values()] == pytest.approx(quarters)


def test_the_same_number_of_bands_changes_nothing(banded, keys):
    for number, name in enumerate(SIX):
        keys[name].value = number
        keys[name].keyframe_insert("value", frame=number)
    keys[SIX[2]].name = "Wrinkles"
    before = [(key.name, key.value) for key in keys], set(curves(keys.id_data))
    cut(banded, 6)
    assert ([(key.name, key.value) for key in keys], set(curves(keys.id_data))) == before


def test_masks_mutes_locks_and_slider_ranges_go_over(banded, keys, capfd):
    banded.vertex_groups.new(name="Half").add(range(80), 1, "REPLACE")
    for name in SIX[:2]:
        keys[name].vertex_group, keys[name].mute, keys[name].value = "Half", True, 2
    keys[SIX[2]].vertex_group = "Cap"
    keys[SIX[3]].slider_min, keys[SIX[3]].value = -3, 5
    keys[SIX[3]].vertex_group = "Cap"
    keys[SIX[4]].lock_shape = keys[SIX[5]].lock_shape = True
    keys[SIX[5]].mute, keys[SIX[5]].value, keys[SIX[4]].value = True, 7, 4
    fine, middle, coarse = cut(banded, 3).values()
    assert (fine.vertex_group, fine.mute, fine.value) == ("Half", True, 2)
    assert (middle.vertex_group, middle.mute, middle.value) == ("Cap", False, 2.5)
    assert middle.slider_min == -10 and fine.slider_max == 10
    # The muted one was not seen, and so counts for nothing.
    assert (coarse.mute, coarse.value, coarse.lock_shape) == (False, 2, True)
    assert "'Shape Detail Band 3' is in the place of muted bands too" in told(capfd)
    cut(banded, 1)
    old = "'Shape Detail Band 1', 'Shape Detail Band 2'"
    assert f"'Shape Detail Band 1' has the mean of the masks of {old}" in told(capfd)


def test_what_the_new_bands_cannot_have_is_told(banded, keys, capfd):
    """Locks that differ, names that were given, and values that become their mean."""
    for name, value in zip(SIX, (-1, -1, -1, 1, 1, 1), strict=True):
        keys[name].value = value
    keys[SIX[1]].lock_shape = True
    keys[SIX[3]].name = "Wrinkles"
    told(capfd)
    _, middle, _ = cut(banded, 3).values()
    assert middle.value == pytest.approx(0)
    text = told(capfd)
    assert (
        "'Shape Detail Band 1', 'Shape Detail Band 2', whose locks differ; it has what "
        "'Shape Detail Band 1' had" in text
    )
    assert "'Wrinkles' went into 'Shape Detail Band 2'" in text
    assert "the mean of other values, so that the shape is another: 'Shape Detail Band 2' (" in text


def test_the_shape_that_is_seen_stays_where_bands_are_split(banded, keys):
    def seen() -> np.ndarray:
        graph = bpy.context.evaluated_depsgraph_get()
        return np.array([v.co for v in banded.evaluated_get(graph).data.vertices])

    for name, value in zip(SIX, (1, -1, 0.5, 2, -3, 1), strict=True):
        keys[name].value = value
        keys[name].vertex_group = "Cap"
    keys[SIX[4]].mute = True
    before = seen()
    cut(banded, 12)
    np.testing.assert_allclose(seen(), before, atol=1e-5)


def animate(key, frames, values, interpolation="BEZIER", handles="AUTO_CLAMPED") -> None:
    for frame, value in zip(frames, values, strict=True):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    for point in curves(key.id_data)[path(key.name)].keyframe_points:
        point.interpolation = interpolation
        point.handle_left_type = point.handle_right_type = handles
    curves(key.id_data)[path(key.name)].update()


def sampled(keys, name) -> np.ndarray:
    frames = np.arange(-5, 60, 0.25)
    return np.array([curves(keys.id_data)[path(name)].evaluate(frame) for frame in frames])


def test_a_curve_that_is_split_is_copied_as_it_is(banded, keys):
    animate(keys[SIX[1]], (1, 10, 40), (0, 3, -1), handles="AUTO")
    curve = curves(keys.id_data)[path(SIX[1])]
    curve.extrapolation = "LINEAR"
    curve.keyframe_points[1].interpolation = "BOUNCE"
    curve.modifiers.new("CYCLES").cycles_after = 3
    curve.update()
    before = sampled(keys, SIX[1])
    cut(banded, 12)
    assert set(curves(keys.id_data)) == {path("Shape Detail Band 3"), path("Shape Detail Band 4")}
    for name in ("Shape Detail Band 3", "Shape Detail Band 4"):
        np.testing.assert_allclose(sampled(keys, name), before, atol=1e-6)
        copied = curves(keys.id_data)[path(name)]
        assert [point.interpolation for point in copied.keyframe_points] == [
            "BEZIER", "BOUNCE", "BEZIER",
        ]  # fmt: skip
        assert copied.modifiers[0].cycles_after == 3


@pytest.mark.parametrize("interpolation", ["BEZIER", "LINEAR", "CONSTANT"])
def test_curves_on_the_same_frames_are_joined_exactly(banded, keys, interpolation):
    animate(keys[SIX[0]], (1, 10, 40), (0, 3, -1), interpolation, "AUTO")
    animate(keys[SIX[1]], (1, 10, 40), (1, -2, 5), interpolation, "AUTO")
    expected = (sampled(keys, SIX[0]) + sampled(keys, SIX[1])) / 2
    cut(banded, 3)
    np.testing.assert_allclose(sampled(keys, SIX[0]), expected, atol=1e-5)
    assert len(curves(keys.id_data)[path(SIX[0])].keyframe_points) == 3
    assert set(curves(keys.id_data)) == {path(SIX[0])}


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (("BEZIER", (1, 10, 40)), ("BEZIER", (5, 20))),
        (("LINEAR", (1, 10, 40)), ("LINEAR", (5, 20, 55))),
        (("CONSTANT", (1, 10, 40)), ("CONSTANT", (5, 20, 55))),
        (("CONSTANT", (1, 10, 40)), ("LINEAR", (5, 20, 55))),
        (("CONSTANT", (1, 10, 40)), ("BEZIER", (5, 20, 55))),
        (("BOUNCE", (1, 10, 40)), ("SINE", (5, 20, 55))),
    ],
)
def test_curves_of_any_kind_are_joined(banded, keys, one, two):
    animate(keys[SIX[0]], one[1], [0, 3, -1][: len(one[1])], one[0])
    animate(keys[SIX[1]], two[1], [1, -2, 5][: len(two[1])], two[0])
    expected = sampled(keys, SIX[0]) + sampled(keys, SIX[1])
    cut(banded, 3)
    bound = 0.03 if "BOUNCE" in one else 1e-3
    np.testing.assert_allclose(2 * sampled(keys, SIX[0]), expected, atol=bound)
    if "BOUNCE" not in one:
        assert len(curves(keys.id_data)[path(SIX[0])].keyframe_points) < 40


def test_a_band_that_is_not_animated_counts_with_its_value(banded, keys):
    animate(keys[SIX[0]], (1, 10), (0, 4), "LINEAR")
    keys[SIX[1]].value = 2
    cut(banded, 3)
    bpy.context.scene.frame_set(10)
    assert keys[SIX[0]].value == pytest.approx(3)
    bpy.context.scene.frame_set(1)
    assert keys[SIX[0]].value == pytest.approx(1)


def test_nothing_of_removed_bands_is_left(banded, keys):
    for name in SIX:
        animate(keys[name], (1, 10), (0, 1))
        keys[name].keyframe_insert("mute", frame=3)
        keys[name].driver_add("slider_max").driver.expression = "9"
    cut(banded, 2)
    left = {path(name, what) for name in SIX[:2] for what in ("value", "mute")}
    assert set(curves(keys.id_data)) == left
    driven = [driver.data_path for driver in keys.id_data.animation_data.drivers]
    assert sorted(driven) == [path(name, "slider_max") for name in SIX[:2]]
    for animated in (*curves(keys.id_data).values(), *keys.id_data.animation_data.drivers):
        assert animated.is_valid
        keys.id_data.path_resolve(animated.data_path)


def drive(key, expression: str, **variables: str):
    driver = key.driver_add("value").driver
    driver.expression = expression
    for name, read in variables.items():
        variable = driver.variables.new()
        variable.name = name
        variable.targets[0].id_type = "KEY"
        variable.targets[0].id = key.id_data
        variable.targets[0].data_path = path(read)
    return driver


def test_drivers_go_over_and_what_is_lost_is_told(banded, keys, capfd):
    drive(keys[SIX[1]], "frame / 10")
    cut(banded, 12)
    bpy.context.scene.frame_set(20)
    values = {key.name: key.value for key in keys if key.name != "Basis"}
    assert values["Shape Detail Band 3"] == values["Shape Detail Band 4"] == pytest.approx(2)
    assert len(keys.id_data.animation_data.drivers) == 2
    assert "differ" not in told(capfd)
    cut(banded, 6)
    assert "differ" not in told(capfd)  # both had the same
    cut(banded, 3)
    lost = (
        "in the place of 'Shape Detail Band 2', 'Shape Detail Band 1', whose drivers differ; it "
        "has what 'Shape Detail Band 2'"
    )
    assert lost in told(capfd)


def test_what_reads_a_band_reads_the_one_in_its_place(banded, keys):
    drive(keys[SIX[5]], "fine", fine=SIX[3])
    slave = bpy.data.objects.new("Slave", None)
    bpy.context.scene.collection.objects.link(slave)
    driver = slave.driver_add("location", 0).driver
    driver.expression = "v"
    variable = driver.variables.new()
    variable.name = "v"
    variable.targets[0].id = banded
    variable.targets[0].data_path = f"data.shape_keys.{path(SIX[3])}"
    cut(banded, 3)
    read = variable.targets[0].data_path
    assert read == f"data.shape_keys.{path('Shape Detail Band 2')}"
    own = keys.id_data.animation_data.drivers.find(path("Shape Detail Band 3")).driver
    assert own.variables[0].targets[0].data_path == path("Shape Detail Band 2")


def test_strips_of_the_nla_are_cut_too(banded, keys):
    animate(keys[SIX[1]], (1, 10), (0, 4), "LINEAR")
    animation = keys.id_data.animation_data
    action = animation.action
    track = animation.nla_tracks.new()
    strip = track.strips.new("Strip", 1, action)
    animation.action = None
    keys[SIX[0]].value = 1
    bpy.context.scene.frame_set(10)
    assert keys[SIX[1]].value == pytest.approx(4)
    cut(banded, 3)
    assert strip.action == action
    assert set(curves(keys.id_data)) == {path(SIX[0])}
    bpy.context.scene.frame_set(1)
    assert keys[SIX[0]].value == pytest.approx(0.5)
    bpy.context.scene.frame_set(10)
    assert keys[SIX[0]].value == pytest.approx(0.5 + 2)


def test_an_action_that_others_use_is_left_to_them(banded, keys, capfd):
    animate(keys[SIX[0]], (1, 10), (0, 4))
    twin = banded.copy()
    twin.data = banded.data.copy()
    bpy.context.collection.objects.link(twin)
    others = twin.data.shape_keys
    animation = others.animation_data_create()
    animation.action = keys.id_data.animation_data.action
    if hasattr(animation, "action_slot"):
        animation.action_slot = keys.id_data.animation_data.action_slot
    shared = animation.action
    cut(banded, 2)
    assert "animates others too; these bands have a copy now" in told(capfd)
    assert animation.action == shared != keys.id_data.animation_data.action
    assert path(SIX[0]) in curves(others)
    bpy.context.scene.frame_set(10)
    assert others.key_blocks[SIX[0]].value == pytest.approx(4)


def test_a_linked_action_is_copied_and_takes_no_keyframes(banded, keys, tmp_path, capfd):
    animate(keys[SIX[0]], (1, 10), (0, 4))
    animation = keys.id_data.animation_data
    library = str(tmp_path / "library.blend")
    bpy.data.libraries.write(library, {animation.action})
    bpy.data.actions.remove(animation.action)
    with bpy.data.libraries.load(library, link=True) as (source, target):
        target.actions = source.actions
    (linked,) = target.actions
    animation.action = linked
    if hasattr(animation, "action_slot"):
        animation.action_slot = linked.slots[0]
    with pytest.raises(RuntimeError, match="linked from another file, or locked"):
        bpy.ops.spectral_tv.keyframe()
    cut(banded, 2)
    assert "linked from another file; these bands have a copy now" in told(capfd)
    assert animation.action.library is None
    assert set(curves(keys.id_data)) == {path(SIX[0])}
    bpy.data.libraries.remove(linked.library)


def test_order_active_key_and_solo(banded, keys):
    smile = banded.shape_key_add(name="Smile", from_mix=False)
    banded.active_shape_key_index = keys.find(SIX[3])
    twin = bpy.data.objects.new("Twin", banded.data)
    bpy.context.collection.objects.link(twin)
    twin.active_shape_key_index = keys.find("Smile")
    keys[SIX[0]].mute = True
    bpy.ops.spectral_tv.solo(band=2)
    cut(banded, 3)
    assert [key.name for key in keys] == ["Basis", *SIX[:3], smile.name]
    assert banded.active_shape_key.name == "Shape Detail Band 2"
    assert twin.active_shape_key == smile
    assert [key.mute for key in keys] == [False] * 5
    bpy.ops.spectral_tv.solo(band=2)
    bpy.ops.spectral_tv.solo(band=2)
    assert not any(key.mute for key in keys)


def test_a_sculpted_band_stays_muted(banded, keys, capfd):
    for point in list(keys[SIX[1]].data)[:5]:
        point.co.z += 0.1
    keys[SIX[1]].value = 1
    sculpted = [tuple(point.co) for point in keys[SIX[1]].data]
    cut(banded, 3)
    said = told(capfd)
    assert "'Shape Detail Band 2' was sculpted since; it stays as " in said
    assert "'Shape Detail Band 2 Sculpted', muted, and is no longer a band" in said
    stays = keys["Shape Detail Band 2 Sculpted"]
    assert [tuple(point.co) for point in stays.data] == sculpted and stays.mute
    record = banded.data.spectral_tv.decompositions[-1]
    assert [band.key for band in record.bands] == [
        "Shape Detail Band 1",
        "Shape Detail Band 2",
        "Shape Detail Band 3",
    ]
    assert keys["Shape Detail Band 1"].value == pytest.approx(0.5)


def test_keys_that_lean_on_a_band_move_vertices_as_before(banded, keys):
    lean = banded.shape_key_add(name="Lean", from_mix=False)
    band = np.array([point.co for point in keys[SIX[1]].data])
    for point, co in zip(lean.data, band, strict=True):
        point.co = co + np.array([0, 0.25, 0])
    lean.relative_key = keys[SIX[1]]
    lean.value = 1
    cut(banded, 3)
    moved = [a.co - b.co for a, b in zip(lean.data, lean.relative_key.data, strict=True)]
    np.testing.assert_allclose(moved, np.tile([0, 0.25, 0], (len(moved), 1)), atol=1e-6)


def test_a_band_that_was_deleted_counts_for_nothing(banded, keys):
    for name in SIX:
        keys[name].value = 2
    banded.shape_key_remove(keys[SIX[0]])
    values = [key.value for key in cut(banded, 3).values()]
    assert values == pytest.approx([1, 2, 2])


def test_what_cannot_be_cut_leaves_all_as_it_was(banded, keys):
    before = [key.name for key in keys]
    with warnings.catch_warnings(), pytest.raises(RuntimeError, match="number of bands"):
        bpy.ops.spectral_tv.cut(bands=20)
    assert [key.name for key in keys] == before
