"""Looks that are held within a limit, measured, and shown beside the original."""

from __future__ import annotations

import json
from importlib import import_module

import bmesh
import bpy
import numpy as np
import pytest
from ball import ball, bumpy_ball, saved_and_loaded
from command_line_files import load, meshes, run, write_monkey
from conftest import MODULE
from deform_scene import coordinates, evaluated
from masked_ball import weights
from mathutils import Euler, Matrix

records = import_module(f"{MODULE}.scene.records")
original = import_module(f"{MODULE}.bands.original")
heat_map = import_module(f"{MODULE}.deviation.heat_map")
lengths = import_module(f"{MODULE}.scene.lengths")
# As the objects' matrices have them: evenly, unevenly, sheared and turned over.
TURN = Euler((0.4, 1.1, -0.3)).to_matrix().to_4x4()
MATRICES = {
    "even": Matrix.Diagonal((3, 3, 3, 1)),
    "uneven": TURN @ Matrix.Diagonal((0.2, 5, 1, 1)),
    "sheared": Matrix.Diagonal((1, 3, 0.5, 1)) @ TURN @ Matrix.Diagonal((2, 1, 1, 1)),
    "mirrored": Matrix.Diagonal((-2, 1, 4, 1)),
}


@pytest.fixture(autouse=True)
def _no_texts():
    yield
    bpy.data.batch_remove([*bpy.data.texts])


def made(matrix: Matrix | None = None, recipe: str = "Exaggerate Skin", **more) -> bpy.types.Object:
    """A ball with bumps by a recipe, in a place of its own."""
    obj = bumpy_ball()
    obj.matrix_world = Matrix.Translation((3, -2, 1)) @ (matrix or Matrix())
    bpy.context.view_layer.update()
    assert bpy.ops.spectral_tv.recipe(recipe=recipe, **more) == {"FINISHED"}
    return obj


def deviations(obj: bpy.types.Object) -> np.ndarray:
    """How far vertices are seen from where they were, in the world, (V,)."""
    matrix = np.array(obj.matrix_world)[:3, :3]
    return np.linalg.norm((evaluated(obj) - coordinates(obj.data.vertices)) @ matrix.T, axis=1)


def limit(length: float) -> None:
    assert bpy.ops.spectral_tv.limit_movement(limit=length) == {"FINISHED"}


def groups(obj: bpy.types.Object) -> list[str]:
    return [band.vertex_group for band in records.bands_of(obj)]


@pytest.mark.parametrize("name", MATRICES)
def test_no_vertex_is_seen_farther_from_the_original_than_the_limit(name, capfd):
    obj = made(MATRICES[name])
    free = deviations(obj)
    for asked in (0.5 * free.max(), 0.05 * free.max(), 2 * free.max(), 1e-5, 0.3 * free.max()):
        length = float(np.float32(asked))
        capfd.readouterr()
        limit(length)
        held = deviations(obj)
        assert held.max() <= length
        # What is within the limit stays, and what is not goes as far as it may.
        np.testing.assert_allclose(held, np.minimum(free, length), atol=2e-5)
        count = np.count_nonzero(free > length)
        told = f"{count} of {len(free)} vertices" if count else "no vertex is moved by more than"
        assert told in capfd.readouterr().out
    limit(0)
    np.testing.assert_allclose(deviations(obj), free, atol=1e-6 * free.max())
    assert not [group.name for group in obj.vertex_groups if "Limit" in group.name]
    assert records.record_of(obj).limit == 0


def test_it_holds_far_from_the_middle_of_the_object_where_coordinates_are_coarse():
    obj = bumpy_ball()
    moved = coordinates(obj.data.vertices) + np.array([1000, -3000, 200])
    obj.data.vertices.foreach_set("co", moved.astype(np.float32).ravel())
    obj.data.update()
    bpy.ops.spectral_tv.recipe(recipe="Exaggerate Skin", strength=2)
    for length in (0.1, 0.01, 0.001):
        limit(length)
        assert deviations(obj).max() <= np.float32(length)


