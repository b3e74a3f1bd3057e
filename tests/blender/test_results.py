"""Which groups, attributes and keys are results: what the user made is never taken for one."""

from __future__ import annotations

import bpy
import kinds_of_results
import pytest
from kinds_of_results import FEW, Attribute, Group, Key, each_kind, flow, told

sphere = kinds_of_results.sphere


@each_kind
def test_a_renamed_result_is_written_over(sphere, kind):
    flow(**kind.source, size=5, **FEW)
    kind.all(sphere)[kind.result].name = "Soft"
    before, names = kind.values(sphere, "Soft"), set(kind.all(sphere).keys())
    flow(**kind.source, size=50, **FEW)
    assert set(kind.all(sphere).keys()) == names
    assert kind.values(sphere, "Soft") != before


@each_kind
def test_another_thing_with_the_name_of_a_result_is_left_alone(sphere, kind):
    flow(**kind.source, size=5, **FEW)
    kind.all(sphere)[kind.result].name = "Soft"
    kind.new(sphere, kind.result)
    soft, own = (kind.values(sphere, name) for name in ("Soft", kind.result))
    flow(**kind.source, size=50, **FEW)
    assert kind.values(sphere, kind.result) == own
    assert kind.values(sphere, "Soft") != soft


@each_kind
def test_one_in_the_place_of_a_deleted_result_is_left_alone(sphere, kind):
    flow(**kind.source, size=5, **FEW)
    found = kind.all(sphere)[kind.result]
    sphere.shape_key_remove(found) if kind is Key else kind.all(sphere).remove(found)
    kind.new(sphere, kind.result)
    own = kind.values(sphere, kind.result)
    flow(**kind.source, size=50, **FEW)
    assert kind.values(sphere, kind.result) == own
    assert f"{kind.result}.001" in kind.all(sphere)


@each_kind
def test_a_result_that_was_changed_is_kept_and_that_is_told(sphere, kind, capfd):
    flow(**kind.source, size=5, **FEW)
    kind.change(sphere, kind.result)
    own = kind.values(sphere, kind.result)
    told(capfd)
    flow(**kind.source, size=50, **FEW)
    said = told(capfd)
    assert f"{kind.result!r} was changed since, and is kept" in said
    assert f"written as '{kind.result}.001'" in said
    assert kind.values(sphere, kind.result) == own
    # From now on the new one is the result, and the other is nobody's.
    flow(**kind.source, size=20, **FEW)
    assert "changed" not in told(capfd)
    assert f"{kind.result}.002" not in kind.all(sphere)


@pytest.mark.parametrize("kind", [Group, Key])
def test_a_locked_result_is_kept_and_that_is_told(sphere, kind, capfd):
    flow(**kind.source, size=5, **FEW)
    kind.lock(sphere, kind.result)
    own = kind.values(sphere, kind.result)
    flow(**kind.source, size=50, **FEW)
    assert f"{kind.result!r} is locked, and is kept" in told(capfd)
    assert kind.values(sphere, kind.result) == own


def copy_key(obj, name, new_name):
    key = obj.shape_key_add(name=new_name, from_mix=False)
    for point, co in zip(key.data, Key.values(obj, name), strict=True):
        point.co = co
    return key


def test_of_copies_the_one_with_the_name_is_the_result(sphere):
    flow(**Key.source, size=5, **FEW)
    copy_key(sphere, "Lift Flow", "Keep")
    own = Key.values(sphere, "Keep")
    flow(**Key.source, size=50, **FEW)
    assert Key.values(sphere, "Keep") == own != Key.values(sphere, "Lift Flow")


def test_of_renamed_copies_neither_is_the_result(sphere):
    flow(**Key.source, size=5, **FEW)
    copy_key(sphere, "Lift Flow", "Keep")
    sphere.data.shape_keys.key_blocks["Lift Flow"].name = "Keep too"
    own = Key.values(sphere, "Keep")
    flow(**Key.source, size=50, **FEW)
    assert Key.values(sphere, "Keep") == Key.values(sphere, "Keep too") == own
    assert Key.values(sphere, "Lift Flow") != own


def test_bands_that_were_changed_outlive_fewer_bands(sphere, capfd):
    flow(**Attribute.source, result="BANDS", bands=4, steps=8)
    Attribute.change(sphere, "Mask Band 4")
    Attribute.new(sphere, "Mask Band 9")
    own = Attribute.values(sphere, "Mask Band 4")
    flow(**Attribute.source, result="BANDS", bands=2, steps=8)
    names = {each.name for each in sphere.data.attributes if each.name.startswith("Mask")}
    assert names == {"Mask", "Mask Rest", *(f"Mask Band {band}" for band in (1, 2, 4, 9))}
    assert Attribute.values(sphere, "Mask Band 4") == own
    assert "'Mask Band 4' was changed since, and is kept" in told(capfd)


def test_a_result_of_a_sculpted_mesh_is_known_again(sphere):
    """Where Basis is moved Blender moves all keys along, which rounds them."""
    flow(**Key.source, size=5, **FEW)
    bpy.ops.object.mode_set(mode="EDIT")
    sphere.active_shape_key_index = 0
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.translate(value=(0.1, 0.23, 0.37))
    bpy.ops.object.mode_set(mode="OBJECT")
    flow(**Key.source, size=50, **FEW)
    names = [key.name for key in sphere.data.shape_keys.key_blocks]
    assert names == ["Basis", "Lift", "Lift Flow"]


def test_a_duplicated_object_has_results_of_its_own(sphere):
    flow(**Attribute.source, size=5, **FEW)
    twin = sphere.copy()
    twin.data = sphere.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    before = Attribute.values(sphere, "Mask Flow")
    bpy.context.view_layer.objects.active = twin
    flow(**Attribute.source, size=50, **FEW)
    assert "Mask Flow.001" not in twin.data.attributes
    assert Attribute.values(twin, "Mask Flow") != before == Attribute.values(sphere, "Mask Flow")
