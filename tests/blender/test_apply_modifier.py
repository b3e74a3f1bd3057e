"""bpy.ops.spectral_tv.apply_modifier: modifiers applied to a mesh and all its shape keys."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import ball
from contents import contents, differences
from deform_scene import handle


def positions(data) -> np.ndarray:
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def seen(obj) -> np.ndarray:
    graph = bpy.context.evaluated_depsgraph_get()
    return positions(obj.evaluated_get(graph).data.vertices)


def applied_by_blender(obj, name: str, shape: np.ndarray) -> bpy.types.Object:
    """A copy without keys, of that shape, to which Blender has applied the modifier."""
    copy = obj.copy()
    copy.data = obj.data.copy()
    bpy.context.scene.collection.objects.link(copy)
    copy.shape_key_clear()
    copy.data.vertices.foreach_set("co", shape.astype(np.float32).ravel())
    copy.data.update()
    with bpy.context.temp_override(object=copy, active_object=copy):
        bpy.ops.object.modifier_apply(modifier=name)
    return copy


@pytest.fixture
def banded():
    """A ball with two bands, the second at 1 on its cap, a UV map and an own attribute."""
    obj = ball("Ball")
    mesh = obj.data
    mesh.uv_layers.new(name="UV").data.foreach_set("uv", np.arange(2.0 * len(mesh.loops)) % 1)
    mesh.attributes.new("Own", "FLOAT", "POINT").data[3].value = 2
    mesh.color_attributes.new("Paint", "BYTE_COLOR", "CORNER")
    mesh.materials.append(bpy.data.materials.new("Skin"))
    bpy.ops.spectral_tv.decompose(bands=2, steps=8, keep_limbs=0, soft_edges=0)
    obj.data.shape_keys.key_blocks["Shape Detail Band 2"].value = 1
    obj.data.shape_keys.key_blocks["Shape Detail Band 2"].vertex_group = "Cap"
    return obj


def apply(obj, **arguments) -> None:
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.spectral_tv.apply_modifier(**arguments) == {"FINISHED"}


def test_every_key_is_what_blender_makes_of_its_shape(banded):
    keys = banded.data.shape_keys.key_blocks
    banded.modifiers.new("Subdivision", "SUBSURF")
    shapes = {key.name: positions(key.data) for key in keys}
    expected = {
        name: applied_by_blender(banded, "Subdivision", shape) for name, shape in shapes.items()
    }
    apply(banded, modifier="Subdivision")
    assert not banded.modifiers
    for name, copy in expected.items():
        np.testing.assert_array_equal(positions(keys[name].data), positions(copy.data.vertices))
    basis = expected["Basis"].data
    mesh = banded.data
    assert [[*p.vertices] for p in mesh.polygons] == [[*p.vertices] for p in basis.polygons]
    assert [[*e.vertices] for e in mesh.edges] == [[*e.vertices] for e in basis.edges]
    for field in ("UV", "Own"):
        what = "vector" if field == "UV" else "value"
        ours, theirs = (
            [getattr(each, what) for each in data.attributes[field].data] for data in (mesh, basis)
        )
        assert ours == theirs
    assert [[(g.group, g.weight) for g in v.groups] for v in mesh.vertices] == [
        [(g.group, g.weight) for g in v.groups] for v in basis.vertices
    ]
    assert [*mesh.materials] == [*basis.materials]
    assert mesh.color_attributes.active_color_name == basis.color_attributes.active_color_name
    assert mesh.uv_layers.active.name == "UV"


def test_keys_keep_all_that_is_set_of_them(banded):
    block = banded.data.shape_keys
    keys = block.key_blocks
    lean = banded.shape_key_add(name="Lean", from_mix=False)
    lean.relative_key, lean.mute, lean.slider_max = keys["Shape Detail Band 1"], True, 9.5
    for frame, value in ((1, 0), (9, 2)):
        keys["Shape Detail Band 1"].value = value
        keys["Shape Detail Band 1"].keyframe_insert("value", frame=frame)
    lean.driver_add("value").driver.expression = "frame"
    animation = block.animation_data
    banded.modifiers.new("Subdivision", "SUBSURF")
    banded.active_shape_key_index = 2
    bpy.context.scene.frame_set(5)
    before = [(k.name, k.value, k.mute, k.vertex_group, k.relative_key.name) for k in keys]
    apply(banded)
    assert banded.data.shape_keys == block and block.animation_data == animation
    after = [(k.name, k.value, k.mute, k.vertex_group, k.relative_key.name) for k in keys]
    assert after == before and banded.active_shape_key_index == 2
    bpy.context.scene.frame_set(9)
    assert keys["Shape Detail Band 1"].value == 2 and lean.value == pytest.approx(9)


def test_what_is_seen_is_what_was_seen(banded):
    """Subdivision is linear, so that the mix of the keys is the same."""
    banded.data.shape_keys.key_blocks["Shape Detail Band 2"].vertex_group = ""
    banded.modifiers.new("Subdivision", "SUBSURF")
    before = seen(banded)
    apply(banded)
    np.testing.assert_allclose(seen(banded), before, atol=1e-5)


def test_bands_and_results_are_known_afterwards(banded):
    bpy.ops.spectral_tv.flow_attribute(kind="GROUP", source="Cap", steps=4)
    bpy.ops.spectral_tv.flow_attribute(kind="KEY", source="Shape Detail Band 2", steps=4)
    banded.modifiers.new("Subdivision", "SUBSURF")
    apply(banded)
    banded.data.shape_keys.key_blocks["Shape Detail Band 2"].name = "Large"
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=2)
    keys = banded.data.shape_keys.key_blocks
    assert keys["Large"].value == keys["Shape Detail Band 1"].value == -1
    groups, names = banded.vertex_groups.keys(), keys.keys()
    bpy.ops.spectral_tv.flow_attribute(kind="GROUP", source="Cap", steps=4)
    assert banded.vertex_groups.keys() == groups and keys.keys() == names
    assert not bpy.ops.spectral_tv.cut.poll()  # the flow was on the vertices before


@pytest.mark.parametrize("kind", ["SMOOTH", "SUBSURF"])
def test_a_deformation_is_known_afterwards(held, kind):
    handle(held).location.x = 0.5
    bpy.ops.spectral_tv.deform()
    keys = held.data.shape_keys.key_blocks
    keys["Deformation"].name = "Pulled"
    held.modifiers.new("Modifier", kind)
    apply(held)
    bpy.ops.spectral_tv.deform()
    assert keys.keys() == ["Basis", "Pulled"]


def test_all_are_applied_in_turn(banded, capfd):
    banded.modifiers.new("Mirror", "MIRROR")
    banded.modifiers.new("Subdivision", "SUBSURF")
    banded.modifiers.new("Off", "SUBSURF").show_viewport = False
    for key in banded.data.shape_keys.key_blocks:  # away from the plane, where nothing merges
        for point in key.data:
            point.co.x += 5
    graph = bpy.context.evaluated_depsgraph_get()
    count = len(banded.evaluated_get(graph).data.vertices)
    apply(banded)
    assert [modifier.name for modifier in banded.modifiers] == ["Off"]
    assert len(banded.data.vertices) == count
    assert "applied 'Mirror', 'Subdivision'" in capfd.readouterr().out


def test_modifiers_that_do_not_fit_every_key_are_refused(banded):
    keys = banded.data.shape_keys.key_blocks
    for point in keys["Shape Detail Band 2"].data:
        point.co.x += 5
    banded.modifiers.new("Mirror", "MIRROR").use_bisect_axis = (True, False, False)
    before = contents()
    with pytest.raises(RuntimeError, match=r"vertices of Basis, but \d+ of 'Shape Detail Band 2'"):
        bpy.ops.spectral_tv.apply_modifier()
    assert differences(before, contents()) == []
    assert [modifier.name for modifier in banded.modifiers] == ["Mirror"]


def test_refusals_say_why(banded, capfd):
    banded.modifiers.new("Off", "SUBSURF").show_viewport = False
    banded.modifiers.new("Cloth", "CLOTH")
    first = banded.modifiers.new("Wave", "WAVE")
    for name, reason in (
        ("Nothing", "does not exist"),
        ("Off", "disabled in the viewport"),
        ("Cloth", "is a simulation"),
    ):
        with pytest.raises(RuntimeError, match=reason):
            bpy.ops.spectral_tv.apply_modifier(modifier=name)
    apply(banded, modifier=first.name)
    assert "'Wave' was not the first modifier" in capfd.readouterr().out
    banded.modifiers.new("Late", "SUBSURF")
    twin = bpy.data.objects.new("Twin", banded.data)
    with pytest.raises(RuntimeError, match="2 objects that share this mesh"):
        bpy.ops.spectral_tv.apply_modifier(modifier="Late")
    bpy.data.objects.remove(twin)
    banded.shape_key_clear()
    with pytest.raises(RuntimeError, match="no shape keys"):
        bpy.ops.spectral_tv.apply_modifier()


def test_what_a_modifier_changes_of_what_is_seen_is_told(banded, capfd):
    """It is exact where the modifier treats keys one by one, and masks are not smoothed."""
    banded.modifiers.new("Twist", "SIMPLE_DEFORM").angle = 2
    before = seen(banded)
    apply(banded)
    moved = np.linalg.norm(seen(banded) - before, axis=1).max()
    assert moved > 1e-4
    assert f"what is seen has changed, by up to {moved:.2g}" in capfd.readouterr().out
    banded.data.shape_keys.key_blocks["Shape Detail Band 2"].vertex_group = ""
    banded.modifiers.new("Subdivision", "SUBSURF")
    before = seen(banded)
    apply(banded)
    np.testing.assert_allclose(seen(banded), before, atol=1e-5)
    assert "what is seen has changed" not in capfd.readouterr().out


def test_modifiers_that_are_all_off_are_refused(banded):
    banded.modifiers.new("Subdivision", "SUBSURF").show_viewport = False
    bpy.context.view_layer.objects.active = banded
    with pytest.raises(RuntimeError, match="disabled in the viewport"):
        bpy.ops.spectral_tv.apply_modifier()