def test_all_decompositions_count_together_with_their_masks():
    obj = made()
    bpy.ops.spectral_tv.recipe(recipe="Flatten Plates", strength=0.5)
    records.bands_of(obj)[1].vertex_group = "Cap"
    obj.data.update_tag()
    free = deviations(obj)
    masks = {band.name: band.vertex_group for band in records.all_bands_of(obj)}
    limit(float(0.3 * free.max()))
    assert deviations(obj).max() <= np.float32(0.3 * free.max())
    names = {
        masks[band.name]: band.vertex_group for band in records.all_bands_of(obj) if band.value
    }
    assert names["Cap"] == "Cap Limit" and names[""] == "Movement Limit"
    assert (weights(obj, "Cap Limit") <= weights(obj, "Cap") + 1e-6).all()
    limit(0)
    assert {band.name: band.vertex_group for band in records.all_bands_of(obj)} == masks
    np.testing.assert_allclose(deviations(obj), free, atol=1e-6)


def test_it_holds_for_all_objects_that_share_the_mesh():
    obj = made()
    other = bpy.data.objects.new("Other", obj.data)
    bpy.context.scene.collection.objects.link(other)
    other.scale = (1, 7, 1)
    bpy.context.view_layer.update()
    limit(0.02)
    assert deviations(obj).max() < deviations(other).max() <= np.float32(0.02)


def test_a_mask_of_a_limit_that_was_painted_is_the_user_s():
    obj = made()
    limit(0.005)
    (name,) = {*groups(obj)} - {""}
    obj.vertex_groups[name].add([0, 1, 2], 0.001, "REPLACE")
    painted = weights(obj, name)
    limit(0.004)
    np.testing.assert_array_equal(weights(obj, name), painted)
    assert deviations(obj).max() <= np.float32(0.004)
    assert name not in groups(obj)
    limit(0)
    assert name in groups(obj) and len(obj.vertex_groups) == 2


@pytest.mark.parametrize("recipe", ["Clean Scan", "Exaggerate Skin", "Stylize"])
def test_a_recipe_has_a_limit_which_goes_with_it(recipe, capfd):
    obj = made(MATRICES["uneven"], recipe)
    free = deviations(obj)
    length = float(np.float32(0.4 * free.max()))
    capfd.readouterr()
    bpy.ops.spectral_tv.recipe(recipe=recipe, limit=length)
    said = capfd.readouterr().out
    count = np.count_nonzero(free > length)
    assert f"{count} of {len(free)} vertices" in said and "held back at" in said
    assert deviations(obj).max() <= length
    assert records.record_of(obj).limit == pytest.approx(length)
    bpy.ops.spectral_tv.recipe(recipe=recipe)
    np.testing.assert_allclose(deviations(obj), free, atol=1e-6 * free.max())
    assert not [group.name for group in obj.vertex_groups if "Limit" in group.name]
    assert len(obj.data.spectral_tv.decompositions) == 1


def test_limits_of_two_recipes_do_not_meddle():
    obj = made(limit=0.02)
    first = deviations(obj)
    bpy.ops.spectral_tv.recipe(recipe="Stylize", limit=0.01)
    one, other = records.records_of(obj)
    assert one.limit == pytest.approx(0.02) and other.limit == pytest.approx(0.01)
    assert deviations(obj).max() <= np.float32(0.03)
    bpy.ops.spectral_tv.recipe(recipe="Stylize", strength=0)
    np.testing.assert_allclose(deviations(obj), first, atol=1e-6)


