"""The command line without Blender, on files that trimesh and meshio wrote."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest
import spectral_tv
import trimesh
from PIL import Image
from shapes import bumpy_sphere
from spectral_tv.cli.formats import FORMATS, Holds
from spectral_tv.cli.reading import read
from spectral_tv.cli.verbs import run

VERTICES, TRIANGLES = bumpy_sphere(3)
STEPS = ["--steps", "8", "--bands", "3"]


def write_input(path: Path) -> Path:
    if FORMATS[path.suffix].writes == "meshio":
        mesh = meshio.Mesh(VERTICES, [("triangle", TRIANGLES.astype(np.int32))])
        mesh.point_data["side"] = (VERTICES[:, 0] > 0).astype(float)
        if path.suffix not in (".ply", ".vtk", ".vtu", ".msh"):
            mesh.point_data.clear()
        mesh.write(path)
    else:
        trimesh.Trimesh(VERTICES, TRIANGLES, process=False).export(path)
    return path


def decomposed(**options):
    mesh = spectral_tv.Mesh(VERTICES, TRIANGLES)
    split = spectral_tv.decompose(
        mesh,
        times=spectral_tv.graded_times(
            *(mesh.area * scale for scale in spectral_tv.default_scales("m1")), 8
        ),
        soft_edges=0.3,
        **options,
    )
    return split.bands(split.band_edges(3), 1.0)


def test_it_tells_its_version(capfd):
    assert run(["--version"]) == 0
    assert capfd.readouterr().out == f"Spectral TV {spectral_tv.__version__}\n"


@pytest.mark.parametrize("suffix", [key for key, each in FORMATS.items() if each.writes])
def test_every_format_holds_the_filtered_shape(suffix, tmp_path, capfd):
    source = write_input(tmp_path / "in.ply")
    target = tmp_path / f"out{suffix}"
    assert run(["decompose", str(source), "-o", str(target), "--gain", "1=0", *STEPS]) == 0
    expected = VERTICES - decomposed()[0]
    if suffix == ".npz":
        found = np.load(target)["filtered"]
    elif suffix == ".glb":
        return  # its shape is the input's; see below
    else:
        mesh = read(target)
        found = mesh.vertices
        if suffix == ".stl":  # three corners to each triangle
            expected = expected[TRIANGLES.ravel()]
            np.testing.assert_array_equal(mesh.triangles.ravel(), np.arange(TRIANGLES.size))
    np.testing.assert_allclose(found, expected, atol=1e-5)
    told = capfd.readouterr().err
    assert ("does not hold them: the bands" in told) == (FORMATS[suffix].bands is Holds.NOT)


@pytest.mark.parametrize("suffix", [key for key, each in FORMATS.items() if each.reads])
def test_every_format_is_read(suffix, tmp_path):
    path = tmp_path / f"in{suffix}"
    if FORMATS[suffix].writes:
        write_input(path)
    else:  # .gltf comes with more files
        files = trimesh.Trimesh(VERTICES, TRIANGLES, process=False).export(file_type="gltf")
        for name, content in files.items():
            (tmp_path / name.replace("model", "in")).write_bytes(content)
    found = read(path)
    corners = found.vertices[found.triangles]
    np.testing.assert_allclose(corners, VERTICES[TRIANGLES], atol=1e-5)


def test_bands_are_vectors_at_points(tmp_path):
    source = write_input(tmp_path / "in.ply")
    for suffix in (".vtu", ".ply", ".npz"):
        target = tmp_path / f"out{suffix}"
        assert run(["decompose", str(source), "-o", str(target), *STEPS]) == 0
    expected = decomposed()
    points = meshio.read(tmp_path / "out.vtu").point_data
    found = np.array([points[f"band_{number}"] for number in (1, 2, 3)])
    np.testing.assert_allclose(found, expected, atol=1e-9)
    np.testing.assert_array_equal(points["side"], VERTICES[:, 0] > 0)  # what was there stays
    numbers = meshio.read(tmp_path / "out.ply").point_data
    np.testing.assert_allclose(numbers["band_2_z"], expected[1, :, 2], atol=1e-9)
    arrays = np.load(tmp_path / "out.npz")
    np.testing.assert_allclose(arrays["bands"], expected, atol=1e-9)
    np.testing.assert_array_equal(arrays["values"], [0, 0, 0])
    assert len(arrays["edges"]) == 4


def test_morph_targets_are_the_bands(tmp_path):
    source = write_input(tmp_path / "in.ply")
    target = tmp_path / "out.glb"
    assert run(["decompose", str(source), "-o", str(target), "--gain", "2=2", *STEPS]) == 0
    found = read(target)
    np.testing.assert_allclose(found.vertices, VERTICES, atol=1e-6)  # the shape as it was
    content = target.read_bytes()
    length = int.from_bytes(content[12:16], "little")
    tree = json.loads(content[20 : 20 + length])
    binary = content[20 + length + 8 :]
    (mesh,) = tree["meshes"]
    assert mesh["weights"] == [0, 1, 0]
    assert mesh["extras"]["targetNames"] == ["band_1", "band_2", "band_3"]
    for band, place in zip(decomposed(), mesh["primitives"][0]["targets"], strict=True):
        accessor = tree["accessors"][place["POSITION"]]
        start = tree["bufferViews"][accessor["bufferView"]]["byteOffset"]
        values = np.frombuffer(binary, "<f4", band.size, start).reshape(-1, 3)
        np.testing.assert_allclose(values, band, atol=1e-6)


def test_numbers_of_the_file_limit_the_bands(tmp_path, capfd):
    source, target = write_input(tmp_path / "in.ply"), tmp_path / "out.npz"
    options = ["--gain", "all=0", "--vertex-group", "side", *STEPS]
    assert run(["decompose", str(source), "-o", str(target), *options]) == 0
    moved = np.linalg.norm(np.load(target)["filtered"] - VERTICES, axis=1) > 1e-9
    np.testing.assert_array_equal(moved, VERTICES[:, 0] > 0)
    capfd.readouterr()
    assert run(["decompose", str(source), "-o", str(target), "--vertex-group", "top"]) == 1
    assert "no numbers 'top' at its vertices; there are: side" in capfd.readouterr().err


def test_one_bad_file_ends_itself_alone_and_the_report_says_why(tmp_path, capfd):
    good = write_input(tmp_path / "good.obj")
    torn = tmp_path / "torn.stl"
    torn.write_bytes(b"solid nothing")
    empty = tmp_path / "empty.obj"
    empty.write_text("v 0 0 0\n")
    sources = [torn, empty, tmp_path / "missing.off", good]
    (tmp_path / "out").mkdir()
    report = tmp_path / "report.jsonl"
    places = ["-o", str(tmp_path / "out"), "--format", "off", "--report", str(report)]
    assert run(["decompose", *map(str, sources), *places, *STEPS]) == 1
    lines = [json.loads(line) for line in report.read_text().splitlines()]
    assert [line["status"] for line in lines] == ["failed", "failed", "failed", "done"]
    assert "cannot be read" in lines[0]["error"] or "no mesh" in lines[0]["error"]
    assert "no mesh with faces" in lines[1]["error"]
    assert lines[2]["error"] == "there is no such file"
    assert lines[3]["read"]["vertices"] == len(VERTICES)
    assert lines[3]["done"]["settings"]["soft_edges"] == 0.3
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["good.off"]
    assert "1 of 4 inputs succeeded" in capfd.readouterr().err


def test_an_stl_is_joined_and_its_corners_move_alike(tmp_path):
    source, target = write_input(tmp_path / "in.stl"), tmp_path / "out.stl"
    assert run(["decompose", str(source), "-o", str(target), "--gain", "all=0", *STEPS]) == 0
    before, after = read(source), read(target)
    _, first, same = np.unique(
        before.vertices.round(6), axis=0, return_index=True, return_inverse=True
    )
    np.testing.assert_allclose(after.vertices, after.vertices[first][same.ravel()], atol=1e-6)


def test_several_meshes_of_a_file_are_one_surface(tmp_path, capfd):
    halves = [TRIANGLES[: len(TRIANGLES) // 2], TRIANGLES[len(TRIANGLES) // 2 :]]
    scene = trimesh.Scene([trimesh.Trimesh(VERTICES, half, process=False) for half in halves])
    source = tmp_path / "in.glb"
    scene.export(source)
    target = tmp_path / "out.ply"
    assert run(["decompose", str(source), "-o", str(target), "--gain", "all=0", *STEPS]) == 0
    told = capfd.readouterr().err
    assert "its 2 meshes are one surface" in told
    assert "joined" in told
    found = read(target)
    mesh = spectral_tv.Mesh(found.vertices, found.triangles, weld=1e-5)
    assert mesh.findings.open_edges == 0


def colored() -> trimesh.Trimesh:
    made = trimesh.Trimesh(VERTICES, TRIANGLES, process=False)
    made.visual.vertex_colors = np.random.default_rng(0).integers(
        0, 256, (len(VERTICES), 4), np.uint8
    )
    return made


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".glb"])
def test_colors_come_along(suffix, tmp_path):
    source, target = tmp_path / "in.ply", tmp_path / f"out{suffix}"
    colored().export(source)
    assert run(["decompose", str(source), "-o", str(target), "--gain", "1=0", *STEPS]) == 0
    found = read(target).surface.visual.vertex_colors
    np.testing.assert_allclose(found[:, :3], colored().visual.vertex_colors[:, :3], atol=1)


def test_what_a_format_does_not_hold_is_told(tmp_path, capfd):
    source = tmp_path / "in.ply"
    colored().export(source)
    assert run(["decompose", str(source), "-o", str(tmp_path / "out.stl"), *STEPS]) == 0
    assert "left out, as a .stl does not hold them: the bands, vertex colors" in (
        capfd.readouterr().err
    )


def test_textures_of_two_files_do_not_overwrite_one_another(tmp_path):
    (tmp_path / "out").mkdir()
    for name, color in (("one", (200, 30, 30)), ("two", (30, 30, 200))):
        (tmp_path / name).mkdir()
        made = trimesh.Trimesh(VERTICES, TRIANGLES, process=False)
        image = Image.new("RGB", (8, 8), color)
        made.visual = trimesh.visual.TextureVisuals(uv=VERTICES[:, :2], image=image)
        made.export(tmp_path / name / f"{name}.obj")
        source = tmp_path / name / f"{name}.obj"
        assert run(["decompose", str(source), "-o", str(tmp_path / "out"), *STEPS]) == 0
    for name, color in (("one", (200, 30, 30)), ("two", (30, 30, 200))):
        found = read(tmp_path / "out" / f"{name}.obj").surface.visual
        assert found.material.image.getpixel((0, 0))[:3] == color
        np.testing.assert_allclose(found.uv, VERTICES[:, :2], atol=1e-6)


def test_it_runs_as_a_program(tmp_path):
    source, target = write_input(tmp_path / "in.ply"), tmp_path / "out.npz"
    command = [sys.executable, "-m", "spectral_tv.cli", "decompose", str(source), "-o", str(target)]
    done = subprocess.run([*command, *STEPS], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""
    assert "wrote" in done.stderr
    assert target.exists()


def test_wrong_arguments_end_with_2(tmp_path, capfd):
    source = write_input(tmp_path / "in.ply")
    assert run(["decompose", str(source), "-o", str(tmp_path / "out.foo")]) == 2
    assert "no way to write .foo" in capfd.readouterr().err
    assert run(["decompose", str(source), "-o", str(tmp_path / "o.stl"), "--gain", "9=1"]) == 2
    assert "there is no band 9 among 5" in capfd.readouterr().err
