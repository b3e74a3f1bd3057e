"""The page about many files: its examples, the job array and the templates for render farms."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from many_files import lines_of, write_good
from shapes import bumpy_sphere

ROOT = Path(__file__).resolve().parents[2]
FARMS = ROOT / "docs" / "farms"
PAGE = (ROOT / "docs" / "many_files.md").read_text(encoding="utf-8")
SHELL = [
    line for block in re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL) for line in block.splitlines()
]
(PYTHON,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
BLENDER = shlex.split(os.environ.get("BLENDER", ""))


@pytest.fixture
def place(tmp_path: Path, monkeypatch) -> Path:
    """A folder with scans in it, and with the program on its path."""
    write_good(tmp_path / "scans", 4)
    (tmp_path / "results").mkdir()
    shutil.copy(FARMS / "slurm.sh", tmp_path)
    programs = tmp_path / "programs"
    programs.mkdir()
    program = programs / "spectral-tv"
    program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m spectral_tv.cli "$@"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")
    return tmp_path


def test_the_commands_of_the_page_do_what_they_say(place: Path):
    assert len(SHELL) == 6
    for line in SHELL:
        done = subprocess.run(
            ["bash", "-c", line], cwd=place, check=False, capture_output=True, text=True
        )
        assert done.returncode == 0, (line, done.stderr)
    statuses = [line["status"] for line in lines_of(place / "report.jsonl")]
    assert statuses == ["done"] * 4 + ["skipped"] * 4 + ["done"] * 8
    by_the_array = lines_of(place / "results" / "report.jsonl")
    assert [line["status"] for line in by_the_array] == ["skipped"] * 4
    assert len(list((place / "results").rglob("*.glb"))) == 4


def test_the_program_of_the_page_does_what_it_says(place: Path):
    (place / "program.py").write_text(PYTHON)
    command = [sys.executable, "program.py"]
    done = subprocess.run(command, cwd=place, check=True, capture_output=True, text=True)
    assert len(re.findall(r"^scans/\S+ done $", done.stdout, re.MULTILINE)) == 4
    assert len(list((place / "results").rglob("*.npz"))) == 4


@pytest.mark.skipif(sys.platform == "win32", reason="SLURM is not for Windows")
def test_the_job_array_does_each_file_once(place: Path):
    for number in (1, 2, 3):
        env = os.environ | {"SLURM_ARRAY_TASK_ID": str(number), "SLURM_ARRAY_TASK_COUNT": "3"}
        command = ["bash", "slurm.sh", "scans", "made", "--format", "ply", "--bands", "3"]
        subprocess.run(command, cwd=place, check=True, capture_output=True, env=env)
    lines = lines_of(place / "made" / "report.jsonl")
    assert [line["status"] for line in lines] == ["done"] * 4
    assert len({line["input"] for line in lines}) == 4


@pytest.mark.parametrize("template", sorted(FARMS.glob("*.yaml")), ids=lambda path: path.stem)
def test_templates_are_whole(template: Path):
    openjd("check", template)


@pytest.mark.skipif(not BLENDER, reason="BLENDER names no program")
def test_templates_run_in_blender(place: Path, monkeypatch):
    (extension,) = (ROOT / "dist").glob("spectral_tv-*.zip")
    (place / "resources").mkdir()
    monkeypatch.setenv("BLENDER_USER_RESOURCES", str(place / "resources"))
    install = ["--command", "extension", "install-file", "-r", "user_default", "-e"]
    subprocess.run([*BLENDER, *install, extension], check=True, capture_output=True)
    program = f"Blender={shlex.join(BLENDER)}"
    options = ["-p", program, "-p", "Options=--bands 3 --steps 8"]
    openjd(
        *("run", FARMS / "decompose_files.yaml", "-p", f"Inputs={place / 'scans'}"),
        *("-p", f"Output={place / 'results'}", "-p", "Shares=2", *options),
    )
    statuses = [line["status"] for line in lines_of(place / "results" / "report.jsonl")]
    assert statuses == ["done"] * 4
    assert len(list((place / "results").rglob("*.glb"))) == 4
    moving = write_moving(place / "moving.glb")
    openjd(
        *("run", FARMS / "decompose_frames.yaml", "-p", f"Input={moving}", "-p", "Start=2"),
        *("-p", "End=3", "-p", f"Output={place / 'shot.ply'}", *options),
    )
    assert sorted(path.name for path in place.glob("shot_*.ply")) == [
        "shot_0002.ply",
        "shot_0003.ply",
    ]


def write_moving(path: Path) -> Path:
    """Write a ball that turns about."""
    import bpy  # noqa: PLC0415 - slow

    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    vertices, triangles = bumpy_sphere(2)
    mesh = bpy.data.meshes.new("Ball")
    mesh.from_pydata(vertices.tolist(), [], triangles.tolist())
    ball = bpy.data.objects.new("Ball", mesh)
    bpy.context.collection.objects.link(ball)
    for frame in (1, 4):
        ball.rotation_euler.z = 0.1 * frame
        ball.keyframe_insert("rotation_euler", frame=frame)
    bpy.context.scene.frame_end = 4
    bpy.ops.export_scene.gltf(filepath=str(path))
    return path


def openjd(*arguments: object) -> None:
    """Run Open Job Description's program."""
    command = [str(Path(sys.executable).with_name("openjd")), *map(str, arguments)]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
