"""The line under the sliders: how many faces the bands fold and stretch, as they are turned."""

from __future__ import annotations

from pathlib import Path

import bpy
import folding_sheet
import numpy as np
import pytest
from command_line_files import empty
from folding_sheet import (
    SCALES,
    WILD,
    banded,
    counted,
    key,
    line,
    live_guard,
    moved,
    points,
    sheet_with_bumps,
    text,
    triangles,
    turn,
)
from reference_guard import normals

sheet = folding_sheet.sheet


def test_the_line_of_a_large_mesh_waits_until_the_sliders_rest(sheet, monkeypatch):
    monkeypatch.setattr(live_guard, "MOST_MOVING", 10)
    assert line() == "No face folds"
    turn(sheet, **WILD)
    assert line() == line() == "Folds are counted when the sliders rest"
    turn(sheet, **{name: value / 2 for name, value in WILD.items()})
    assert line() == "Folds are counted when the sliders rest"
    # In the background Blender calls no timers; this is what is left once it has.
    live_guard.listening.stop_awaiting(live_guard._redraw)
    mix = sum(value / 2 * moved(sheet, name) for name, value in WILD.items())
    folded, stretched = counted(sheet, mix)
    assert line() == (text(folded, stretched) if folded else f"{stretched} faces stretch")


def test_the_line_follows_the_sliders(sheet):
    assert line() == "No face folds"
    seen = set()
    for share in (0.6, 1.0, 1.4):
        turn(sheet, **{name: share * value for name, value in WILD.items()})
        mix = sum(share * value * moved(sheet, name) for name, value in WILD.items())
        found = counted(sheet, mix)
        assert found[1] > 0
        assert line() == (text(*found) if found[0] else f"{found[1]} faces stretch")
        seen.add(found)
    assert len(seen) == 3 and found[0] > 1
    turn(sheet, **dict.fromkeys(WILD, 0.0))
    assert line() == "No face folds"


def test_what_is_taken_away_folds_too(sheet):
    key(sheet, "Shape Detail Band 2").slider_min = -10
    turn(sheet, **{"Shape Detail Band 2": -8.0})
    assert line() == text(*counted(sheet, -8 * moved(sheet, "Shape Detail Band 2")))


def test_what_is_muted_soloed_or_deleted_counts_no_more(sheet):
    turn(sheet)
    both = line()
    alone = text(*counted(sheet, WILD["Shape Detail Band 3"] * moved(sheet, "Shape Detail Band 3")))
    key(sheet, "Shape Detail Band 2").mute = True
    assert line() == alone != both
    key(sheet, "Shape Detail Band 2").mute = False
    assert line() == both
    bpy.ops.spectral_tv.solo(band=3)
    assert line() == alone
    bpy.ops.spectral_tv.solo(band=3)
    sheet.shape_key_remove(key(sheet, "Shape Detail Band 2"))
    assert line() == alone


def test_masks_count_and_follow_their_weights(sheet):
    turn(sheet)
    weights = np.linspace(0, 1, len(sheet.data.vertices))
    group = sheet.vertex_groups.new(name="Part")

    def expected() -> str:
        first = (
            WILD["Shape Detail Band 2"]
            * weights[:, np.newaxis]
            * moved(sheet, "Shape Detail Band 2")
        )
        return text(
            *counted(
                sheet, first + WILD["Shape Detail Band 3"] * moved(sheet, "Shape Detail Band 3")
            )
        )

    for vertex, weight in enumerate(weights):
        group.add([vertex], weight, "REPLACE")
    key(sheet, "Shape Detail Band 2").vertex_group = "Part"
    bpy.context.view_layer.update()
    masked = line()
    assert masked == expected()
    weights[:] = 0.05
    group.add(range(len(weights)), 0.05, "REPLACE")
    bpy.context.view_layer.update()
    assert line() == expected() != masked
    turn(sheet, **{"Shape Detail Band 3": 4.0})  # with weights that are kept from before
    first = WILD["Shape Detail Band 2"] * 0.05 * moved(sheet, "Shape Detail Band 2")
    assert line() == text(*counted(sheet, first + 4.0 * moved(sheet, "Shape Detail Band 3")))


def test_bands_are_judged_against_what_the_other_keys_show(sheet):
    smile = sheet.shape_key_add(name="Smile", from_mix=False)
    basis = points(key(sheet, "Basis"))
    wide = basis * [3, 1, 1]
    smile.data.foreach_set("co", wide.astype(np.float32).ravel())
    turn(sheet, Smile=0.0, **WILD)
    alone = line()
    turn(sheet, Smile=1.0)
    mix = sum(value * moved(sheet, name) for name, value in WILD.items())
    assert line() == text(*counted(sheet, mix, points(smile))) != alone
    # A key that is pinned is all that is seen.
    sheet.active_shape_key_index = sheet.data.shape_keys.key_blocks.find("Smile")
    sheet.show_only_shape_key = True
    assert line() == "No face folds"


def test_sculpted_bands_and_renamed_ones_are_counted_as_they_are(sheet):
    turn(sheet)
    before = line()
    key(sheet, "Shape Detail Band 2").name = "Nose"
    assert line() == before
    nose = key(sheet, "Nose")
    sculpted = points(nose)
    sculpted[:40, 2] += np.where(np.arange(40) % 2, 0.2, -0.2)
    nose.data.foreach_set("co", sculpted.astype(np.float32).ravel())
    sheet.data.update_tag()
    bpy.context.view_layer.update()
    mix = WILD["Shape Detail Band 2"] * moved(sheet, "Nose") + WILD["Shape Detail Band 3"] * moved(
        sheet, "Shape Detail Band 3"
    )
    assert line() == text(*counted(sheet, mix)) != before