@pytest.mark.parametrize("name", MATRICES)
def test_figures_are_those_of_what_is_seen(name, tmp_path):
    obj = made(MATRICES[name])
    points, seen = (
        each @ np.array(obj.matrix_world)[:3, :3].T
        for each in (coordinates(obj.data.vertices), evaluated(obj))
    )
    away = np.linalg.norm(seen - points, axis=1)
    path = tmp_path / "deviation.json"
    bpy.context.scene.unit_settings.scale_length = 0.001
    try:
        bpy.ops.spectral_tv.measure_deviation(limit=0.1 * away.max(), filepath=str(path))
    finally:
        bpy.context.scene.unit_settings.scale_length = 1
    found = json.loads(path.read_text())
    assert found == json.loads(bpy.data.texts["Ball Deviation.json"].as_string())
    before, after = (measured(each, obj) for each in (points, seen))
    for part, (areas, volume) in (("before", before), ("after", after)):
        assert found[part]["area"] == pytest.approx(areas.sum() / 3, rel=1e-5)
        assert found[part]["volume"] == pytest.approx(volume, rel=1e-5)
    shares = before[0] / before[0].sum()
    deviation = found["deviation"]
    assert deviation["largest"] == pytest.approx(away.max(), rel=1e-4)
    assert deviation["mean"] == pytest.approx(shares @ away, rel=1e-4)
    assert deviation["root_mean_square"] == pytest.approx((shares @ away**2) ** 0.5, rel=1e-4)
    below = shares[away <= deviation["percentile_99"] * (1 + 1e-4)].sum()
    assert 0.99 <= below < 0.995
    ends = deviation["farthest_inwards"], deviation["farthest_outwards"]
    assert max(ends) == deviation["largest"] and min(ends) > 0
    count = int(np.count_nonzero(away > 0.1 * away.max()))
    assert found["over_limit"] == {"vertices": count, "share": count / len(points)}
    assert found["held_back"] == {"vertices": 0, "share": 0}
    assert found["unit"] == {"system": "metric", "metres_per_unit": 0.001}
    (decomposition,) = found["decompositions"]
    assert decomposition["settings"]["method"] == "M1"
    assert decomposition["recipe"] == "Exaggerate Skin" and decomposition["limit"] is None
    assert [band["value"] for band in decomposition["bands"]] == [0.7, 1.2, 1.1, 0.6, 0]
    assert found["versions"]["blender"] == bpy.app.version_string


def measured(points: np.ndarray, obj: bpy.types.Object) -> tuple[np.ndarray, float]:
    """The areas of the faces at each vertex, and the volume, as Blender has them."""
    edited = bmesh.new()
    edited.from_mesh(obj.data)
    for vertex, place in zip(edited.verts, points, strict=True):
        vertex.co = place
    areas = [sum(face.calc_area() for face in vertex.link_faces) for vertex in edited.verts]
    volume = abs(edited.calc_volume())
    edited.free()
    return np.array(areas), volume


def test_an_open_surface_has_no_volume_and_inwards_is_negative():
    obj = made(MATRICES["mirrored"], "Stylize", strength=2.0)
    obj.data.shape_keys.key_blocks[1].value = -1
    bpy.ops.spectral_tv.measure_deviation()
    found = json.loads(bpy.data.texts["Ball Deviation.json"].as_string())
    seen = deviations(obj)
    signed = np.empty(len(seen), dtype=np.float32)
    obj.data.attributes["Deviation"].data.foreach_get("value", signed)
    np.testing.assert_allclose(np.abs(signed), seen, atol=1e-5)
    # On a ball, outwards is away from the middle.
    points = coordinates(obj.data.vertices)
    matrix = np.array(obj.matrix_world)[:3, :3]
    graph = bpy.context.evaluated_depsgraph_get()
    normals = np.array([each.vector for each in obj.data.vertex_normals])
    outwards = normals @ np.linalg.inv(matrix)
    along = np.einsum("ij,ij->i", (evaluated(obj) - points) @ matrix.T, outwards)
    is_clear = np.abs(along) > 0.3 * seen * np.linalg.norm(outwards, axis=1)
    assert graph is not None and is_clear.sum() > 100
    assert (np.sign(signed) == np.sign(along))[is_clear].mean() > 0.99
    assert found["before"]["volume"] is not None and found["limit"] is None
    grid_of_one_side()
    bpy.ops.spectral_tv.recipe(recipe="Exaggerate Skin")
    bpy.ops.spectral_tv.measure_deviation()
    assert json.loads(bpy.data.texts["Sheet Deviation.json"].as_string())["after"]["volume"] is None


