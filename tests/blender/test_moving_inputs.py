"""Inputs that move: each frame is filtered, or the user is told that one was."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import QUICK, empty, exportable, load, meshes, run, write_monkey
from test_shown import distance, seen

FRAMES = (3, 6, 12)


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def rough(name: str = "Grid") -> bpy.types.Object:
    """A rough grid that a key lifts from frame 3 to frame 12."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=9, y_subdivisions=9)
    obj = bpy.context.object
    obj.name = obj.data.name = name
    rng = np.random.default_rng(0)
    for vertex in obj.data.vertices:
        vertex.co.z = 0.1 * rng.normal()
    obj.shape_key_add(name="Basis", from_mix=False)
    key = obj.shape_key_add(name="Up", from_mix=False)
    for point in key.data:
        point.co.z += 1 + np.sin(3 * point.co.x)
    for frame, value in ((3, 0.0), (12, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 3, 12
    scene.frame_set(3)
    return obj


def write_moving(path: Path) -> Path:
    """The grid in a format whose vertices move."""
    empty()
    rough()
    if path.suffix == ".abc":
        bpy.ops.wm.alembic_export(filepath=str(path))
    else:
        bpy.ops.wm.usd_export(filepath=str(path), export_animation=True, export_shapekeys=False)
    return path


def heights(frame: int) -> np.ndarray:
    """The heights of the vertices of the only mesh in a frame, by their places."""
    bpy.context.scene.frame_set(frame)
    (obj,) = meshes()
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.array([obj.matrix_world @ vertex.co for vertex in shape.data.vertices])
    _, first = np.unique(points[:, :2].round(2), axis=0, return_index=True)
    return points[first][:, 2]


MOVING = [suffix for suffix in (".abc", ".usdc") if suffix in exportable()]
PLAYING = [
    suffix for suffix in (".abc", ".usdc", ".glb", ".fbx", ".blend") if suffix in exportable()
]


@pytest.mark.parametrize("suffix", MOVING)
def test_that_one_frame_was_taken_is_told(tmp_path: Path, capfd, suffix):
    source, target = write_moving(tmp_path / f"in{suffix}"), tmp_path / f"out{suffix}"
    assert run(["decompose", str(source), "-o", str(target), *QUICK]) == 0
    told = capfd.readouterr().err
    assert "move over the frames 3 to 12: frame 3 alone was taken; --frames all takes each" in told
    load(target)
    np.testing.assert_allclose(heights(3), heights(12), atol=1e-6)


@pytest.mark.parametrize("suffix", MOVING)
def test_every_frame_is_filtered_and_played(tmp_path: Path, capfd, suffix):
    """As each frame is by itself, with sizes relative to that of the first."""
    source = write_moving(tmp_path / f"in{suffix}")
    options = ["--gain", "all=0", "--keep-limbs", "0", *QUICK]
    sizes = {"--finest": 3.0, "--largest": 30.0}
    single, areas = {}, {}
    for frame in FRAMES:
        load(source)
        bpy.context.scene.frame_set(frame)
        before = seen()
        for modifier in list(meshes()[0].modifiers):
            bpy.context.view_layer.objects.active = meshes()[0]
            bpy.ops.object.modifier_apply(modifier=modifier.name)
        path = tmp_path / f"frame{frame}.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
        mesh = meshes()[0].data
        mesh.calc_loop_triangles()
        areas[frame] = sum(triangle.area for triangle in mesh.loop_triangles)
        grown = (areas[FRAMES[0]] / areas[frame]) ** 0.5
        own = [text for name, size in sizes.items() for text in (name, f"{grown * size:.9f}")]
        assert run(["decompose", str(path), "-o", str(path), *options, *own]) == 0
        load(path)
        single[frame] = seen()
        assert distance(before, single[frame]) > 0.01
    assert areas[FRAMES[-1]] > 1.2 * areas[FRAMES[0]]
    options += [text for name, size in sizes.items() for text in (name, f"{size}")]
    for other in PLAYING:
        target = tmp_path / f"out{other}"
        capfd.readouterr()
        assert run(["decompose", str(source), "-o", str(target), "--frames", "all", *options]) == 0
        told = capfd.readouterr().err
        assert "alone was taken" not in told
        assert ", frame 12: 100 %" in told
        load(target)
        for frame in FRAMES:
            bpy.context.scene.frame_set(frame)
            assert distance(single[frame], seen()) < 1e-5, (other, frame)


def test_a_format_that_cannot_play_gets_a_file_for_each_frame(tmp_path: Path):
    source, report = tmp_path / "in.blend", tmp_path / "report.jsonl"
    empty()
    rough()
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    before = {frame: heights(frame) for frame in (3, 6, 9, 12)}
    options = ["--frames", "3-12:3", "--gain", "all=1", "--report", str(report), *QUICK]
    for suffix in ("ply", "obj", "stl"):
        target = tmp_path / f"out.{suffix}"
        assert run(["decompose", str(source), "-o", str(target), *options]) == 0
        names = sorted(path.name for path in tmp_path.glob(f"out*.{suffix}"))
        assert names == [f"out_{frame:04d}.{suffix}" for frame in before]
        assert all(name in report.read_text().splitlines()[-1] for name in names)
        for frame, name in zip(before, names, strict=True):
            load(tmp_path / name)
            np.testing.assert_allclose(heights(frame), before[frame], atol=1e-5)


def test_frames_of_what_modifiers_and_armatures_move(tmp_path: Path, capfd):
    """The pose of every frame is filtered; the modifiers are off in the end."""
    source, target = tmp_path / "in.blend", tmp_path / "out.blend"
    empty()
    obj = rough()
    bpy.ops.object.armature_add()
    rig = bpy.context.object
    obj.vertex_groups.new(name="Bone").add(range(100), 1.0, "REPLACE")
    obj.modifiers.new("Rig", "ARMATURE").object = rig
    bone = rig.pose.bones["Bone"]
    for frame in (3, 12):
        bone.location.y = frame
        bone.keyframe_insert("location", frame=frame)
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    before = {frame: heights(frame) for frame in FRAMES}
    options = ["--frames", "all", "--gain", "all=1", *QUICK]
    assert run(["decompose", str(source), "-o", str(target), *options]) == 0
    assert "so they are off now: Grid" in capfd.readouterr().err
    load(target)
    for frame in (3, 4, 12):
        if frame in before:
            np.testing.assert_allclose(heights(frame), before[frame], atol=1e-5)
    assert np.ptp([before[frame].mean() for frame in FRAMES]) > 8


def test_modifiers_that_move_vertices_are_told(tmp_path: Path, capfd):
    source, target = tmp_path / "in.blend", tmp_path / "out.glb"
    empty()
    rough().modifiers.new("Wave", "WAVE")
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    assert run(["decompose", str(source), "-o", str(target), *QUICK]) == 0
    told = capfd.readouterr().err
    assert "vertices of Grid move over the frames 3 to 12, by modifiers; --frames all" in told
    assert "holds no vertices that move by themselves: Grid is as in the current frame" in told


@pytest.mark.parametrize("suffix", MOVING)
def test_what_moves_by_keys_or_armatures_moves_in_formats_that_hold_it(tmp_path: Path, suffix):
    source, target = tmp_path / "in.blend", tmp_path / f"out{suffix}"
    empty()
    rough()
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    before = {frame: heights(frame) for frame in FRAMES}
    assert run(["decompose", str(source), "-o", str(target), "--gain", "all=1", *QUICK]) == 0
    load(target)
    for frame in FRAMES:
        np.testing.assert_allclose(heights(frame), before[frame], atol=1e-5)


def test_what_does_not_move_has_no_frames(tmp_path: Path, capfd):
    still = write_monkey(tmp_path / "still.ply")
    target = tmp_path / "out.blend"
    assert run(["decompose", str(still), "-o", str(target), "--frames", "all", *QUICK]) == 1
    assert "nothing in it moves, so there are no frames" in capfd.readouterr().err
    assert not target.exists()


@pytest.mark.parametrize("suffix", MOVING)
def test_deformed_frames_are_played(tmp_path: Path, capfd, suffix):
    source, target = write_monkey(tmp_path / "monkey.ply"), tmp_path / f"out{suffix}"
    moves = ["--pin", "z<10%", "--move", "z>90%:0,0,1", "--frames", "1-9:4", "--unturned"]
    assert run(["deform", str(source), "-o", str(target), *moves]) == 0
    assert "holds no animation" not in capfd.readouterr().err
    load(target)
    heights = []
    for frame in (1, 5, 9):
        bpy.context.scene.frame_set(frame)
        heights.append(seen()[:, 2].max())
    np.testing.assert_allclose(np.diff(heights), 0.5, atol=1e-3)
