"""The report: a line of JSON for every input."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import QUICK, empty, run, write_monkey
from disks import disk
from spectral_tv.files import names


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def lines(report: Path) -> list[dict]:
    return [json.loads(line) for line in report.read_text().splitlines()]


def test_a_line_says_what_was_read_done_lost_and_written(tmp_path: Path):
    source, report = write_monkey(tmp_path / "monkey.obj"), tmp_path / "report.jsonl"
    target, picture = tmp_path / "out.stl", tmp_path / "out.png"
    options = ["--gain", "1=0", "--render", str(picture), "--report", str(report), *QUICK]
    assert run(["decompose", str(source), "-o", str(target), *options]) == 0
    (line,) = lines(report)
    assert line["input"] == str(source)
    assert line["output"] == str(target)
    assert line["picture"] == str(picture)
    assert (line["status"], line["error"]) == ("done", None)
    assert line["seconds"] > 0
    assert line["read"]["format"] == ".obj"
    (obj,) = line["read"]["objects"]
    assert obj["name"] == "Suzanne"
    assert line["read"]["vertices"] == obj["vertices"] > 1000
    assert line["read"]["units"] == {"up_axis": "Y"}
    assert line["read"]["digits"] == {"text": True, "double": False, "offset": None}
    assert line["done"]["verb"] == "decompose"
    assert line["done"]["objects"] == [["Suzanne"]]
    settings = line["done"]["settings"]
    assert settings["method"] == "m1"
    assert settings["bands"] == 3
    assert settings["gains"] == [[1, 0.0]]
    assert "output" not in settings
    assert any(warning.startswith("left out, as a .stl") for warning in line["warnings"])


def test_settings_that_count_are_in_the_report_alone(tmp_path: Path):
    source, report = write_monkey(tmp_path / "monkey.ply"), tmp_path / "report.jsonl"
    every = {
        "method",
        "bands",
        "shape",
        "weld",
        "leave_out",
        "apart",
        "gains",
        "safe",
        "limit",
        "apply",
        "bands_as",
        "heights",
    }
    for options, own in (
        ([], {"steps", "soft_edges", "keep_limbs"}),
        (["--finest", "2"], {"steps", "finest", "soft_edges", "keep_limbs"}),
        (["--method", "m3"], {"steps", "base", "displacement", "metric", "keep_limbs"}),
        (["--method", "displacement"], {"base"}),
        (["--method", "lb", "--eigenpairs", "9"], {"steps", "eigenpairs", "keep_limbs"}),
    ):
        arguments = ["--gain", "1=0", "--report", str(report), *QUICK, *options]
        assert run(["decompose", str(source), "-o", str(tmp_path / "out.stl"), *arguments]) == 0
        found = lines(report)[-1]["done"]["settings"]
        wanted = every | own
        if "displacement" in options:
            wanted.discard("bands")
        assert set(found) == wanted
        assert None not in found.values()
    assert lines(report)[2]["done"]["settings"]["base"] == "limbs"


def test_lines_are_added_for_every_input_and_verb(tmp_path: Path):
    report = tmp_path / "report.jsonl"
    report.write_text('{"input": "cut sho')  # by a program that was ended
    good, broken = write_monkey(tmp_path / "good.ply"), tmp_path / "broken.ply"
    broken.write_text("rubbish")
    folder = tmp_path / "out"
    folder.mkdir()
    command = ["decompose", str(broken), str(good), "-o", str(folder), *QUICK]
    assert run([*command, "--report", str(report)]) == 1
    moves = ["--move", "z>90%:0,0,0.1", "--report", str(report)]
    assert run(["deform", str(good), "-o", str(tmp_path / "out.ply"), *moves]) == 0
    picture = tmp_path / "in.png"
    image = bpy.data.images.new("Noise", 8, 8)
    image.pixels.foreach_set(np.random.default_rng(0).random(256).astype(np.float32))
    image.filepath_raw, image.file_format = str(picture), "PNG"
    image.save()
    shot = tmp_path / "out.png"
    assert run(["image", str(picture), "-o", str(shot), *QUICK, "--report", str(report)]) == 0
    torn, *rest = report.read_text().splitlines()
    assert torn == '{"input": "cut sho'
    found = [json.loads(line) for line in rest]
    assert [line["status"] for line in found] == ["failed", "done", "done", "done"]
    assert "it has no header of a PLY file" in found[0]["error"]
    assert [line["output"] for line in found] == [
        None,
        str(folder / "good.ply"),
        str(tmp_path / "out.ply"),
        str(shot),
    ]


def test_a_report_that_cannot_be_written_is_no_success(tmp_path: Path, capfd):
    source, target = write_monkey(tmp_path / "monkey.ply"), tmp_path / "out.ply"
    command = ["decompose", str(source), "-o", str(target), *QUICK, "--report"]
    assert run([*command, str(tmp_path / "nowhere" / "report.jsonl")]) == 2
    assert "--report" in capfd.readouterr().err
    for other in (source, target):
        assert run([*command, str(other)]) == 2
        assert "is an input or an output too" in capfd.readouterr().err
    assert not target.exists()
    with disk(tmp_path / "disk", 4) as place:
        report = place / "report.jsonl"
        report.write_text('{"status": "done"}\n' * 200)
        before = report.read_bytes()
        assert run([*command, str(report)]) == 1
        error = f"report.jsonl cannot be written: {os.strerror(errno.ENOSPC)}"
        assert error in capfd.readouterr().err
        assert report.read_bytes() == before
    assert target.exists()


def test_outputs_whose_names_are_one_file_are_told(tmp_path: Path, capfd):
    """Where case and the coding of accents do not count; here they do, or one input is lost."""
    paths = [tmp_path / name for name in ("a.ply", "A.PLY", "\u00e4.obj", "a\u0308.obj", "b.ply")]
    first, same, accent, coded, other = names.file_keys(paths, lambda _folder: True)
    assert first == same != other
    assert accent == coded != first
    assert len(set(names.file_keys(paths, lambda _folder: False))) == len(paths)
    folder = tmp_path / "out"
    folder.mkdir()
    sources = [write_monkey(tmp_path / name / "x.ply") for name in ("one",)]
    upper = tmp_path / "one" / "X.ply"
    upper.write_bytes(sources[0].read_bytes())
    command = ["decompose", str(sources[0]), str(upper), "-o", str(folder), *QUICK]
    if names.takes_alike(folder):
        assert run(command) == 2
        assert "two inputs would become" in capfd.readouterr().err
    else:
        assert run(command) == 0
        assert sorted(path.name for path in folder.iterdir()) == ["X.ply", "x.ply"]


@pytest.mark.parametrize("option", ["-o", "--render", "--report"])
def test_what_ends_like_a_folder_has_to_be_one(tmp_path: Path, capfd, option):
    source = write_monkey(tmp_path / "monkey.ply")
    command = ["decompose", str(source), "-o", str(tmp_path / "out.ply")]
    assert run([*command, option, f"{tmp_path / 'results'}/"]) == 2
    assert "there is no folder" in capfd.readouterr().err
