"""Exit code 0 means that the output is there and whole; whatever fails, what was before stays."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import empty, exportable, load, meshes, run, write_scene
from disks import disk, protect
from spectral_tv.files import checks
from spectral_tv.refusal import Refusal

QUICK = ["--bands", "1", "--steps", "2"]
FORMATS = [suffix for suffix in exportable() if suffix not in (".usd", ".usda")]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def ball(path: Path, subdivisions: int = 5) -> Path:
    """A ball that takes more than 100 kB in every format."""
    empty()
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions)
    return write_scene(path)


def picture(path: Path) -> Path:
    """A picture of noise, which takes more than 100 kB in every format."""
    image = bpy.data.images.new("Noise", 300, 300)
    noise = np.random.default_rng(0).random(4 * 300 * 300)
    image.pixels.foreach_set(noise.astype(np.float32))
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    return path


def content(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("suffix", FORMATS)
def test_an_output_that_does_not_fit_is_no_success(tmp_path: Path, capfd, suffix):
    source = ball(tmp_path / "ball.ply")
    with disk(tmp_path / "disk", 100) as place:
        (place / f"out{suffix}").write_bytes(b"before")
        before = content(place)
        assert run(["decompose", str(source), "-o", str(place / f"out{suffix}"), *QUICK]) == 1
        assert content(place) == before
    error = capfd.readouterr().err.splitlines()[-1]
    assert f"out{suffix} cannot be written: " in error
    assert os.strerror(errno.ENOSPC) in error or "its disk is full" in error


@pytest.mark.once
def test_a_picture_that_does_not_fit_is_no_success(tmp_path: Path, capfd):
    source, shape = picture(tmp_path / "noise.png"), ball(tmp_path / "ball.ply", 2)
    with disk(tmp_path / "disk", 40) as place:
        for suffix in (".png", ".jpg", ".tif", ".exr", ".webp", ".bmp", ".tga"):
            target = place / f"out{suffix}"
            target.write_bytes(b"before")
            before = content(place)
            assert run(["image", str(source), "-o", str(target), *QUICK]) == 1, suffix
            assert content(place) == before
            assert f"out{suffix} cannot be written: " in capfd.readouterr().err
            target.unlink()
        target = place / "shot.png"
        assert run(["decompose", str(shape), "--render", str(target), *QUICK]) == 1
        assert content(place) == {}
        table = import_module("bl_ext.user_default.spectral_tv.attributes.values").save
        with pytest.raises(Refusal, match=os.strerror(errno.ENOSPC)):
            table(str(place / "table.csv"), "1, 2\n" * 20_000)
        assert content(place) == {}


def test_a_disk_that_can_only_be_read_is_told_before_the_work(tmp_path: Path, capfd):
    source = ball(tmp_path / "ball.ply", 2)
    with disk(tmp_path / "disk", 100) as place:
        protect(place)
        for target in ("out.ply", "out.gltf", "out.blend"):
            assert run(["decompose", str(source), "-o", str(place / target), *QUICK]) == 1
            error = capfd.readouterr().err
            assert f"{target} cannot be written: {os.strerror(errno.EROFS)}" in error
            assert "%" not in error  # no progress


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("protected.ply", "it is read-only"),
        ("n" * 252 + ".ply", os.strerror(errno.ENAMETOOLONG)),
    ],
)
def test_names_that_cannot_be_written_are_told_before_the_work(tmp_path: Path, capfd, name, reason):
    source = ball(tmp_path / "ball.ply", 2)
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "protected.ply").write_text("before")
    (folder / "protected.ply").chmod(0o444)
    assert run(["decompose", str(source), "-o", str(folder / name), *QUICK]) == 1
    error = capfd.readouterr().err
    assert reason in error
    assert "%" not in error
    assert content(folder) == {"protected.ply": b"before"}


ENDS = {"SIGINT": 130, "SIGTERM": 143}


def counted(command: list[str], moment: int = -1, number: int = 0) -> tuple[int, int]:
    """The exit code of a command to which a signal is sent at one of its calls of a function of
    the extension, and how many calls there were.
    """
    calls = 0

    def count(frame, event, _argument):
        nonlocal calls
        if event == "call" and "spectral_tv" in frame.f_code.co_filename:
            calls += 1
            if calls == moment:
                os.kill(os.getpid(), number)

    former = sys.getprofile()
    sys.setprofile(count)
    try:
        return run(command), calls
    finally:
        sys.setprofile(former)


@pytest.mark.once
@pytest.mark.parametrize(
    ("suffix", "name"),
    [(".gltf", "SIGINT"), (".obj", "SIGTERM"), (".blend", "SIGINT"), (".fbx", "SIGTERM")],
)
def test_a_signal_at_any_moment_leaves_all_of_the_output_or_what_was_before(
    tmp_path: Path, suffix, name
):
    source, report = ball(tmp_path / "ball.ply", 3), tmp_path / "report.jsonl"
    folder = tmp_path / "out"
    folder.mkdir()
    target = folder / f"out{suffix}"
    command = ["decompose", str(source), "-o", str(target), "--report", str(report), *QUICK]
    code, calls = counted(command)
    assert code == 0
    before = sorted(content(folder))
    former = signal.signal(getattr(signal, name), signal.SIG_IGN)  # what comes too late
    codes = []
    try:
        for moment in np.linspace(1, calls, 12).astype(int):
            codes.append(counted(command, moment, getattr(signal, name))[0])
            assert sorted(content(folder)) == before
            checks.check(target)
    finally:
        signal.signal(getattr(signal, name), former)
    assert set(codes) <= {0, ENDS[name]}
    assert codes.count(ENDS[name]) > 6
    lines = [json.loads(line) for line in report.read_text().splitlines()]
    assert {(line["status"], line["error"]) for line in lines} == {
        ("done", None),
        ("failed", "interrupted"),
    }
    load(target)
    assert len(meshes()) == 1


def test_what_was_interrupted_and_not_begun_is_told(tmp_path: Path, capfd):
    inputs = [ball(tmp_path / f"{name}.ply", 3) for name in ("first", "second", "third")]
    folder = tmp_path / "out"
    folder.mkdir()
    command = ["decompose", *map(str, inputs), "-o", str(folder), *QUICK]
    code, calls = counted(command)
    assert code == 0
    former = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        capfd.readouterr()
        code, _ = counted(command, calls // 2, signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, former)
    assert code == ENDS["SIGINT"]
    told = capfd.readouterr().err.splitlines()
    assert [line for line in told if line.endswith((": interrupted", ": not begun"))] == [
        f"{inputs[1]}: interrupted",
        f"{inputs[2]}: not begun",
    ]


CHILD = """
import os
import sys
import bpy
bpy.ops.preferences.addon_enable(module="bl_ext.user_default.spectral_tv")
code = sys.modules["bl_ext.user_default.spectral_tv"].command_line.run(sys.argv[1:])
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.spectral_tv")
# At the interpreter's end bpy 4.2 crashes, and 4.5 sometimes waits for ever.
(os._exit if bpy.app.version < (5, 0) else sys.exit)(code)
"""


def closed_error() -> dict:
    return {"stdout": subprocess.DEVNULL, "preexec_fn": lambda: os.close(2)}


def broken_pipe() -> dict:
    read, write = os.pipe()
    os.close(read)
    return {"stdout": write, "stderr": write}


@pytest.mark.once
@pytest.mark.parametrize("streams", [closed_error, broken_pipe])
def test_lost_messages_are_no_failure(tmp_path: Path, streams):
    source = ball(tmp_path / "ball.ply", 3)
    broken = tmp_path / "broken.ply"
    broken.write_text("rubbish")
    folder = tmp_path / "out"
    folder.mkdir()
    for inputs, code in (((source,), 0), ((broken, source), 1)):
        names = [str(path) for path in inputs]
        for suffix in ("ply", "glb", "blend"):
            options = ["-o", str(folder), "--format", suffix, *QUICK]
            done = subprocess.run(
                [sys.executable, "-c", CHILD, "decompose", *names, *options],
                check=False,
                **streams(),
            )
            assert done.returncode == code
            checks.check(folder / f"ball.{suffix}")
            (folder / f"ball.{suffix}").unlink()


@pytest.mark.parametrize("streams", [closed_error, broken_pipe])
def test_lost_messages_are_no_failure_of_the_executable(blender, tmp_path: Path, streams):
    source, target = ball(tmp_path / "ball.ply", 3), tmp_path / "out.glb"
    command = ["--command", "spectral_tv", "decompose"]
    done = blender(*command, str(source), "-o", str(target), *QUICK, check=False, **streams())
    assert done.returncode == 0
    checks.check(target)
    missing = str(tmp_path / "missing.ply")
    done = blender(*command, missing, "-o", str(target), *QUICK, check=False, **streams())
    assert done.returncode == 1
