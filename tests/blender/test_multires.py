"""A Multiresolution sculpt: bands of its top level on a work object, and back into its levels."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest
from conftest import MODULE
from contents import contents, differences
from deform_scene import evaluated
from mathutils.kdtree import KDTree
from rigged_body import FRAMES, driven, poses
from sculpted_head import LEVELS, at_rest, bumpy, levels, reshaped, sculpted_head

groups_shown = import_module(f"{MODULE}.scene.results").groups_shown
QUICK = {"bands": 3, "steps": 8}


@pytest.fixture
def head():
    return sculpted_head()


def uvs(mesh) -> bytes:
    flat = np.empty(2 * len(mesh.loops), dtype=np.float32)
    mesh.uv_layers.active.data.foreach_get("uv", flat)
    return flat.tobytes()


def masked(obj) -> int:
    """How many faces of the base mesh Blender finds masked in Sculpt Mode."""
    bpy.ops.ed.undo_push(message="without it Sculpt Mode has no undo in the background")
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="SCULPT")
    bpy.ops.sculpt.face_sets_create(mode="MASKED")
    bpy.ops.object.mode_set(mode="OBJECT")
    attribute = obj.data.attributes[".sculpt_face_set"]
    found = np.empty(len(attribute.data), dtype=np.int32)
    attribute.data.foreach_get("value", found)
    obj.data.attributes.remove(attribute)
    return int(np.count_nonzero(found > 1))


def mask_all(obj) -> None:
    bpy.ops.ed.undo_push(message="without it Sculpt Mode has no undo in the background")
    bpy.ops.object.mode_set(mode="SCULPT")
    bpy.ops.paint.mask_flood_fill(mode="VALUE", value=1)
    bpy.ops.object.mode_set(mode="OBJECT")


def decomposed_work() -> bpy.types.Object:
    """The work object of the active one, with its finest band gone and its largest raised."""
    assert bpy.ops.spectral_tv.work_object() == {"FINISHED"}
    work = bpy.context.object
    assert bpy.ops.spectral_tv.decompose(**QUICK) == {"FINISHED"}
    keys = work.data.shape_keys.key_blocks
    keys[1].value, keys[3].value = -1, 0.5
    return work


def farthest_from(some: np.ndarray, others: np.ndarray) -> float:
    tree = KDTree(len(others))
    for index, place in enumerate(others):
        tree.insert(place, index)
    tree.balance()
    return max(tree.find(place)[2] for place in some)


def test_the_work_object_is_the_top_level_at_rest(head):
    bpy.context.scene.frame_set(FRAMES[2])
    before = contents()
    bpy.context.scene.render.use_simplify = True
    bpy.context.scene.render.simplify_subdivision = 1
    expected_uvs = len(head.data.loops) * 4**3
    bpy.ops.spectral_tv.work_object()
    bpy.context.scene.render.use_simplify = False
    work = bpy.context.object
    assert work.name == "Head Work" and head.hide_get() and not head.hide_render
    assert work.hide_render and not work.modifiers and work.data.shape_keys is None
    np.testing.assert_array_equal(evaluated(work), at_rest(head, 3))
    assert work.matrix_world == head.matrix_world
    assert len(work.data.uv_layers.active.data) == expected_uvs
    assert [slot.material for slot in work.material_slots] == [*head.data.materials]
    assert "Bone" in work.vertex_groups
    assert work.spectral_tv_work.source == head
    after = contents()
    assert not differences(before, {name: after[name] for name in before})
    assert len(after) == len(before) + 2


def test_write_back_gives_the_levels_the_shape_and_changes_nothing_else(head, capfd):
    mask_all(head)
    count = masked(head)
    assert count == len(head.data.polygons)
    before, drivers, uv = contents(), driven(head), uvs(head.data)
    poses_before = poses(head)
    lower = [at_rest(head, level) for level in range(4)]
    bpy.context.view_layer.objects.active = head
    work = decomposed_work()
    shown = evaluated(work)
    size = np.linalg.norm(np.ptp(shown, axis=0))
    assert np.abs(shown - lower[3]).max() > 5e-3 * size
    bpy.context.scene.frame_set(FRAMES[1])
    assert bpy.ops.spectral_tv.write_back() == {"FINISHED"}
    bpy.context.scene.frame_set(FRAMES[0])
    assert "the top level of 'Head' has its shape, to within" in capfd.readouterr().out
    assert bpy.context.object == head and not head.hide_get() and work.hide_get()
    np.testing.assert_allclose(at_rest(head, 3), shown, atol=1e-6 * size)
    # The levels below are there, and are points of the top level as they were.
    for level in (1, 2):
        now = at_rest(head, level)
        assert len(now) == len(lower[level])
        assert np.abs(now - lower[level]).max() > 1e-3 * size
        assert farthest_from(now, shown) < 1e-6 * size
    np.testing.assert_array_equal(at_rest(head, 0), lower[0])
    assert levels(head) == LEVELS
    assert driven(head) == drivers and uvs(head.data) == uv
    moved = poses(head)
    for one, other in zip(moved, poses_before, strict=True):
        assert one.shape == other.shape and np.abs(one - other).max() > 1e-3 * size
    assert np.abs(moved[2] - moved[0]).max() > 0.1 * size  # the rig and the face key still do
    after = contents()
    changed = differences(before, {name: after[name] for name in before})
    assert changed == ["object Head: levels"]
    assert masked(head) == count


@pytest.mark.parametrize("shape", ["MULTIRES", "APPLIED"])
def test_segments_come_along_and_serve_as_masks(head, shape, capfd):
    bpy.ops.spectral_tv.cosegment(segments=3, steps=8, outputs={"GROUPS", "COLOR"})
    segments = [f"Segment {number}" for number in (1, 2, 3)]
    bpy.ops.spectral_tv.decompose(shape=shape, **QUICK)
    work = bpy.context.object
    assert work != head and groups_shown(work, "SEGMENTS") == segments
    bpy.ops.spectral_tv.fill_mask(band=1, source="GROUP", group=segments[1])
    # As results that nobody changed they are written over.
    capfd.readouterr()
    bpy.ops.spectral_tv.cosegment(segments=3, steps=8, outputs={"GROUPS", "COLOR"})
    assert "was changed since" not in capfd.readouterr().out
    assert [each.name for each in work.vertex_groups if "Segment" in each.name] == segments


def test_a_mask_of_sculpt_mode_is_told_to_stay(head, capfd):
    bpy.ops.spectral_tv.work_object()
    assert "masked in Sculpt Mode" not in capfd.readouterr().out
    bpy.data.objects.remove(bpy.context.object)
    head.hide_set(False)
    bpy.context.view_layer.objects.active = head
    mask_all(head)
    bpy.ops.spectral_tv.decompose(**QUICK)
    with pytest.raises(RuntimeError, match="is in its levels, of which Blender gives out no masks"):
        bpy.ops.spectral_tv.fill_mask(band=1, source="SCULPT_MASK")
    capfd.readouterr()
    bpy.ops.spectral_tv.work_object()
    assert "what is masked in Sculpt Mode stays with 'Head'" in capfd.readouterr().out


def test_what_is_written_back_is_found_again_and_can_be_dialled_on(head, capfd):
    work = decomposed_work()
    bpy.ops.spectral_tv.write_back()
    assert bpy.ops.spectral_tv.work_object() == {"FINISHED"}
    assert bpy.context.object == work and not work.hide_get() and head.hide_get()
    assert "'Head Work' has its top level" in capfd.readouterr().out
    work.data.shape_keys.key_blocks[2].value = -1
    shown = evaluated(work)
    bpy.ops.spectral_tv.write_back()
    np.testing.assert_allclose(at_rest(head, 3), shown, atol=1e-5)
    assert "written over" not in capfd.readouterr().out


def test_sculpting_the_source_meanwhile_is_told(head, capfd):
    work = decomposed_work()
    head.hide_set(False)
    level = head.modifiers["Multires"].levels
    head.modifiers["Multires"].levels = 3
    modifier = head.modifiers["Armature"]
    modifier.show_viewport, head.show_only_shape_key = False, True
    head.active_shape_key_index = 0
    reshaped(head, bumpy(evaluated(head), 0.05))
    head.modifiers["Multires"].levels = level
    modifier.show_viewport, head.show_only_shape_key = True, False
    bpy.context.view_layer.objects.active = head
    bpy.ops.spectral_tv.work_object()
    assert bpy.context.object.name == "Head Work.001"
    assert "Head Work stays: it is of what the levels were before" in capfd.readouterr().out
    bpy.context.view_layer.objects.active = work
    work.hide_set(False)
    bpy.ops.spectral_tv.write_back()
    assert "'Head' was sculpted since" in capfd.readouterr().out


def test_it_survives_saving_loading_and_renaming(head, tmp_path: Path):
    work = decomposed_work()
    head.name, work.name = "Kopf", "Arbeit"
    shown = evaluated(work)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "head.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "head.blend"))
    work = bpy.context.object
    assert work.name == "Arbeit" and bpy.ops.spectral_tv.write_back() == {"FINISHED"}
    np.testing.assert_allclose(at_rest(bpy.data.objects["Kopf"], 3), shown, atol=1e-5)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)


def refused(match: str) -> None:
    before = contents()
    with pytest.raises(RuntimeError, match=match):
        bpy.ops.spectral_tv.write_back()
    assert not differences(before, contents())


@pytest.mark.once
def test_what_does_not_fit_is_refused_and_changes_nothing(head):
    work = decomposed_work()
    modifier = work.modifiers.new("Subdivision", "SUBSURF")
    refused("has 31658 vertices now, but the shape has 126")
    work.modifiers.remove(modifier)
    value = work.data.shape_keys.key_blocks[1].points[7].co.copy()
    work.data.shape_keys.key_blocks[1].points[7].co.x = float("nan")
    refused("a vertex without a finite place")
    work.data.shape_keys.key_blocks[1].points[7].co = value
    bpy.context.view_layer.objects.active = head
    bpy.ops.object.multires_subdivide(modifier="Multires", mode="CATMULL_CLARK")
    bpy.context.view_layer.objects.active = work
    refused("Head has 4 levels now, and had 3 levels when this was made")
    modifier = head.modifiers["Multires"]
    modifier.levels = 3
    with bpy.context.temp_override(object=head, active_object=head):
        bpy.ops.object.multires_higher_levels_delete(modifier="Multires")
    assert work.spectral_tv_work.levels == modifier.total_levels == 3
    head.data.flip_normals()
    refused("the top level of 'Head' has other faces now")
    head.modifiers.remove(modifier)
    refused("Head: The object has no Multiresolution modifier")
    bpy.ops.object.select_all(action="DESELECT")
    bpy.context.view_layer.objects.active = head
    bpy.data.objects.remove(head)
    bpy.context.view_layer.objects.active = work
    refused("Its source 'Head' was deleted")


def test_a_source_that_the_user_deleted_is_told(head):
    work = decomposed_work()
    with bpy.context.temp_override(selected_objects=[head], active_object=head):
        bpy.ops.object.delete()
    refused("Its source 'Head' was deleted")
    assert work.spectral_tv_work.called == "Head"


def test_decompose_takes_the_top_level_where_that_is_chosen(head, capfd):
    bpy.ops.spectral_tv.decompose(shape="MULTIRES", **QUICK)
    told = capfd.readouterr().out
    assert "level 3 of Multires is decomposed, at rest" in told and "Write Back" in told
    work = bpy.context.object
    assert work.name == "Head Work" and len(work.data.shape_keys.key_blocks) == 4
    work.data.shape_keys.key_blocks[1].value = 1
    shown = evaluated(work)
    bpy.ops.spectral_tv.write_back()
    np.testing.assert_allclose(at_rest(head, 3), shown, atol=1e-5)


def test_objects_that_share_the_mesh_are_told(head, capfd):
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Twin", head.data))
    work = decomposed_work()
    work.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    shown = evaluated(work)
    bpy.ops.spectral_tv.write_back()
    told = capfd.readouterr().out
    assert "2 objects share the mesh of 'Head', and have the shape" in told
    assert "how it was moved, turned or scaled beside 'Head' is not written back" in told
    np.testing.assert_allclose(at_rest(head, 3), shown, atol=1e-5)


def test_objects_without_levels_are_refused():
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    with pytest.raises(RuntimeError, match="no Multiresolution modifier"):
        bpy.ops.spectral_tv.work_object()
    with pytest.raises(RuntimeError, match="no work object"):
        bpy.ops.spectral_tv.write_back()
    obj.modifiers.new("Multires", "MULTIRES")
    with pytest.raises(RuntimeError, match="has no levels"):
        bpy.ops.spectral_tv.work_object()


def test_the_estimate_is_of_the_top_level(head):
    count = import_module(f"{MODULE}.bands.shown_shape").count
    assert count(head, "MULTIRES") == len(at_rest(head, 3))
    assert count(head, "APPLIED") == len(evaluated(head)) == len(at_rest(head, 1))


def test_a_shape_that_the_levels_cannot_hold_is_refused_and_changes_nothing():
    """Displacements are relative to tangents, which a mesh without area has not."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4)
    line = bpy.context.object
    for vertex in line.data.vertices:
        vertex.co.y = 0
    line.modifiers.new("Multires", "MULTIRES")
    bpy.ops.object.multires_subdivide(modifier="Multires", mode="CATMULL_CLARK")
    bpy.ops.spectral_tv.work_object()
    for vertex in bpy.context.object.data.vertices:
        vertex.co.z += np.sin(9 * vertex.co.x)
    refused("the levels cannot hold this shape: .* vertices would be up to .* of the size away")


def test_levels_in_another_file_are_refused(head, tmp_path: Path):
    """Reshape leaves them as they are in that file."""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "head.blend"))
    bpy.ops.object.multires_external_save(
        modifier="Multires", filepath=str(tmp_path / "levels.btx")
    )
    with pytest.raises(RuntimeError, match="kept in another file; pack them"):
        bpy.ops.spectral_tv.work_object()
    bpy.ops.object.multires_external_pack()
    assert bpy.ops.spectral_tv.work_object() == {"FINISHED"}
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
