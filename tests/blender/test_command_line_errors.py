"""The command line: failures, wrong arguments, exit codes."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest
from command_line_files import (
    QUICK,
    decompose,
    empty,
    run,
    write_monkey,
    write_scene,
)

pytestmark = pytest.mark.once

FLAT = ["--method", "m3", "--base", "flat"]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def test_several_inputs_go_on_after_a_failure(tmp_path: Path, capfd):
    good, other = (write_monkey(tmp_path / name) for name in ("good.ply", "other.stl"))
    broken, missing, strange = (tmp_path / n for n in ("broken.ply", "missing.obj", "notes.txt"))
    points = write_monkey(tmp_path / "points.ply")
    points.write_text(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n0 0 0\n"
    )
    broken.write_text("rubbish")
    strange.write_text("rubbish")
    folder = tmp_path / "out"
    folder.mkdir()
    inputs = [str(path) for path in (broken, good, missing, points, strange, other)]
    assert run(["decompose", *inputs, "-o", str(folder), *QUICK]) == 1
    assert sorted(path.name for path in folder.iterdir()) == ["good.ply", "other.stl"]
    errors = capfd.readouterr().err.splitlines()
    for path, reason in (
        (broken, "it has no header of a PLY file"),
        (missing, "no such file"),
        (points, "no mesh with faces"),
        (strange, "reads no .txt"),
    ):
        assert [line for line in errors if line.startswith(f"{path}: error: ") and reason in line]
    assert f"{good}: wrote {folder / 'good.ply'}" in errors
    assert errors[-1] == "2 of 6 inputs succeeded"


def test_several_inputs_in_one_format(tmp_path: Path):
    folder = tmp_path / "out"
    folder.mkdir()
    inputs = [str(write_monkey(tmp_path / name)) for name in ("a.ply", "b.stl")]
    assert run(["decompose", *inputs, "-o", str(folder), "--format", "blend", *QUICK]) == 0
    assert sorted(path.name for path in folder.iterdir()) == ["a.blend", "b.blend"]


def test_what_cannot_be_decomposed_names_object_and_reason(monkey, tmp_path: Path, capfd):
    monkey.scale.z = 0
    path = tmp_path / "flat.blend"
    bpy.data.libraries.write(str(path), {bpy.context.scene})
    target = tmp_path / "out.blend"
    assert run(["decompose", str(path), "-o", str(target)]) == 1
    assert f"{path}: error: Suzanne: its scale is zero along an axis" in capfd.readouterr().err
    assert not target.exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "required: COMMAND"),
        (["compose"], "invalid choice"),
        (["decompose"], "name an INPUT"),
        (["decompose", "IN"], "-o, --render or both"),
        (["decompose", "IN", "-o", "x.ply", "--method", "m9"], "invalid choice"),
        (["decompose", "IN", "-o", "x.ply", "--bands", "0"], "not a number from 1 to 32"),
        (["decompose", "IN", "-o", "x.ply", "--bands", "9", "--steps", "9"], "need more than 9"),
        (["decompose", "IN", "-o", "x.ply", "--accuracy", "0"], "not a number from 0.005"),
        (
            ["decompose", "IN", "-o", "x.ply", "--accuracy", "0.1", "--method", "lb"],
            "takes no time steps",
        ),
        (["decompose", "IN", "-o", "x.ply", "--gain", "6=1"], "no band 6 among 5"),
        (["decompose", "IN", "-o", "x.ply", "--gain", "0=1"], "is not BAND=GAIN"),
        (["decompose", "IN", "-o", "x.ply", "--gain", "1=nan"], "not a number from -9 to 11"),
        (["decompose", "IN", "-o", "x.ply", "--curve", "0:1,0:2"], "have to increase"),
        (["decompose", "IN", "-o", "x.ply", "--finest", "9", "--largest", "5"], "--largest"),
        (["decompose", "IN", "-o", "x.ply", "--base", "flat"], "go with --method m3"),
        (["decompose", "IN", "-o", "x.ply", "--metric", "base"], "goes with --method m3"),
        (
            ["decompose", "IN", "-o", "x.ply", *FLAT, "--base-amount", "9"],
            "goes with --base limbs or flow",
        ),
        (["decompose", "IN", "-o", "x.doc"], "writes no .doc"),
        (["decompose", "IN", "-o", "nowhere/x.ply"], "no folder nowhere"),
        (["decompose", "IN", "-o", "x.ply", "--format", "stl"], "--format goes with"),
        (["decompose", "IN", "IN", "-o", "x.ply"], "several inputs need a folder"),
        (["decompose", "IN", "--render", "x.jpg"], "has to be a .png"),
        (["decompose", "IN", "-o", "FOLDER"], "is an input; name it"),
        (["decompose", "IN", "IN", "-o", "OTHER"], "two inputs would become"),
    ],
)
def test_wrong_arguments(tmp_path: Path, capfd, arguments, message):
    path = write_monkey(tmp_path / "monkey.ply")
    content = path.read_bytes()
    other = tmp_path / "other"
    other.mkdir()
    names = {"IN": str(path), "FOLDER": str(path.parent), "OTHER": str(other)}
    assert run([names.get(argument, argument) for argument in arguments]) == 2
    assert message in capfd.readouterr().err
    assert path.read_bytes() == content


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        (["--vertex-group", "Feet"], "there is no vertex group 'Feet'"),
        (["--method", "m3", "--base", "Smooth"], "there is no shape key 'Smooth'"),
    ],
)
def test_what_an_object_lacks_is_named(tmp_path: Path, capfd, choices, message):
    path, target = write_monkey(tmp_path / "monkey.blend"), tmp_path / "out.blend"
    assert decompose(path, target, *choices) == 1
    assert f"{path}: error: Suzanne: {message}" in capfd.readouterr().err
    assert not target.exists()


def test_wrong_arguments_are_told_in_a_line(tmp_path: Path, capfd):
    for arguments in (["decompose"], ["decompose", "in.ply", "-o", "x.doc"], ["nothing"]):
        assert run(arguments) == 2
        (line,) = capfd.readouterr().err.splitlines()
        assert ": error: " in line
        assert line.endswith("(--help tells all arguments)")


def test_a_folder_without_inputs_is_told(tmp_path: Path, capfd):
    for verb, name in (("decompose", "out.ply"), ("deform", "out.ply"), ("image", "out.png")):
        options = ["--move", "z>90%:0,0,1"] if verb == "deform" else []
        assert run([verb, str(tmp_path), "-o", str(tmp_path / name), *options]) == 2
        assert (
            f"there is no file in the folder {tmp_path} that can be read" in capfd.readouterr().err
        )


def test_messages_about_one_of_several_objects_name_it(tmp_path: Path, capfd):
    empty()
    for x, name in ((0, "Whole"), (5, "Torn")):
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=9, y_subdivisions=9, location=(x, 0, 0))
        bpy.context.object.name = bpy.context.object.data.name = name
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.edge_split(type="EDGE")
    bpy.ops.object.mode_set(mode="OBJECT")
    source = write_scene(tmp_path / "in.glb")
    assert decompose(source, tmp_path / "out.obj") == 0
    told = capfd.readouterr().err.splitlines()
    joined = [line for line in told if " corners at open edges" in line]
    assert any(line.startswith(f"{source}: Torn: joined ") for line in joined), told
    # Some exporters of glTF tear the other one too.
    assert all(line.startswith((f"{source}: Torn: ", f"{source}: Whole: ")) for line in joined)


@pytest.mark.parametrize("suffix", [".ply", ".blend"])
def test_gains_that_keep_every_band_are_told(tmp_path: Path, capfd, suffix):
    source, target = write_monkey(tmp_path / "in.ply"), tmp_path / f"out{suffix}"
    idle = "the filter changes nothing: it keeps every band"
    for options in (["--gain", "all=1"], ["--curve", "0:1,1:1"]):
        assert decompose(source, target, *options) == 0
        assert idle in capfd.readouterr().err
    assert decompose(source, target) == 0  # bands can be dialled in a .blend
    assert (idle in capfd.readouterr().err) == (suffix == ".ply")
    assert decompose(source, target, "--gain", "1=0") == 0
    assert idle not in capfd.readouterr().err


def test_help(capfd):
    assert run(["--help"]) == 0
    assert run(["decompose", "--help"]) == 0
    text = capfd.readouterr().out
    for option in (
        "--method",
        "--base",
        "--vertex-group",
        "--bands",
        "--gain",
        "--curve",
        "--render",
        "exit codes",
    ):
        assert option in text
