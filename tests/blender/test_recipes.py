"""bpy.ops.spectral_tv.recipe: a decomposition and a filter in one step, by one strength."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest
from ball import ball, bumpy_ball, object_of
from command_line_files import band_values, load, meshes, run, write_monkey
from conftest import MODULE
from deform_scene import coordinates, evaluated
from shapes import bumpy_sphere

RECIPES = {each.name: each for each in import_module(f"{MODULE}.recipes.recipes").RECIPES}
own = import_module(f"{MODULE}.recipes.own")
noise = import_module(f"{MODULE}.recipes.noise")
guard = import_module(f"{MODULE}.bands.guard")
flows = import_module(f"{MODULE}.bands.bands").flows
records = import_module(f"{MODULE}.scene.records")
DIALLED = [name for name, each in RECIPES.items() if not each.cleans]


@pytest.fixture(autouse=True)
def _no_own_recipes():
    yield
    for path, _ in own.own():
        path.unlink()


def make(name: str, strength: float = 1.0, **more: object) -> None:
    assert bpy.ops.spectral_tv.recipe(recipe=name, strength=strength, **more) == {"FINISHED"}


def listed(obj: bpy.types.Object) -> list[str]:
    return [each.name for each in obj.data.spectral_tv.decompositions]


def values(obj: bpy.types.Object) -> list[float]:
    return [band.value for band in records.bands_of(obj)]


def counts(obj: bpy.types.Object) -> object:
    return guard.Reference().counts(obj, records.all_bands_of(obj))


@pytest.mark.parametrize("name", DIALLED)
def test_one_step_decomposes_and_dials(name):
    obj = bumpy_ball()
    before = coordinates(obj.data.vertices)
    make(name)
    recipe = RECIPES[name]
    assert listed(obj) == [name] and values(obj) == pytest.approx(recipe.values)
    assert obj.data.shape_keys.key_blocks[1].name == f"{name} Band 1"
    assert records.record_of(obj).method == recipe.settings.method
    np.testing.assert_array_equal(coordinates(obj.data.vertices), before)
    assert np.abs(evaluated(obj) - before).max() > 1e-3


def test_it_is_of_the_active_object_alone_and_tells_of_others(capfd):
    other, obj = ball("Other"), ball("Active")
    other.select_set(True)
    make("Caricature")
    assert "alone: the other selected mesh stays as it is" in capfd.readouterr().out
    assert listed(obj) == ["Caricature"] and other.data.shape_keys is None
    other.select_set(False)
    make("Caricature")
    assert "selected" not in capfd.readouterr().out


@pytest.mark.parametrize("name", DIALLED)
def test_another_strength_dials_the_same_bands_without_a_new_flow(name):
    obj = bumpy_ball()
    flows.clear()
    make(name)
    for strength in (0.5, 2.0, 0.0):
        make(name, strength)
        assert len({id(flow.split) for flow in flows.values()}) == 1
        assert listed(obj) == [name]
        wanted = [max(strength * value, min(value, -1)) for value in RECIPES[name].values]
        assert values(obj) == pytest.approx(wanted)
    np.testing.assert_allclose(evaluated(obj), coordinates(obj.data.vertices), atol=1e-6)


def test_recipes_go_on_top_of_one_another_and_are_dialled_apart():
    obj = bumpy_ball()
    make("Exaggerate Skin")
    one = evaluated(obj)
    make("Flatten Plates", 0.0)
    assert listed(obj) == ["Exaggerate Skin", "Flatten Plates"]
    np.testing.assert_allclose(evaluated(obj), one, atol=1e-5)
    make("Exaggerate Skin", 0.0)
    assert listed(obj) == ["Exaggerate Skin", "Flatten Plates"]
    assert records.record_of(obj).name == "Exaggerate Skin" and values(obj) == [0] * 5


def test_a_recipe_is_known_by_what_made_it_and_not_by_its_name():
    obj = bumpy_ball()
    make("Exaggerate Skin")
    records.record_of(obj).name = "Wrinkles"
    make("Exaggerate Skin", 0.5)
    assert listed(obj) == ["Wrinkles"]
    bpy.ops.spectral_tv.decompose(bands=3, steps=9, into="ADD")
    assert listed(obj) == ["Wrinkles", "Shape Detail"]
    make("Caricature", 0.0)
    assert listed(obj) == ["Wrinkles", "Shape Detail", "Caricature"]


def spiky() -> bpy.types.Object:
    """A ball whose spikes fold where they are exaggerated."""
    vertices, faces = bumpy_sphere(4, amplitude=0.3)
    spikes = 1 + 0.12 * np.random.default_rng(0).standard_normal((len(vertices), 1))
    return object_of("Spiky", spikes * vertices, faces)


def test_what_is_added_folds_nothing_at_that_strength_and_below():
    obj = spiky()
    make("Exaggerate Skin", 2.0)
    group = obj.vertex_groups["Exaggerate Skin Mask"]
    bands = records.bands_of(obj)
    assert {band.vertex_group for band in bands} == {group.name}
    for strength in (2.0, 1.5, 1.0, 0.5):
        for band, value in zip(bands, RECIPES["Exaggerate Skin"].values, strict=True):
            band.value = strength * value
        assert not counts(obj), strength
    for band, value in zip(bands, RECIPES["Exaggerate Skin"].values, strict=True):
        band.value, band.vertex_group = 2 * value, ""
    assert counts(obj)


def test_the_mask_goes_once_it_is_not_needed_and_one_of_the_user_stays(capfd):
    obj = spiky()
    make("Exaggerate Skin", 2.0)
    make("Exaggerate Skin", 1.9)
    assert [group.name for group in obj.vertex_groups] == ["Exaggerate Skin Mask"]
    assert "Warning" not in capfd.readouterr().out
    make("Exaggerate Skin", 0.1)
    assert not obj.vertex_groups and {band.vertex_group for band in records.bands_of(obj)} == {""}
    obj.vertex_groups.new(name="Mine").add([0, 1, 2], 1, "REPLACE")
    records.bands_of(obj)[1].vertex_group = "Mine"
    make("Exaggerate Skin", 2.0)
    groups = [band.vertex_group for band in records.bands_of(obj)]
    assert groups == ["Exaggerate Skin Mask", "Mine", *["Exaggerate Skin Mask"] * 3]


def box(side: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """A cube of so many vertices along an edge, as vertices and triangles."""
    grid = np.linspace(-1, 1, side)
    index = np.arange(side * side).reshape(side, side)[:-1, :-1].ravel()
    square = np.concatenate(
        [
            np.column_stack([index, index + side, index + side + 1]),
            np.column_stack([index, index + side + 1, index + 1]),
        ]
    )
    places, faces = [], []
    for axis in range(3):
        for end in (-1.0, 1.0):
            u, v = np.meshgrid(grid, grid, indexing="ij")
            place = np.empty((side * side, 3))
            place[:, axis], place[:, axis - 2], place[:, axis - 1] = end, u.ravel(), v.ravel()
            faces.append((square if end > 0 else square[:, ::-1]) + len(places) * side * side)
            places.append(place)
    vertices, inverse = np.unique(np.concatenate(places).round(9), axis=0, return_inverse=True)
    return vertices, inverse.ravel()[np.concatenate(faces)]


def noisy(vertices: np.ndarray, normals: np.ndarray, size: float) -> np.ndarray:
    sizes = np.random.default_rng(1).normal(0, size, (len(vertices), 1))
    return vertices + sizes * normals


def test_a_scan_is_cleaned_of_the_noise_that_it_has_and_keeps_its_edges(capfd):
    vertices, faces = box()
    step = 2 / 39
    on = np.abs(np.abs(vertices) - 1) < 1e-6
    outwards = np.where(on, vertices, 0) / np.sqrt(on.sum(axis=1, keepdims=True))
    is_edge = on.sum(axis=1) > 1
    rough = noisy(vertices, outwards, 0.2 * step)
    obj = object_of("Scan", rough, faces)
    make("Clean Scan")
    assert "of the edges' length" in capfd.readouterr().out

    def error(shape: np.ndarray, where: np.ndarray) -> float:
        away = np.einsum("ij,ij->i", shape - vertices, outwards)[where]
        return float(np.sqrt((away**2).mean()))

    cleaned = evaluated(obj)
    assert error(cleaned, ~is_edge) < 0.5 * error(rough, ~is_edge)
    assert error(cleaned, is_edge) < 1.3 * error(rough, is_edge)
    for band in records.bands_of(obj):
        band.vertex_group = ""
    assert error(evaluated(obj), is_edge) > 1.6 * error(cleaned, is_edge)


@pytest.mark.parametrize("share", [0.05, 0.1, 0.3])
@pytest.mark.parametrize("scale", [1.0, 1000.0])
def test_the_noise_is_estimated(share, scale):
    vertices, faces = bumpy_sphere(5, amplitude=0.05)
    normals = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    spectral_tv = import_module("spectral_tv")
    edge = noise.Noise.of(spectral_tv.Mesh(vertices, faces)).edge
    mesh = spectral_tv.Mesh(scale * noisy(vertices, normals, share * edge), faces)
    assert noise.Noise.of(mesh).size == pytest.approx(scale * share * edge, rel=0.12)


def test_a_clean_shape_is_hardly_changed_and_that_is_told(capfd):
    vertices, faces = box(12)
    obj = object_of("Clean", vertices, faces)
    make("Clean Scan")
    assert "hardly any noise" in capfd.readouterr().out
    np.testing.assert_allclose(evaluated(obj), vertices, atol=1e-6)


def test_more_strength_takes_more_noise():
    vertices, faces = bumpy_sphere(4, amplitude=0.05)
    normals = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    rough = noisy(vertices, normals, 0.01)
    object_of("Scan", rough, faces)
    moved = []
    for strength in (0.0, 0.5, 1.0, 1.5):
        make("Clean Scan", strength)
        moved.append(np.abs(evaluated(bpy.context.object) - rough).mean())
    assert moved[0] < 1e-7 and moved == sorted(moved) and len(set(moved)) == 4


def test_an_unknown_recipe_is_refused_and_those_that_there_are_are_named():
    obj = ball("Ball")
    with pytest.raises(RuntimeError, match="no recipe 'Soup'; there are Exaggerate Skin, Clean"):
        bpy.ops.spectral_tv.recipe(recipe="Soup")
    assert obj.data.shape_keys is None


def test_one_s_own_recipe_is_kept_made_and_removed():
    obj = bumpy_ball()
    bpy.ops.spectral_tv.decompose(method="M1", bands=4, steps=12, keep_limbs=0.5)
    for band, value in zip(records.bands_of(obj), (-0.5, 0.0, 1.5, 0.25), strict=True):
        band.value = value
    seen = evaluated(obj)
    assert bpy.ops.spectral_tv.recipe_preset(name="My Look") == {"FINISHED"}
    assert own.names()[-1] == "My Look"
    (path,) = (path for path, _ in own.own())
    assert path.parent == Path(bpy.utils.user_resource("SCRIPTS")) / "presets" / own.FOLDER
    other = bumpy_ball()
    make("my look")
    assert listed(other) == ["My Look"] and values(other) == [-0.5, 0, 1.5, 0.25]
    np.testing.assert_allclose(evaluated(other), seen, atol=1e-6)
    make(str(path), 0.5)  # as the menu of presets names it
    assert listed(other) == ["My Look"] and values(other) == [-0.25, 0, 0.75, 0.125]
    assert bpy.ops.spectral_tv.recipe_preset(name="My Look", remove_name=True) == {"FINISHED"}
    assert not path.exists() and own.names() == [*RECIPES]
    with pytest.raises(RuntimeError, match="no recipe 'My Look'"):
        bpy.ops.spectral_tv.recipe(recipe="My Look")


def test_names_of_recipes_are_guarded():
    with pytest.raises(RuntimeError, match="has no bands"):
        bpy.ops.spectral_tv.recipe_preset(name="My Look")
    bumpy_ball()
    make("Caricature")
    with pytest.raises(RuntimeError, match="is a recipe of Spectral TV"):
        bpy.ops.spectral_tv.recipe_preset(name="caricature")
    with pytest.raises(RuntimeError, match="a name of at most"):
        bpy.ops.spectral_tv.recipe_preset(name=" ")
    for name in ("A/B", "A_B", "../A"):  # of which files cannot be called
        bpy.ops.spectral_tv.recipe_preset(name=name)
    assert own.names()[len(RECIPES) :] == ["../A", "A/B", "A_B"]
    assert {path.parent for path, _ in own.own()} == {own.folder()}


def test_a_recipe_goes_to_others_as_a_file(tmp_path, capfd):
    obj = bumpy_ball()
    make("Stylize", 0.5)
    records.bands_of(obj)[0].vertex_group = "Cap"
    path = tmp_path / "Carved.json"
    assert bpy.ops.spectral_tv.recipe_export(filepath=str(path)) == {"FINISHED"}
    assert "this one is without 'Cap'" in capfd.readouterr().out
    assert bpy.ops.spectral_tv.recipe_import(filepath=str(path)) == {"FINISHED"}
    assert own.names()[-1] == "Carved"
    other = bumpy_ball()
    make("Carved")
    assert values(other) == pytest.approx([0.5 * value for value in RECIPES["Stylize"].values])
    assert records.record_of(other).method == "M3"


def held(**more: object) -> dict:
    """What a file of a recipe holds."""
    usual = {"kind": own.KIND, "version": 1, "name": "Theirs", "text": "A look", "values": [1, 0]}
    return {**usual, "settings": {"method": "M1", "bands": 2, "steps": 8}, **more}


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ("import os; os.abort()", "it is no JSON"),
        ("[1, 2]", "is no recipe of Spectral TV"),
        (held(version=9), "a recipe of another version"),
        (held(name=""), "has no name and text"),
        (held(values=[1]), "does not have a value for each of 2 bands"),
        (held(values=[1, float("nan")]), "as the value of a band"),
        (held(values=[1, 99]), "99 as the value of a band"),
        (held(settings={"method": "M9"}), "Method cannot be 'M9'"),
        (held(settings={"bands": 2, "steps": True}), "Steps cannot be True"),
        (held(settings={"bands": 2, "keep_limbs": -3e9}, values=[1, 0]), None),
        (held(settings={"bands": 9, "steps": 8}), "9 bands need more than 8 steps"),
        (held(settings={"bands": 2, "finest": 70.0}), "Finest cannot be 70.0"),
    ],
)
def test_a_file_is_read_as_data_and_refused_if_it_is_no_recipe(tmp_path, written, told):
    path = tmp_path / "theirs.json"
    path.write_text(written if isinstance(written, str) else json.dumps(written))
    if told is None:  # below 0 it stands for what suits the method
        assert own.read(path).settings.keep_limbs == -3e9
        return
    with pytest.raises(RuntimeError, match=told):
        bpy.ops.spectral_tv.recipe_import(filepath=str(path))
    assert own.names() == [*RECIPES]


def test_what_a_later_version_adds_is_told_and_left_out(tmp_path, capfd):
    path = tmp_path / "theirs.json"
    path.write_text(json.dumps(held(settings={"bands": 2, "steps": 8, "sparkle": 3})))
    bpy.ops.spectral_tv.recipe_import(filepath=str(path))
    assert "these settings are not known, and do not count: sparkle" in capfd.readouterr().out
    assert own.find("Theirs").settings.steps == 8


def test_the_menus_of_both_modes_have_the_recipes():
    menu = import_module(f"{MODULE}.recipes.menu")
    for cls in (bpy.types.VIEW3D_MT_object, bpy.types.VIEW3D_MT_sculpt):
        assert menu._draw in cls.draw._draw_funcs
    assert bpy.types.SPECTRAL_TV_MT_recipes.bl_label == "Spectral TV"


def test_the_command_line_makes_recipes(tmp_path, capfd):
    source = write_monkey(tmp_path / "monkey.ply")
    target = tmp_path / "clean.blend"
    command = ["recipe", str(source), "-o", str(target), "--recipe", "clean scan"]
    assert run(command) == 0
    said = capfd.readouterr()
    assert "noise of" in said.out + said.err
    load(target)
    (obj,) = meshes()
    assert band_values(obj)[0] == -1 and listed(obj) == ["Clean Scan"]
    size = np.ptp(evaluated(obj), axis=0)
    smooth = tmp_path / "clean.ply"
    assert run([*command[:3], str(smooth), *command[4:]]) == 0
    load(smooth)
    assert np.ptp(evaluated(meshes()[0]), axis=0) == pytest.approx(size, rel=1e-3)


def test_the_command_line_takes_files_of_recipes_and_refuses_what_is_none(tmp_path, capfd):
    source = write_monkey(tmp_path / "monkey.ply")
    recipe = tmp_path / "theirs.json"
    recipe.write_text(json.dumps(held()))
    target = tmp_path / "theirs.blend"
    command = ["recipe", str(source), "-o", str(target), "--strength", "0.5", "--recipe"]
    assert run([*command, str(recipe)]) == 0
    load(target)
    assert band_values(meshes()[0]) == [0.5, 0]
    assert run([*command, "Soup"]) == 2
    assert "there is no recipe 'Soup'" in capfd.readouterr().err
