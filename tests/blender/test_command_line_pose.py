"""The command line's deform by Pose, which it takes where nothing else is chosen."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import empty, run
from test_command_line_deform import (
    add_dumbbell,
    add_handle,
    deform,
    key_positions,
    moved,
    shown,
    write_dumbbell,
)

BEND = ["--pin", "z<10%", "--move", "z>90%:1,0,-0.5"]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def tilt(obj) -> float:
    """By how much the upper ball leans, in degrees."""
    basis, shape = key_positions(obj, "Basis"), key_positions(obj, "Deformation")
    upper = basis[:, 2] > 0.6
    one, other = (points[upper] - points[upper].mean(axis=0) for points in (basis, shape))
    left, _, right = np.linalg.svd(other.T @ one)
    return float(np.degrees(np.arccos(np.clip((np.trace(left @ right) - 1) / 2, -1, 1))))


def middle(obj) -> np.ndarray:
    """By what the group that is moved was moved in the mean."""
    (name,) = (each.vertex_group for each in obj.spectral_tv.constraints if each.kind == "OBJECT")
    index = obj.vertex_groups[name].index
    found = [v.index for v in obj.data.vertices if any(g.group == index for g in v.groups)]
    return moved(obj)[found].mean(axis=0)


def test_what_is_moved_turns_and_its_middle_goes_where_it_should(tmp_path: Path, capsys):
    obj = deform(write_dumbbell(tmp_path / "dumbbell.ply"), tmp_path / "out.blend", *BEND)
    assert obj.spectral_tv.algorithm == "POSE"
    np.testing.assert_allclose(middle(obj), (1, 0, -0.5), atol=1e-5)
    assert 25 < tilt(obj) < 60
    assert "posed, settled to within" in capsys.readouterr().err


def test_unturned_parts_face_as_they_did(tmp_path: Path):
    source = write_dumbbell(tmp_path / "dumbbell.ply")
    obj = deform(source, tmp_path / "out.blend", *BEND, "--unturned")
    top = key_positions(obj, "Basis")[:, 2]
    is_moved = top > top.min() + 0.9 * np.ptp(top)
    np.testing.assert_allclose(moved(obj)[is_moved] - (1, 0, -0.5), 0, atol=1e-5)


def test_options_of_one_algorithm_ask_for_it(tmp_path: Path):
    source = write_dumbbell(tmp_path / "dumbbell.ply")
    for option, algorithm in (("--softness", "CONVEX"), ("--stiffness", "POSE")):
        obj = deform(source, tmp_path / "out.blend", *BEND, option, "2")
        assert obj.spectral_tv.algorithm == algorithm
        assert getattr(obj.spectral_tv, option[2:]) == 2


@pytest.mark.parametrize("name", ["joint_softness", "stiffness", "stillness"])
def test_settings_are_the_operators_and_kept(tmp_path: Path, name):
    source = write_dumbbell(tmp_path / "dumbbell.ply")
    option = f"--{name.replace('_', '-')}"
    obj = deform(source, tmp_path / "out.blend", *BEND, option, "3")
    assert getattr(obj.spectral_tv, name) == 3
    result = key_positions(obj, "Deformation")
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.deform(**{name: 0.3})
    assert np.abs(key_positions(obj, "Deformation") - result).max() > 1e-3
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(key_positions(obj, "Deformation"), result, atol=1e-6)


def test_an_object_of_total_variation_is_posed_if_that_is_asked_for(tmp_path: Path):
    empty()
    add_handle(add_dumbbell()).location = (1, 0, -0.5)
    source = tmp_path / "held.blend"
    bpy.context.view_layer.update()
    bpy.ops.wm.save_as_mainfile(filepath=str(source), check_existing=False)
    tilts = [
        tilt(deform(source, tmp_path / "out.blend", *options))
        for options in ([], ["--algorithm", "pose"], ["--stillness", "0.5"])
    ]
    assert tilts[0] < 10 and min(tilts[1:]) > 20


def test_over_frames_it_goes_its_way(tmp_path: Path):
    source = write_dumbbell(tmp_path / "dumbbell.ply")
    deform(source, tmp_path / "out.blend", *BEND, "--frames", "1-9:4")
    places = []
    for frame in (1, 5, 9):
        bpy.context.scene.frame_set(frame)
        places.append(shown()[:, 0].max())
    assert places[0] < places[1] < places[2]


def test_what_runs_into_itself_is_told(tmp_path: Path, capsys):
    source = write_dumbbell(tmp_path / "dumbbell.ply")
    down = ["--pin", "z<10%", "--move", "z>90%:0,0,-2.5", "--unturned"]
    assert run(["deform", str(source), "-o", str(tmp_path / "out.ply"), *down]) == 0
    said = capsys.readouterr()
    assert "pass through others, unlike at rest" in said.out + said.err
