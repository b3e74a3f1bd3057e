"""The number of bands and the filter curve change the bands without a button."""

from __future__ import annotations

from importlib import import_module

import bpy
import pytest
from ball import ball
from conftest import MODULE

curve_watch, filter_curve, remarks, count, whole_change = (
    import_module(f"{MODULE}.bands.{name}")
    for name in ("curve_watch", "filter_curve", "remarks", "count", "whole_change")
)


@pytest.fixture
def obj():
    found = ball("Ball")
    bpy.ops.spectral_tv.decompose(method="M1", bands=4, steps=8)
    curve_watch._Watch.seen = None
    yield found
    bpy.data.batch_remove([*bpy.data.node_groups])


def values(obj) -> list[float]:
    return [key.value for key in obj.data.shape_keys.key_blocks[1:]]


def record(obj):
    return obj.data.spectral_tv.decompositions[-1]


def test_the_number_of_bands_cuts_the_flow_again(obj):
    for key in obj.data.shape_keys.key_blocks[1:]:
        key.value = 0.5
    identifier = record(obj).identifier
    cut = obj.data.spectral_tv_count
    assert cut.bands == 4
    for number in (7, 2):
        cut.bands = number
        assert cut.bands == len(record(obj).bands) == number
        assert values(obj) == pytest.approx([0.5] * number)
        assert record(obj).identifier == identifier  # no new flow


def test_there_are_no_more_bands_than_the_flow_has_components(obj):
    obj.data.spectral_tv_count.bands = 32
    assert obj.data.spectral_tv_count.bands == len(values(obj)) == 7


def test_what_is_lost_by_the_cut_is_said_in_the_panel(obj):
    obj.data.shape_keys.key_blocks[1].value = 1
    obj.data.spectral_tv_count.bands = 2
    told = remarks.remarks_of(obj.data, "count", count.state(record(obj)))
    assert any("the shape is another" in text for text in told)
    obj.data.spectral_tv_count.bands = 3
    told = remarks.remarks_of(obj.data, "count", count.state(record(obj)))
    assert not any("Band 1' (0.5)" in text for text in told)


def test_without_its_flow_the_bands_stay(obj, capfd):
    import_module(f"{MODULE}.bands.bands").flows.clear()
    obj.data.spectral_tv_count.bands = 2
    assert len(values(obj)) == 4
    assert "stay as they are: The flow is no longer in memory" in capfd.readouterr().err


def test_the_curve_sets_the_bands_while_it_is_drawn(obj):
    """Blender tells by its message bus, which has a window alone; here it is told by hand."""
    node = filter_curve.ensure()
    curve_watch._follow()
    assert values(obj) == [0] * 4  # nobody has looked at it
    curve_watch.look(node)
    curve_watch._follow()
    assert values(obj) == [0] * 4  # the curve of a material was changed
    points = node.mapping.curves[0].points
    points[0].location.y, points[1].location.y = 0, 2
    node.mapping.update()
    curve_watch._follow()
    assert values(obj) == pytest.approx([-0.75, -0.25, 0.25, 0.75], abs=0.02)


def test_one_undo_takes_the_curve_and_the_bands_back(obj):
    """The curve has a step of undo of Blender's, before the bands follow."""

    def draw(height: float) -> None:
        node = filter_curve.find()
        node.mapping.curves[0].points[1].location.y = height
        node.mapping.update()
        bpy.ops.ed.undo_push(message="Curve")
        curve_watch._follow()
        curve_watch.make_step()

    def state() -> tuple[float, ...]:
        height = filter_curve.find().mapping.curves[0].points[1].location.y
        return (height, *values(bpy.data.objects["Ball"]))

    curve_watch.look(filter_curve.ensure())
    bpy.ops.ed.undo_push(message="Before")
    found = [state()]
    for height in (2, 0.5):
        draw(height)
        found.append(state())
    assert len({*found}) == 3
    for expected in found[1::-1]:
        bpy.ops.ed.undo()
        while whole_change.step_on(is_undo=True):
            pass
        assert state() == expected
    for expected in found[1:]:
        bpy.ops.ed.redo()
        while whole_change.step_on(is_undo=False):
            pass
        assert state() == expected


def test_what_hinders_the_curve_is_said_in_the_panel(obj):
    node = filter_curve.ensure()
    curve_watch.look(node)
    obj.data.shape_keys.key_blocks[2].mute = True
    node.mapping.curves[0].points[1].location.y = 0.5
    node.mapping.update()
    curve_watch._follow()
    (told,) = remarks.remarks_of(obj.data, "curve", curve_watch.state(obj))
    assert "muted" in told
    obj.data.shape_keys.key_blocks[1].value = 0.1
    assert not remarks.remarks_of(obj.data, "curve", curve_watch.state(obj))
