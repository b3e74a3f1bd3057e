"""Maps on the command line."""

from __future__ import annotations

import json

import bpy
import numpy as np
import pytest
from command_line_files import empty, run, write_scene
from map_scene import Spots, distances, low_poly, scan, surface, values_of


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


@pytest.fixture
def scene(tmp_path):
    """A .blend with a scan that has bands, and a low-poly mesh."""
    empty()
    scan(4)
    low_poly()
    return write_scene(tmp_path / "scene.blend")


def test_a_look_goes_onto_another_object(scene, tmp_path, capfd):
    report = tmp_path / "report.jsonl"
    arguments = ["map", str(scene), "-o", str(tmp_path / "map.exr"), "--onto", "Low"]
    arguments += ["--kind", "tangent", "--size", "128", "--report", str(report)]
    assert run(arguments) == 0
    objects = bpy.data.objects
    found = Spots(objects["Low"].data).displaced(values_of(tmp_path / "map.exr"), "TANGENT")
    assert distances(surface(objects["Scan"]), found).mean() < 1e-3
    told = json.loads(report.read_text())
    assert told["status"] == "done" and told["output"] == str(tmp_path / "map.exr")
    settings = told["done"]["settings"] if "done" in told else told["settings"]
    assert (settings["kind"], settings["onto"], settings["of"]) == ("tangent", "Low", "look")
    assert "rays look for the surface" in capfd.readouterr().err


def test_a_surface_without_bands_goes_onto_another_object(tmp_path):
    empty()
    scan(4)
    bpy.context.object.shape_key_clear()
    low_poly()
    source = write_scene(tmp_path / "scene.glb")
    out = tmp_path / "normals.png"
    arguments = ["map", str(source), "-o", str(out), "--onto", "Low", "--kind", "normal"]
    assert run([*arguments, "--size", "64"]) == 0
    values = values_of(out)
    assert values.shape == (64, 64, 3) and np.median(values[..., 2]) > 0.9
    assert np.abs(np.diff(values[..., 0])).mean() > 0.001


def test_a_folder_gets_an_exr(scene, tmp_path):
    folder = tmp_path / "maps"
    folder.mkdir()
    assert run(["map", str(scene), "-o", str(folder), "--onto", "Low", "--size", "16"]) == 0
    assert [each.name for each in folder.iterdir()] == ["scene.exr"]


def test_what_cannot_be_baked_is_said(scene, tmp_path, capfd):
    out = str(tmp_path / "map.exr")
    for arguments, text in (
        (["-o", out], "no UV map; unwrap it first"),
        (["-o", out, "--onto", "Nobody"], "there is no object 'Nobody' in it"),
        (["-o", out, "--object", "Low"], "has no bands"),
    ):
        assert run(["map", str(scene), *arguments, "--size", "16"]) == 1
        assert text in capfd.readouterr().err
    for arguments, text in (
        (["-o", str(tmp_path / "map.png")], "which no .png holds"),
        (["-o", str(tmp_path / "map.jpg"), "--kind", "normal"], "a map is an .exr"),
        (["-o", str(tmp_path / "nowhere" / "map.exr")], "there is no folder"),
        ([], "-o"),
    ):
        assert run(["map", str(scene), *arguments]) == 2
        assert text in capfd.readouterr().err
    assert sorted(each.name for each in tmp_path.iterdir()) == ["scene.blend"]
