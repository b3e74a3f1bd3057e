"""The command line: what its options do, here and in a real executable."""

from __future__ import annotations

import re
from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import (
    QUICK,
    band_values,
    decompose,
    empty,
    load,
    meshes,
    run,
    write_monkey,
)

COMMAND = ["--command", "spectral_tv", "decompose"]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def test_settings_are_the_operators(tmp_path: Path):
    target = tmp_path / "out.blend"
    scales = ["--finest", "1", "--largest", "10"]
    path = write_monkey(tmp_path / "monkey.blend")
    bpy.ops.spectral_tv.decompose(
        method="M2", bands=4, steps=9, use_scales=True, finest=1, largest=10
    )
    kept = meshes()[0].data.spectral_tv.decompositions[-1]
    times = [(band.start, band.end) for band in kept.bands]
    digests = [band.digest for band in kept.bands]
    arguments = ["--method", "M2", "--bands", "4", "--steps", "9", *scales]
    assert run(["decompose", str(path), "-o", str(target), *arguments]) == 0
    load(target)
    record = meshes()[0].data.spectral_tv.decompositions[-1]
    assert record.method == "M2"
    assert [(band.start, band.end) for band in record.bands] == times
    assert [band.digest for band in record.bands] == digests


@pytest.mark.parametrize(
    ("filters", "expected"),
    [
        (["--gain", "2=0"], [0, -1, 0]),
        (["--gain", "all=0", "--gain", "3=2.5"], [-1, -1, 1.5]),
        (["--gain", "1=-2", "--gain", "1=11"], [10, 0, 0]),
        (["--curve", "0:0,1:3"], [-0.5, 0.5, 1.5]),
        (["--curve", "0.5:2"], [1, 1, 1]),
        (["--gain", "1=1", "--curve", "0:0,0.4:0,0.6:4,1:4"], [0, 1, 3]),
    ],
)
def test_gains_and_curve(tmp_path: Path, filters, expected):
    target = tmp_path / "out.blend"
    assert decompose(write_monkey(tmp_path / "monkey.ply"), target, *filters) == 0
    load(target)
    np.testing.assert_allclose(band_values(meshes()[0]), expected, atol=1e-6)


def moves(target: Path, base: str, *choices: str) -> np.ndarray:
    """Displacements of the bands, (3, V, 3), that m3 gives a relief with a key and a group."""
    empty()
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20)
    relief = bpy.context.object
    for vertex in relief.data.vertices:
        vertex.co.z = 0.2 * np.sin(6 * vertex.co.x)
    relief.vertex_groups.new(name="Some").add(range(9), 1.0, "REPLACE")
    relief.shape_key_add(name="Basis")
    tilted = relief.shape_key_add(name="Tilted", from_mix=False)
    for point in tilted.data:
        point.co.z = 0.3 * point.co.y
    path = target.with_name("relief.blend")
    bpy.data.libraries.write(str(path), {bpy.context.scene})
    arguments = ["--method", "m3", "--base", base, *QUICK, *choices]
    assert run(["decompose", str(path), "-o", str(target), *arguments]) == 0
    load(target)
    basis, *keys = (
        np.array([point.co for point in key.data])
        for key in meshes()[0].data.shape_keys.key_blocks
        if key.name != "Tilted"
    )
    return np.array(keys) - basis


def test_bases_of_m3(tmp_path: Path):
    target = tmp_path / "out.blend"
    flat = moves(target, "flat")
    assert np.abs(flat[..., :2]).max() < 1e-6 < np.abs(flat[..., 2]).max()
    tilted = moves(target, "Tilted")
    # Displacements are along the lines from the base, which lies at x and y of the relief too.
    assert np.abs(tilted[..., :2]).max() < 1e-6 < np.abs(tilted - flat).max()
    smoothed, more = (moves(target, "flow", "--base-amount", size) for size in ("2", "20%"))
    assert np.abs(smoothed - flat).max() > 1e-6 < np.abs(smoothed - more).max()


def test_vertex_group_limits_the_bands(tmp_path: Path):
    target = tmp_path / "out.blend"
    moves(target, "flat", "--vertex-group", "Some")
    assert [key.vertex_group for key in meshes()[0].data.shape_keys.key_blocks[2:]] == ["Some"] * 3


