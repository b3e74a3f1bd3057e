"""The shape that modifiers show, decomposed on a copy: the original stays all that it was."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
import pytest
from conftest import MODULE
from contents import contents, differences
from deform_scene import coordinates, evaluated, group
from rigged_body import FRAMES, driven, poses, rigged_body

QUICK = {"bands": 3, "steps": 8}


@pytest.fixture
def body():
    return rigged_body()


def uvs(mesh) -> np.ndarray:
    flat = np.empty(2 * len(mesh.loops), dtype=np.float32)
    mesh.uv_layers.active.data.foreach_get("uv", flat)
    return flat.reshape(-1, 2)


def weights(obj, name: str) -> np.ndarray:
    index = obj.vertex_groups[name].index
    return np.array(
        [sum(g.weight for g in v.groups if g.group == index) for v in obj.data.vertices]
    )


def latest(obj) -> list[bpy.types.ShapeKey]:
    keys = obj.data.shape_keys.key_blocks
    return [keys[band.key] for band in obj.data.spectral_tv.decompositions[-1].bands]


@pytest.mark.parametrize("frame", FRAMES)
def test_the_pose_of_a_frame_is_decomposed_on_a_copy(body, frame, capfd):
    seen = poses(body)
    before, drivers = contents(), driven(body)
    bpy.context.scene.frame_set(frame)
    shown = evaluated(body)
    seen_mesh = body.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    map_before = uvs(seen_mesh).copy()
    assert bpy.ops.spectral_tv.decompose(shape="APPLIED", **QUICK) == {"FINISHED"}
    told = capfd.readouterr().out
    assert f"as shown on frame {frame} with Armature, Subdivision" in told
    assert "Armature, Subdivision will not move it" in told
    copy = bpy.context.object
    assert copy.name == "Body Applied" and body.hide_get() and body.hide_render
    np.testing.assert_allclose(evaluated(copy), shown, atol=1e-6)
    np.testing.assert_array_equal(uvs(copy.data), map_before)
    assert copy.material_slots[0].material.name.startswith("Own Skin")
    assert copy.vertex_groups.keys() == ["Bone"] and weights(copy, "Bone").max() == 1
    for key in latest(copy):
        key.value = -1
    assert np.abs(evaluated(copy) - shown).max() > 1e-3
    # The copy stands still, and the original plays as before.
    still = poses(copy)
    np.testing.assert_array_equal(still[0], still[2])
    for one, other in zip(poses(body), seen, strict=True):
        np.testing.assert_array_equal(one, other)
    assert driven(body) == drivers
    after = contents()
    assert not differences(before, {name: after[name] for name in before})


def test_bands_of_the_cage_act_through_the_modifiers(body, capfd):
    seen = poses(body)
    assert bpy.ops.spectral_tv.decompose(**QUICK) == {"FINISHED"}
    told = capfd.readouterr().out
    assert "the mesh before Armature, Subdivision, and act through them" in told
    assert bpy.context.object == body
    for one, other in zip(poses(body), seen, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-6)
    latest(body)[1].value = 2
    for one, other in zip(poses(body), seen, strict=True):
        assert np.abs(one - other).max() > 1e-3


def test_a_parent_that_bends_bends_the_copy_no_second_time(body, capfd):
    body.modifiers.remove(body.modifiers["Armature"])
    body.parent, body.parent_type = bpy.data.objects["Rig"], "ARMATURE"
    bpy.context.scene.frame_set(FRAMES[2])
    shown = evaluated(body)
    bpy.ops.spectral_tv.decompose(shape="APPLIED", **QUICK)
    assert "as shown on frame 20 with Rig, Subdivision" in capfd.readouterr().out
    np.testing.assert_allclose(evaluated(bpy.context.object), shown, atol=1e-6)


def test_a_simulation_is_decomposed_as_it_is_on_the_frame(capfd):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=16, y_subdivisions=16)
    sheet = bpy.context.object
    group(sheet, "Rim", [v.index for v in sheet.data.vertices if v.co.y > 0.9])
    sheet.modifiers.new("Cloth", "CLOTH").settings.vertex_group_mass = "Rim"
    rest = coordinates(sheet.data.vertices)
    for frame in range(1, 9):
        bpy.context.scene.frame_set(frame)
        shown = evaluated(sheet)
    assert np.abs(shown - rest).max() > 0.02
    bpy.ops.spectral_tv.decompose(shape="APPLIED", **QUICK)
    assert "as shown on frame 8 with Cloth" in capfd.readouterr().out
    np.testing.assert_array_equal(evaluated(bpy.context.object), shown)
    np.testing.assert_array_equal(coordinates(sheet.data.vertices), rest)


def test_what_cannot_be_read_so_is_refused(body):
    other = bpy.data.objects.new("Other", body.data.copy())
    bpy.context.scene.collection.objects.link(other)
    other.select_set(True)
    before = contents()
    with pytest.raises(RuntimeError, match="one object at a time is decomposed as 'Modifiers Appl"):
        bpy.ops.spectral_tv.decompose(shape="APPLIED", together=True, **QUICK)
    with pytest.raises(RuntimeError, match="a shape key as the base has other vertices"):
        bpy.ops.spectral_tv.decompose(
            shape="APPLIED", method="M3", base="KEY", base_key="Smile", **QUICK
        )
    with pytest.raises(RuntimeError, match="no Multiresolution modifier"):
        bpy.ops.spectral_tv.decompose(shape="MULTIRES", **QUICK)
    body.hide_viewport = True
    bpy.context.view_layer.objects.active = body
    with pytest.raises(RuntimeError, match="it is hidden"):
        bpy.ops.spectral_tv.decompose(shape="APPLIED", **QUICK)
    assert not differences(before, contents())


def test_another_frame_by_the_time_it_is_written_is_refused(body):
    """As where an animation plays while the work runs."""
    module = import_module(f"{MODULE}.bands.shown_shape")
    reading = import_module(f"{MODULE}.scene.surface").Reading(0, leaves_out=False)
    surface = module.read(body, "APPLIED", reading)
    bpy.context.scene.frame_set(FRAMES[2])
    before = contents()
    with pytest.raises(Exception, match="what is shown changed in the meantime"):
        module.new_object(body, "APPLIED", surface)
    assert not differences(before, contents())
    bpy.context.scene.frame_set(FRAMES[0])
    assert module.new_object(body, "APPLIED", surface).name == "Body Applied"


def test_undo_takes_the_copy_back(body):
    bpy.ops.ed.undo_push(message="before")
    before = contents()
    bpy.ops.spectral_tv.decompose("EXEC_DEFAULT", True, shape="APPLIED", **QUICK)
    assert differences(before, contents())
    bpy.ops.ed.undo()
    assert not differences(before, contents())
    assert not bpy.data.objects["Body"].hide_render