def grid_of_one_side() -> bpy.types.Object:
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=12)
    obj = bpy.context.object
    obj.name = "Sheet"
    for vertex in obj.data.vertices:
        vertex.co.z = 0.1 * np.sin(9 * vertex.co.x) * np.cos(5 * vertex.co.y)
    return obj


def test_figures_tell_what_a_limit_holds_back():
    obj = made(MATRICES["uneven"])
    free = deviations(obj)
    length = float(np.float32(0.4 * free.max()))
    limit(length)
    bpy.ops.spectral_tv.measure_deviation()
    found = json.loads(bpy.data.texts["Ball Deviation.json"].as_string())
    assert found["limit"] == pytest.approx(length)
    assert found["over_limit"]["vertices"] == 0
    assert found["held_back"]["vertices"] == np.count_nonzero(free > length)
    assert found["deviation"]["largest"] == pytest.approx(length, rel=1e-3)


def test_the_original_is_shown_and_the_look_comes_back_as_it_was(tmp_path):
    obj = made()
    bpy.ops.spectral_tv.recipe(recipe="Stylize")
    bands = records.all_bands_of(obj)
    bands[1].mute = True
    bpy.ops.spectral_tv.solo(band=2)  # of the second one
    look = evaluated(obj)
    mutes = [band.mute for band in bands]
    assert True in mutes and False in mutes
    bpy.ops.spectral_tv.show_original()
    assert original.is_shown(obj) and all(band.mute for band in bands)
    np.testing.assert_array_equal(evaluated(obj), coordinates(obj.data.vertices))
    for refused in ("filter", "solo", "apply_look", "recipe", "decompose", "limit_movement"):
        with pytest.raises(RuntimeError, match="The original is shown"):
            getattr(bpy.ops.spectral_tv, refused)()
    loaded = saved_and_loaded(obj, tmp_path / "original.blend")
    bpy.context.scene.collection.objects.link(loaded)
    bpy.context.view_layer.objects.active = loaded
    assert original.is_shown(loaded)
    bpy.ops.spectral_tv.show_original()
    assert [band.mute for band in records.all_bands_of(loaded)] == mutes
    np.testing.assert_array_equal(evaluated(loaded), look)
    assert records.record_of(loaded).solo == 2
    bpy.ops.spectral_tv.solo(band=2)  # ends it
    assert sum(band.mute for band in records.all_bands_of(loaded)) == 1


def test_what_is_unmuted_while_the_original_is_shown_stays_so():
    obj = made()
    bands = records.bands_of(obj)
    bands[0].mute = bands[1].mute = True
    bpy.ops.spectral_tv.show_original()
    bands[0].mute = False
    assert not original.is_shown(obj)
    bpy.ops.spectral_tv.show_original()  # it is shown again, and the look is that of now
    assert original.is_shown(obj)
    bpy.ops.spectral_tv.show_original()
    assert [band.mute for band in bands] == [False, True, False, False, False]


def test_the_heat_map_is_where_the_surface_is_seen_and_has_a_range():
    obj = made(MATRICES["uneven"])
    graph = bpy.context.evaluated_depsgraph_get()
    layer = heat_map.layer_of(obj, graph)
    np.testing.assert_allclose(layer.positions, evaluated(obj))
    np.testing.assert_allclose(np.abs(layer.signed), deviations(obj), atol=1e-5)
    scene = bpy.context.scene
    assert heat_map.most_of(layer, scene) == pytest.approx(deviations(obj).max(), rel=1e-4)
    scene.spectral_tv_deviation.range = 0.25
    assert heat_map.most_of(layer, scene) == 0.25
    scene.spectral_tv_deviation.range = 0
    colors = heat_map.colors(np.array([-2.0, -1.0, 0.0, 1.0]), 1.0)
    np.testing.assert_array_equal(colors[0], colors[1])
    blue, _, none, red = colors
    assert blue[2] > blue[0] and red[0] > red[2] and none[:3].min() > 0.85
    obj.modifiers.new("Subdivision", "SUBSURF")
    layer = heat_map.layer_of(obj, bpy.context.evaluated_depsgraph_get())
    assert not layer.is_exact and len(layer.positions) == len(obj.data.vertices)


