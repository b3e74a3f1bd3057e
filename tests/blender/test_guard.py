"""What bands do to faces: counted as the sliders are turned, told, and baked safe."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import object_of
from command_line_files import decompose, empty, load, meshes
from reference_guard import lengths, normals
from shapes import grid

EXTENSION = "bl_ext.user_default.spectral_tv.bands"
live_guard = import_module(f"{EXTENSION}.live_guard")
STRETCH = import_module(f"{EXTENSION}.guard").STRETCH
SCALES = {"use_scales": True, "finest": 2, "largest": 30, "keep_limbs": 0, "soft_edges": 0}
# So much of these bands folds and stretches faces.
WILD = {"Shape Detail Band 2": 3.0, "Shape Detail Band 3": 3.0}


def sheet_with_bumps(name: str = "Sheet") -> bpy.types.Object:
    """A sheet with a bump on a bump, the active object."""
    vertices, faces = grid(31, 31, 2, 2)
    x, y = vertices[:, 0] - 1, vertices[:, 1] - 1
    vertices[:, 2] = 0.3 * np.exp(-4 * (x**2 + y**2)) + 0.1 * np.exp(-60 * (x**2 + y**2))
    obj = object_of(name, vertices, faces)
    obj.select_set(True)
    return obj


def banded(obj: bpy.types.Object) -> bpy.types.Object:
    bpy.ops.spectral_tv.decompose(bands=3, steps=12, **SCALES)
    return obj


def turn(obj: bpy.types.Object, **values: float) -> None:
    """Set sliders: wild ones where none is named."""
    for name, value in (values or WILD).items():
        key(obj, name).slider_min, key(obj, name).slider_max = -10, 10
        key(obj, name).value = value
    bpy.context.view_layer.update()


def key(obj: bpy.types.Object, name: str) -> bpy.types.ShapeKey:
    return obj.data.shape_keys.key_blocks[name]


def points(of: bpy.types.ShapeKey) -> np.ndarray:
    return np.array([point.co for point in of.data], dtype=np.float64)


def triangles(obj: bpy.types.Object) -> np.ndarray:
    obj.data.calc_loop_triangles()
    return np.array([triangle.vertices for triangle in obj.data.loop_triangles])


def moved(obj: bpy.types.Object, name: str) -> np.ndarray:
    return points(key(obj, name)) - points(obj.data.shape_keys.reference_key)


def counted(obj: bpy.types.Object, displacement: np.ndarray, shape=None) -> tuple[int, int]:
    """How many faces turn by over 90°, and how many have an edge that is too long."""
    shape = points(obj.data.shape_keys.reference_key) if shape is None else shape
    faces = triangles(obj)
    turned = (normals(shape, faces) * normals(shape + displacement, faces)).sum(axis=1) < 0
    stretched = lengths(shape + displacement, faces) > STRETCH * lengths(shape, faces)
    return np.count_nonzero(turned), np.count_nonzero(stretched.any(axis=1))


def text(folded: int, stretched: int) -> str:
    return f"{folded} faces fold, {stretched} stretch"


def line() -> str:
    """What the panel says under the sliders."""
    return live_guard.line(bpy.context).text


@pytest.fixture
def sheet():
    yield banded(sheet_with_bumps())
    live_guard.forget()


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


def test_baked_safe_nothing_folds(sheet, capfd):
    turn(sheet)
    mix = sum(value * moved(sheet, name) for name, value in WILD.items())
    assert bpy.ops.spectral_tv.bake_safe() == {"FINISHED"}
    safe = key(sheet, "Safe")
    assert safe.value == 0 and [key(sheet, name).value for name in WILD] == [*WILD.values()]
    assert counted(sheet, moved(sheet, "Safe")) == (0, 0)
    said = capfd.readouterr().out
    assert f"{text(*counted(sheet, mix))} in the mix; no face folds in 'Safe', which keeps" in said
    mesh = spectral_tv.Mesh(points(key(sheet, "Basis")), triangles(sheet))
    expected = spectral_tv.safe_displacement(mesh, mix)
    np.testing.assert_allclose(moved(sheet, "Safe"), expected.displacement, atol=1e-5)
    assert f"keeps {100 * expected.kept:.1f}"[:-2] in said
    assert line() == text(*counted(sheet, mix))


def test_the_stretch_can_be_chosen(sheet):
    turn(sheet, **{"Shape Detail Band 3": 1.0})
    bpy.ops.spectral_tv.bake_safe()
    bpy.ops.spectral_tv.bake_safe(stretch=1.05)
    shape, faces = points(key(sheet, "Basis")), triangles(sheet)
    before = lengths(shape, faces)
    for name, most in (("Safe", STRETCH), ("Safe.001", 1.05)):
        largest = (lengths(shape + moved(sheet, name), faces) / before).max()
        assert most / 1.4 < largest <= most + 1e-6


def test_what_does_not_fold_is_baked_as_it_is(sheet, capfd):
    smile = sheet.shape_key_add(name="Smile", from_mix=False)
    smile.data[3].co.z += 0.5
    turn(sheet, **{"Shape Detail Band 1": 0.5, "Shape Detail Band 3": 0.3, "Smile": 0.75})
    bpy.ops.spectral_tv.bake_safe()
    assert "keeps all of what the bands add" in capfd.readouterr().out
    mix = 0.5 * moved(sheet, "Shape Detail Band 1") + 0.3 * moved(sheet, "Shape Detail Band 3")
    np.testing.assert_allclose(moved(sheet, "Safe"), mix, atol=1e-6)


def test_what_is_taken_away_is_not_clamped(sheet, capfd):
    turn(sheet, **dict.fromkeys(WILD, -10.0))
    key(sheet, "Shape Detail Band 1").mute = True
    bpy.ops.spectral_tv.bake_safe()
    mix = sum(-10 * moved(sheet, name) for name in WILD)
    np.testing.assert_allclose(moved(sheet, "Safe"), mix, atol=1e-5)
    said = capfd.readouterr().out
    found = text(*counted(sheet, mix))
    assert "no band is above 0, so nothing is clamped" in said
    assert f"what bands below 0 take away is not clamped: with it {found}" in said


def test_what_is_added_is_clamped_on_what_is_left(sheet):
    """At −1 the small bump is gone; what the other band adds is safe on the shape without it."""
    turn(
        sheet,
        **{"Shape Detail Band 1": -1.0, "Shape Detail Band 2": -1.0, "Shape Detail Band 3": 8.0},
    )
    taken = -moved(sheet, "Shape Detail Band 1") - moved(sheet, "Shape Detail Band 2")
    bpy.ops.spectral_tv.bake_safe()
    added = moved(sheet, "Safe") - taken
    left = points(key(sheet, "Basis")) + taken
    assert counted(sheet, 8 * moved(sheet, "Shape Detail Band 3"), left) != (0, 0)
    assert counted(sheet, added, left) == (0, 0)


def test_parts_that_meet_are_told(capfd):
    """Two sheets face to face, each with a bump: raised, they cross without any fold."""
    vertices, faces = grid(21, 21, 2, 2)
    x, y = vertices[:, 0] - 1, vertices[:, 1] - 1
    vertices[:, 2] = 0.2 * np.exp(-4 * (x**2 + y**2))
    other = vertices * [1, 1, -1] + [0, 0, 0.7]
    both = np.vstack([vertices, other])
    obj = banded(object_of("Mouth", both, np.vstack([faces, faces[:, ::-1] + len(vertices)])))
    turn(obj, **{"Shape Detail Band 3": 1.5})
    bpy.ops.spectral_tv.bake_safe()
    said = capfd.readouterr().out
    assert "parts meet that lie apart, which clamping does not prevent" in said
    assert "0 without the bands" in said
    faces = triangles(obj)
    for shape in ("Basis", "Safe"):
        mesh = spectral_tv.Mesh(points(key(obj, shape)), faces)
        crossing = len(spectral_tv.self_intersections(mesh))
        assert (crossing > 0) == (shape == "Safe")
        if crossing:
            assert f"{crossing} triangles cross" in said


def test_the_midline_of_a_mirrored_object_stays(capfd):
    obj = sheet_with_bumps()
    for vertex in obj.data.vertices:
        vertex.co.x -= 1
    far = [vertex.index for vertex in obj.data.vertices if vertex.co.x < -1e-6]
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    for index in far:
        obj.data.vertices[index].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.delete(type="VERT")
    bpy.ops.object.mode_set(mode="OBJECT")
    for vertex in obj.data.vertices:
        vertex.co.x = 0 if vertex.co.x < 0.03 else vertex.co.x
    obj.modifiers.new("Mirror", "MIRROR")
    banded(obj)
    turn(obj)
    bpy.ops.spectral_tv.bake_safe()
    assert "no face folds in 'Safe'" in capfd.readouterr().out
    basis = points(key(obj, "Basis"))
    middle = basis[:, 0] == 0
    assert middle.sum() > 20
    np.testing.assert_allclose(moved(obj, "Safe")[middle, 0], 0, atol=1e-6)
    assert counted(obj, moved(obj, "Safe")) == (0, 0)


def test_objects_that_meet_stay_joined():
    vertices, faces = grid(31, 31, 2, 2)
    x, y = vertices[:, 0] - 1, vertices[:, 1] - 1
    vertices[:, 2] = 0.3 * np.exp(-8 * (x**2 + y**2))
    side = vertices[faces].mean(axis=1)[:, 0] > 1
    for name, chosen in (("Left", faces[~side]), ("Right", faces[side])):
        kept, numbers = np.unique(chosen, return_inverse=True)
        obj = object_of(name, vertices[kept], numbers.reshape(-1, 3))
        obj.select_set(True)
    bpy.ops.spectral_tv.decompose(bands=3, steps=12, together=True, **SCALES)
    halves = [bpy.data.objects[name] for name in ("Left", "Right")]
    for obj in halves:
        turn(obj, **{"Shape Detail Band 3": 9.0})
    assert bpy.ops.spectral_tv.bake_safe(together=True) == {"FINISHED"}
    seams = []
    for obj in halves:
        basis = points(key(obj, "Basis"))
        seam = np.flatnonzero(np.abs(basis[:, 0] - 1) < 1e-6)
        order = seam[np.argsort(basis[seam, 1])]
        seams.append(points(key(obj, "Safe"))[order])
        assert counted(obj, moved(obj, "Safe")) == (0, 0)
        assert counted(obj, 9 * moved(obj, "Shape Detail Band 3")) != (0, 0)
    assert len(seams[0]) == 31
    np.testing.assert_allclose(seams[0], seams[1], atol=1e-6)


def test_without_bands_it_is_refused():
    sheet_with_bumps()
    for name in ("bake_safe", "count_folds"):
        with pytest.raises(RuntimeError, match="has no bands; decompose it first"):
            getattr(bpy.ops.spectral_tv, name)()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    sheet_with_bumps()
    path = tmp_path / "sheet.blend"
    bpy.data.libraries.write(str(path), {bpy.context.scene})
    yield path
    empty()


GAINS = [
    "--gain",
    "2=4",
    "--gain",
    "3=4",
    "--finest",
    "2",
    "--largest",
    "30",
    "--keep-limbs",
    "0",
    "--soft-edges",
    "0",
]


def test_the_command_line_tells_of_folds(file, tmp_path: Path, capfd):
    target = tmp_path / "out.blend"
    assert decompose(file, target, *GAINS) == 0
    said = capfd.readouterr().err
    load(target)
    (obj,) = meshes()
    mix = sum(key(obj, name).value * moved(obj, name) for name in WILD)
    assert f"at these gains {text(*counted(obj, mix))}; --safe clamps what they add" in said
    assert decompose(file, target, *GAINS, "--gain", "2=1.1", "--gain", "3=1.1") == 0
    assert "fold" not in capfd.readouterr().err


def test_safe_files_have_no_folds(file, tmp_path: Path, capfd):
    target = tmp_path / "out.blend"
    assert decompose(file, target, *GAINS, "--safe") == 0
    assert "no face folds in 'Safe'" in capfd.readouterr().err
    load(target)
    (obj,) = meshes()
    assert key(obj, "Safe").value == 1 and key(obj, "Shape Detail Band 3").value == 0
    assert counted(obj, moved(obj, "Safe")) == (0, 0)
    shape = points(key(obj, "Safe"))
    assert decompose(file, tmp_path / "out.ply", *GAINS, "--safe") == 0
    load(tmp_path / "out.ply")
    (obj,) = meshes()
    world = np.array([obj.matrix_world @ vertex.co for vertex in obj.data.vertices])
    np.testing.assert_allclose(world, shape, atol=1e-5)
    # Where nothing folds, the bands can still be dialled.
    assert decompose(file, target, *GAINS, "--gain", "2=1.1", "--gain", "3=1.1", "--safe") == 0
    load(target)
    assert "Safe" not in meshes()[0].data.shape_keys.key_blocks
    assert key(meshes()[0], "Shape Detail Band 3").value == pytest.approx(0.1)


def test_over_frames_folds_are_told_once(tmp_path: Path, capfd):
    obj = sheet_with_bumps()
    obj.shape_key_add(name="Basis")
    lifted = obj.shape_key_add(name="Lifted", from_mix=False)
    for point in lifted.data:
        point.co.z *= 2
    for frame, value in ((1, 0.0), (3, 1.0)):
        lifted.value = value
        lifted.keyframe_insert("value", frame=frame)
    bpy.context.scene.frame_end = 3
    path = tmp_path / "moving.blend"
    bpy.data.libraries.write(str(path), {bpy.context.scene})
    for options, told in (
        ([], "at most in a frame, and some in 3 of 3"),
        (["--safe"], "at most in a frame, before they are clamped, and some in 3 of 3"),
    ):
        target = tmp_path / "out.blend"
        assert decompose(path, target, *GAINS, *options, "--frames", "1-3") == 0
        assert capfd.readouterr().err.count(told) == 1
        load(target)
        (obj,) = meshes()
        shapes = [points(each) for each in obj.data.shape_keys.key_blocks[1:]]
        assert len(shapes) == 3
    empty()
