"""Folds on the command line: told, and clamped by ``--safe``."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import decompose, empty, load, meshes
from folding_sheet import WILD, counted, key, moved, points, sheet_with_bumps, text

GAINS = [
    "--gain",
    "2=4",
    "--gain",
    "3=4",
    "--finest",
    "2",
    "--largest",
    "30",
    "--keep-limbs",
    "0",
    "--soft-edges",
    "0",
]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    sheet_with_bumps()
    path = tmp_path / "sheet.blend"
    bpy.data.libraries.write(str(path), {bpy.context.scene})
    yield path
    empty()


def test_the_command_line_tells_of_folds(file, tmp_path: Path, capfd):
    target = tmp_path / "out.blend"
    assert decompose(file, target, *GAINS) == 0
    said = capfd.readouterr().err
    load(target)
    (obj,) = meshes()
    mix = sum(key(obj, name).value * moved(obj, name) for name in WILD)
    assert f"at these gains {text(*counted(obj, mix))}; --safe clamps what they add" in said
    assert decompose(file, target, *GAINS, "--gain", "2=1.1", "--gain", "3=1.1") == 0
    assert "fold" not in capfd.readouterr().err


def test_safe_files_have_no_folds(file, tmp_path: Path, capfd):
    target = tmp_path / "out.blend"
    assert decompose(file, target, *GAINS, "--safe") == 0
    assert "no face folds in 'Safe'" in capfd.readouterr().err
    load(target)
    (obj,) = meshes()
    assert key(obj, "Safe").value == 1 and key(obj, "Shape Detail Band 3").value == 0
    assert counted(obj, moved(obj, "Safe")) == (0, 0)
    shape = points(key(obj, "Safe"))
    assert decompose(file, tmp_path / "out.ply", *GAINS, "--safe") == 0
    load(tmp_path / "out.ply")
    (obj,) = meshes()
    world = np.array([obj.matrix_world @ vertex.co for vertex in obj.data.vertices])
    np.testing.assert_allclose(world, shape, atol=1e-5)
    # Where nothing folds, the bands can still be dialled.
    assert decompose(file, target, *GAINS, "--gain", "2=1.1", "--gain", "3=1.1", "--safe") == 0
    load(target)
    assert "Safe" not in meshes()[0].data.shape_keys.key_blocks
    assert key(meshes()[0], "Shape Detail Band 3").value == pytest.approx(0.1)


def test_over_frames_folds_are_told_once(tmp_path: Path, capfd):
    obj = sheet_with_bumps()
    obj.shape_key_add(name="Basis")
    lifted = obj.shape_key_add(name="Lifted", from_mix=False)
    for point in lifted.data:
        point.co.z *= 2
    for frame, value in ((1, 0.0), (3, 1.0)):
        lifted.value = value
        lifted.keyframe_insert("value", frame=frame)
    bpy.context.scene.frame_end = 3
    path = tmp_path / "moving.blend"
    bpy.data.libraries.write(str(path), {bpy.context.scene})
    for options, told in (
        ([], "at most in a frame, and some in 3 of 3"),
        (["--safe"], "at most in a frame, before they are clamped, and some in 3 of 3"),
    ):
        target = tmp_path / "out.blend"
        assert decompose(path, target, *GAINS, *options, "--frames", "1-3") == 0
        assert capfd.readouterr().err.count(told) == 1
        load(target)
        (obj,) = meshes()
        shapes = [points(each) for each in obj.data.shape_keys.key_blocks[1:]]
        assert len(shapes) == 3
    empty()