def test_an_uneven_scale_is_that_of_the_world(sheet):
    turn(sheet)
    even = line()
    sheet.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    assert line() == even
    sheet.scale = (1, 1, 0.05)
    bpy.context.view_layer.update()
    mix = sum(value * moved(sheet, name) for name, value in WILD.items())
    scale = np.array([1, 1, 0.05])
    shape = points(key(sheet, "Basis")) * scale
    folded, stretched = counted(sheet, mix * scale, shape)
    assert line() == text(folded, stretched) != even


def test_the_line_follows_keep_limbs(sheet):
    turn(sheet)
    seen = {line()}
    for amount in (0.5, 2.0):
        sheet.data.spectral_tv_limbs.keep = amount
        bpy.context.view_layer.update()
        mix = sum(value * moved(sheet, name) for name, value in WILD.items())
        folded, stretched = counted(sheet, mix)
        assert line() == (text(folded, stretched) if folded else f"{stretched} faces stretch")
        seen.add(line())
    assert len(seen) == 3


def test_of_a_face_of_several_triangles_one_face_is_counted(sheet):
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.tris_convert_to_quads(face_threshold=np.pi, shape_threshold=np.pi)
    bpy.ops.object.mode_set(mode="OBJECT")
    quads = len(sheet.data.polygons)
    assert quads < len(triangles(sheet))
    for name in list(sheet.data.shape_keys.key_blocks.keys()):
        key(sheet, name).value = 0
    bpy.ops.spectral_tv.decompose(bands=3, steps=12, **SCALES)
    bands = sheet.data.shape_keys.key_blocks[1:]
    turn(sheet, **{band.name: 10.0 for band in bands})
    counts = live_guard.line(bpy.context).text.split()
    assert 0 < int(counts[0]) <= quads
    mix = sum(10 * moved(sheet, band.name) for band in bands)
    faces, shape = triangles(sheet), points(key(sheet, "Basis"))
    turned = (normals(shape, faces) * normals(shape + mix, faces)).sum(axis=1) < 0
    polygons = np.array([each.polygon_index for each in sheet.data.loop_triangles])
    assert int(counts[0]) == len(set(polygons[turned])) < np.count_nonzero(turned)


def test_after_undo_the_count_is_that_of_then(sheet):
    bpy.ops.ed.undo_push(message="bands")
    turn(sheet)
    wild = line()
    bpy.ops.ed.undo_push(message="wild")
    turn(sheet, **{"Shape Detail Band 2": 1.0})
    calmer = line()
    assert calmer != wild
    bpy.ops.ed.undo_push(message="calmer")
    bpy.ops.ed.undo()
    assert line() == wild
    bpy.ops.ed.undo()
    assert line() == "No face folds"
    bpy.ops.ed.redo()
    assert line() == wild


@pytest.mark.parametrize("mode", ["EDIT", "SCULPT", "WEIGHT_PAINT"])
def test_where_the_mesh_is_under_work_nothing_is_said(sheet, mode):
    turn(sheet)
    wild = line()
    bpy.ops.object.mode_set(mode=mode)
    assert live_guard.line(bpy.context) is None
    bpy.ops.object.mode_set(mode="OBJECT")
    assert line() == wild


def test_bands_of_an_override_are_counted(sheet, tmp_path: Path):
    turn(sheet)
    wild = line()
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {sheet})
    bpy.data.batch_remove([sheet, sheet.data])
    with bpy.data.libraries.load(path, link=True) as (_, target):
        target.objects = ["Sheet"]
    (linked,) = target.objects
    bpy.context.scene.collection.objects.link(linked)
    bpy.context.view_layer.objects.active = linked
    bpy.context.view_layer.update()
    assert line() == wild
    layer = bpy.context.view_layer
    own = linked.override_hierarchy_create(bpy.context.scene, layer, do_fully_editable=True)
    layer.objects.active = own
    turn(own, **{"Shape Detail Band 3": 2.0})
    assert "face" in line() and line() != wild
    turn(own)
    assert line() == wild
    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes, *bpy.data.libraries])


def test_of_huge_meshes_the_user_has_to_ask(sheet, monkeypatch, capfd):
    monkeypatch.setattr(live_guard, "MOST_LIVE", 1000)
    turn(sheet)
    assert line() == ""
    assert bpy.ops.spectral_tv.count_folds() == {"FINISHED"}
    mix = sum(value * moved(sheet, name) for name, value in WILD.items())
    assert line() == text(*counted(sheet, mix))
    assert text(*counted(sheet, mix)) in capfd.readouterr().out
    turn(sheet, **{"Shape Detail Band 2": 1.0})
    assert line() == ""


def test_vertices_that_are_nowhere_take_their_faces_out(capfd):
    obj = sheet_with_bumps()
    obj.data.vertices[0].co.z = float("nan")
    bpy.ops.spectral_tv.decompose(bands=3, steps=12, leaves_out=True, **SCALES)
    turn(obj)
    assert line().split()[0] != "0" and "fold" in line()
    bpy.ops.spectral_tv.bake_safe()
    assert "no face folds in 'Safe'" in capfd.readouterr().out


def test_nothing_is_kept_of_more_than_two_objects_nor_of_a_closed_file():
    for name in ("One", "Two", "Three"):
        turn(banded(sheet_with_bumps(name)))
        assert "fold" in line()
    assert len(live_guard._watched) == 2
    assert live_guard._notice in bpy.app.handlers.depsgraph_update_post
    empty()
    assert not live_guard._watched
    assert live_guard._notice not in bpy.app.handlers.depsgraph_update_post
