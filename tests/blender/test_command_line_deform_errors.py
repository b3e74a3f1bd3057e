"""The command line's deform: failures, wrong arguments, several inputs, help."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest
from command_line_files import empty, run, write_monkey

pytestmark = pytest.mark.once

MOVE = ["--move", "z>90%:0,0,1"]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ([], "no object in it has constraints; give some with --pin and --move"),
        (["--object", "monkey"], "monkey: it has no constraints"),
        (["--object", "Body"], "there is no object 'Body' in it"),
        (["--pin", "z<0%", *MOVE], "monkey: the region 'z<0%' holds no vertex"),
        (["--pin", "Feet", *MOVE], "monkey: there is no vertex group 'Feet'"),
        (["--pin", "z<101%", *MOVE], "monkey: there is no vertex group 'z<101%'"),
        (["--pin", "z<95%", *MOVE], "both 'z<95%' and 'z>90%', which go to different places"),
        ([*MOVE, "--move", "z>90%:0,0,2"], "which go to different places"),
        (["--move", "z>0%:0,0,1", "--pin", "z<1%", "--pin", "z>1%"], "to different places"),
        (
            ["--pin", "z<100%", "--pin", "z>0%", "--move", "x>90%:0,0,0"],
            "nothing is left to deform",
        ),
        ([*MOVE, "--move", "z<5%:0,0,1e300"], "is not finite"),
    ],
)
def test_what_cannot_be_done_is_told_in_one_line(tmp_path: Path, capfd, choices, message):
    path, target = write_monkey(tmp_path / "monkey.ply"), tmp_path / "out.blend"
    assert run(["deform", str(path), "-o", str(target), *choices]) == 1
    lines = capfd.readouterr().err.splitlines()
    (error,) = (line for line in lines if not line.endswith(" %"))
    assert error.startswith(f"{path}: error: ") and message in error
    assert not target.exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "name an INPUT"),
        (["IN", *MOVE], "-o, --render or both"),
        (["IN", "-o", "x.ply", "--pin", "z<10%"], "--pin alone moves nothing"),
        (["IN", "-o", "x.ply", "--move", "z>90%"], "is not WHERE:DX,DY,DZ"),
        (["IN", "-o", "x.ply", "--move", "z>90%:1,2"], "is not WHERE:DX,DY,DZ"),
        (["IN", "-o", "x.ply", "--move", "z>90%:1,2,up"], "is not WHERE:DX,DY,DZ"),
        (["IN", "-o", "x.ply", "--move", "z>90%:1,2,inf"], "is not WHERE:DX,DY,DZ"),
        (["IN", "-o", "x.ply", "--move", ":1,2,3"], "is not WHERE:DX,DY,DZ"),
        (["IN", "-o", "x.ply", "--algorithm", "magic"], "invalid choice"),
        (["IN", "-o", "x.ply", "--softness", "101"], "not a number from 0 to 100"),
        (["IN", "-o", "x.ply", "--softness", "5", "--algorithm", "arap"], "--softness goes with"),
        (
            ["IN", "-o", "x.ply", "--stillness", "5", "--algorithm", "convex"],
            "--joint-softness and --stiffness and --stillness go with --algorithm pose",
        ),
        (["IN", "-o", "x.ply", "--softness", "5", "--stiffness", "1"], "--stillness go with"),
        (["IN", "-o", "x.ply", "--joint-softness", "101"], "not a number from 0 to 100"),
        (["IN", "-o", "x.ply", "--unturned"], "--unturned goes with --move"),
        (
            ["IN", "-o", "x.ply", "--frames", "1-5", "--algorithm", "arap"],
            "--frames goes with --algorithm pose or convex",
        ),
        (["IN", "-o", "x.ply", "--frames", "5"], "is not START-END"),
        (["IN", "-o", "x.ply", "--frames", "1-5:0"], "is not START-END"),
        (["IN", "-o", "x.ply", "--frames", "5-1"], "frame 1 comes before frame 5"),
        (["IN", "-o", "x.doc", *MOVE], "writes no .doc"),
    ],
)
def test_wrong_arguments(tmp_path: Path, capfd, arguments, message):
    path = write_monkey(tmp_path / "monkey.ply")
    assert run(["deform", *(str(path) if each == "IN" else each for each in arguments)]) == 2
    assert message in capfd.readouterr().err


def test_several_inputs_go_on_after_a_failure(tmp_path: Path, capfd):
    good, other = (write_monkey(tmp_path / name) for name in ("good.ply", "other.stl"))
    missing = tmp_path / "missing.obj"
    folder = tmp_path / "out"
    folder.mkdir()
    inputs = [str(path) for path in (good, missing, other)]
    options = ["-o", str(folder), "--format", "stl", "--pin", "z<10%", *MOVE]
    assert run(["deform", *inputs, *options]) == 1
    assert sorted(path.name for path in folder.iterdir()) == ["good.stl", "other.stl"]
    lines = capfd.readouterr().err.splitlines()
    assert f"{missing}: error: there is no such file" in lines
    assert f"{good}: wrote {folder / 'good.stl'}" in lines
    assert lines[-1] == "2 of 3 inputs succeeded"
    percents = [
        line for line in lines if line.startswith(f"{good}: good: ") and line.endswith(" %")
    ]
    assert percents[-1].endswith(": 100 %")
    assert any("posed, settled to within" in line for line in lines)


def test_help(capfd):
    assert run(["deform", "--help"]) == 0
    text = capfd.readouterr().out
    for part in (
        "--pin",
        "--move",
        "--unturned",
        "--frames",
        "--softness",
        "--stillness",
        "'z<10%'",
        "examples:",
        "exit codes",
    ):
        assert part in text


def test_in_the_executable(blender, tmp_path: Path):
    path, target = write_monkey(tmp_path / "monkey.obj"), tmp_path / "out.blend"
    command = ["--command", "spectral_tv", "deform", str(path), "-o", str(target)]
    done = blender(*command, "--pin", "z<10%", *MOVE)
    assert f"{path}: wrote {target}" in done.stderr
    with bpy.data.libraries.load(str(target)) as (content, wanted):
        wanted.objects = content.objects
    assert sorted(obj.type for obj in wanted.objects) == ["EMPTY", "MESH"]