def test_without_a_look_there_is_nothing_to_limit_or_measure():
    ball("Ball")
    for name in ("limit_movement", "measure_deviation", "show_original"):
        with pytest.raises(RuntimeError, match="has no bands"):
            getattr(bpy.ops.spectral_tv, name)()
    obj = made()
    obj.show_only_shape_key = True
    with pytest.raises(RuntimeError, match="shows one shape key alone"):
        bpy.ops.spectral_tv.limit_movement(limit=1)


def test_the_command_line_holds_and_reports(tmp_path, capfd):
    source = write_monkey(tmp_path / "monkey.ply")
    report, target = tmp_path / "report.jsonl", tmp_path / "skin.blend"
    places = [str(source), "-o", str(target), "--report", str(report), "--limit", "0.01"]
    assert run(["recipe", *places, "--recipe", "Exaggerate Skin", "--strength", "2"]) == 0
    assert "held back at 1 cm" in capfd.readouterr().err
    assert run(["decompose", *places, "--bands", "3", "--gain", "1=3", "--gain", "2=0"]) == 0
    one, other = (json.loads(line) for line in report.read_text().splitlines())
    for line in (one, other):
        (found,) = line["done"]["deviation"].values()
        assert line["done"]["settings"]["limit"] == 0.01 == found["limit"]
        assert found["over_limit"]["vertices"] == 0 < found["held_back"]["vertices"]
        assert 0.0099 < found["deviation"]["largest"] <= 0.01
        assert any("held back" in text for text in line["warnings"])
    load(target)
    assert 0.0099 < deviations(meshes()[0]).max() <= 0.01


def test_the_command_line_holds_what_is_clamped_too(tmp_path):
    source = write_monkey(tmp_path / "monkey.ply")
    target = tmp_path / "safe.blend"
    gains = [f"--gain={band}=4" for band in (1, 2, 3)]
    command = ["decompose", str(source), "-o", str(target), "--bands", "3", *gains, "--safe"]
    assert run(command) == 0
    load(target)
    free = deviations(meshes()[0]).max()
    assert run([*command, "--limit", f"{free / 3:g}"]) == 0
    load(target)
    obj = meshes()[0]
    assert obj.data.shape_keys.key_blocks["Safe"].value == 1
    assert 0.99 * free / 3 < deviations(obj).max() <= free / 3 * (1 + 1e-5)


@pytest.mark.parametrize(
    "verb", [["recipe", "--recipe", "Stylize"], ["decompose", "--bands=2", "--gain=1=3"]]
)
def test_the_command_line_holds_each_frame_and_tells_it_once(verb, tmp_path, capfd):
    source = write_monkey(tmp_path / "monkey.ply")
    load(source)
    before = coordinates(meshes()[0].data.vertices)
    target, report = tmp_path / "out.blend", tmp_path / "report.jsonl"
    options = ["--frames", "1-3", "--limit", "0.002", "--report", str(report)]
    assert run([*verb, str(source), "-o", str(target), *options]) == 0
    said = capfd.readouterr().err
    assert said.count("held back at 2 mm") == 1 and "some in 3 of 3" in said
    load(target)
    for frame in (1, 2, 3):
        bpy.context.scene.frame_set(frame)
        away = np.linalg.norm(evaluated(meshes()[0]) - before, axis=1)
        assert 0.0019 < away.max() <= 0.002 + 1e-6
    assert "deviation" not in json.loads(report.read_text())["done"]