def test_progress_in_lines(tmp_path: Path, capfd):
    path = write_monkey(tmp_path / "monkey.ply")
    assert decompose(path, tmp_path / "out.ply") == 0
    lines = capfd.readouterr().err.splitlines()
    percents = [int(line.split()[-2]) for line in lines if line.endswith(" %")]
    assert percents == sorted(percents)
    assert percents[-1] == 100


def test_named_objects_alone(tmp_path: Path):
    for name, x in (("Left", -3), ("Right", 3)):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, location=(x, 0, 0))
        bpy.context.object.name = name
    twin = bpy.data.objects.new("Twin", bpy.data.objects["Right"].data)
    bpy.context.collection.objects.link(twin)
    path = tmp_path / "two.blend"
    bpy.data.libraries.write(str(path), {bpy.context.scene})

    def result(target: Path, *arguments: str) -> list[bpy.types.Object]:
        assert decompose(path, target, *arguments) == 0
        load(target)
        return sorted(meshes(), key=lambda obj: obj.name)

    left, right, twin = result(tmp_path / "all.blend")
    assert len(left.data.shape_keys.key_blocks) == len(right.data.shape_keys.key_blocks) == 4
    assert twin.data == right.data
    left, right, _ = result(tmp_path / "one.blend", "--object", "Left")
    assert left.data.shape_keys is not None
    assert right.data.shape_keys is None
    (alone,) = result(tmp_path / "one.obj", "--object", "Left")
    assert alone.name == "Left"
    assert run(["decompose", str(path), "-o", str(tmp_path / "no.obj"), "--object", "Up"]) == 1
    assert not (tmp_path / "no.obj").exists()


def test_files_saved_in_edit_mode(monkey, tmp_path: Path):
    bpy.ops.object.mode_set(mode="EDIT")
    path = tmp_path / "edit.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    assert decompose(path, path) == 0  # named as output itself
    load(path)
    assert len(band_values(meshes()[0])) == 3


@pytest.mark.once
def test_render(tmp_path: Path):
    pictures = tmp_path / "pictures {#} ##"  # which mean more to Blender's renderer
    pictures.mkdir()
    inputs = [str(write_monkey(tmp_path / name)) for name in ("a.ply", "b.obj")]
    assert run(["decompose", *inputs, "--render", str(pictures), *QUICK]) == 0
    assert sorted(path.name for path in pictures.iterdir()) == ["a.png", "b.png"]
    image = bpy.data.images.load(str(pictures / "a.png"))
    alpha = np.array(image.pixels).reshape(image.size[1], image.size[0], 4)[:, :, 3]
    rows, columns = (np.flatnonzero(alpha.max(axis=axis) > 0.5) for axis in (1, 0))
    extent = max(np.ptp(rows), np.ptp(columns)) / len(alpha)
    assert 0.8 < extent < 0.99
    for seen in (rows, columns):
        assert abs((seen[0] + seen[-1]) / 2 / len(alpha) - 0.5) < 0.1


def test_in_the_executable(blender, tmp_path: Path):
    path = write_monkey(tmp_path / "monkey.obj")
    target, picture = tmp_path / "out.blend", tmp_path / "out.png"
    options = [*QUICK, "--gain", "1=0", "--render", str(picture)]
    done = blender(*COMMAND, str(path), "-o", str(target), *options)
    assert f"{path}: wrote {target}" in done.stderr
    assert re.search(r": 100 %$", done.stderr, re.MULTILINE)
    assert picture.read_bytes().startswith(b"\x89PNG")
    with bpy.data.libraries.load(str(target)) as (content, wanted):
        wanted.objects = content.objects
    (obj,) = (obj for obj in wanted.objects if obj.type == "MESH")
    assert band_values(obj) == [-1, 0, 0]


def test_exit_codes_of_the_executable(blender, tmp_path: Path):
    missing = tmp_path / "missing.ply"
    folder = tmp_path / "out"
    folder.mkdir()
    inputs = str(missing), str(write_monkey(tmp_path / "monkey.ply"))
    done = blender(*COMMAND, *inputs, "-o", str(folder), *QUICK, check=False)
    assert done.returncode == 1
    assert f"{missing}: error: there is no such file" in done.stderr
    assert (folder / "monkey.ply").exists()
    done = blender(*COMMAND, "--bands", "none", check=False)
    assert done.returncode == 2
    assert "--curve" in blender(*COMMAND, "--help").stdout
