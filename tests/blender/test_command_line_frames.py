"""Frames on the command line: other vertices in each, folders of numbered files, fixed scales."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import object_of
from command_line_files import empty, exportable, load, meshes, run
from conftest import MODULE
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from moving_shapes import frames, remeshed_frames
from shapes import Mesh
from test_bake_filter import FRAMES, away, bending_body

play_meshes = import_module(f"{MODULE}.scene.playing").play_meshes
SMALL = ["--bands", "4", "--steps", "8"]
GAINS = ["--gain", "1=0", "--gain", "2=0", "--gain", "3=1.5"]
VALUES = (-1, -1, 0.5, 0)
REMESHED = [suffix for suffix in (".abc", ".usdc", ".blend") if suffix in exportable()]
MOVING = [suffix for suffix in (".abc", ".usdc") if suffix in exportable()]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def shapes_of(keeps_vertices: bool) -> list[Mesh]:
    if keeps_vertices:
        return frames(len(FRAMES), 0.02, subdivisions=3)
    if find_spec("scipy") is None:
        pytest.skip("this Blender is built without SciPy")
    return remeshed_frames(len(FRAMES), 0.02, vertices=700)


def play(shapes: list[Mesh]) -> bpy.types.Object:
    empty()
    obj = object_of("Body", *shapes[0])
    made = []
    for vertices, faces in shapes:
        made.append(bpy.data.meshes.new("Frame"))
        made[-1].from_pydata(vertices.tolist(), [], faces.tolist())
    play_meshes(obj, made, FRAMES)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = FRAMES[0], FRAMES[-1]
    return obj


def write_moving(path: Path, shapes: list[Mesh]) -> Path:
    play(shapes)
    if path.suffix == ".abc":
        bpy.ops.wm.alembic_export(filepath=str(path), evaluation_mode="VIEWPORT")
    else:
        bpy.ops.wm.usd_export(filepath=str(path), export_animation=True)
    return path


def write_folder(folder: Path, shapes: list[Mesh], suffix: str = "ply") -> Path:
    folder.mkdir()
    for frame, shape in zip(FRAMES, shapes, strict=True):
        empty()
        object_of("Body", *shape)
        path = str(folder / f"body.{frame:02d}.{suffix}")
        {"ply": bpy.ops.wm.ply_export, "obj": bpy.ops.wm.obj_export}[suffix](filepath=path)
    return folder


def seen(frame: int) -> Mesh:
    """Vertices in the world and triangles of the only mesh on a frame."""
    bpy.context.scene.frame_set(frame)
    (obj,) = meshes()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    mesh.calc_loop_triangles()
    vertices = np.array([obj.matrix_world @ vertex.co for vertex in mesh.vertices])
    return vertices, np.array([triangle.vertices[:] for triangle in mesh.loop_triangles])


def expected(shapes: list[Mesh], area: float | None = None) -> list[Mesh]:
    made = [spectral_tv.Mesh(*shape) for shape in shapes]
    area = made[0].area if area is None else area
    scales = (area * scale for scale in spectral_tv.default_scales("m1"))
    times = spectral_tv.graded_times(*scales, 8)
    options = {"area": area, "keeps_limbs": True, "soft_edges": 0.3}
    splits = spectral_tv.decompose_sequence(made, "m1", times, **options)
    found = []
    for (vertices, faces), split in zip(shapes, splits, strict=True):
        bands = split.bands(split.band_edges(4), 1.0)
        found.append((vertices + np.tensordot(VALUES, bands, 1), faces))
    return found


def same(found: Mesh, wanted: Mesh) -> None:
    """The same surface; importers may put vertices in another order."""
    assert found[0].shape == wanted[0].shape
    for one, other in ((found, wanted), (wanted, found)):
        tree = BVHTree.FromPolygons(one[0].tolist(), one[1].tolist())
        assert max(tree.find_nearest(Vector(point))[3] for point in other[0]) < 1e-4


@pytest.mark.parametrize("keeps_vertices", [True, False])
@pytest.mark.parametrize("suffix", MOVING)
def test_what_a_file_plays_is_filtered_into_a_file_that_plays(
    tmp_path: Path, capfd, suffix, keeps_vertices
):
    shapes = shapes_of(keeps_vertices)
    source = write_moving(tmp_path / f"in{suffix}", shapes)
    wanted = expected(shapes)
    for other in REMESHED:
        target = tmp_path / f"out{other}"
        options = [*SMALL, *GAINS, "--frames", "all"]
        assert run(["decompose", str(source), "-o", str(target), *options]) == 0
        assert ("vertices come and go" in capfd.readouterr().err) != keeps_vertices
        load(target)
        outputs = [seen(frame) for frame in FRAMES]
        for found, shape in zip(outputs, wanted, strict=True):
            same(found, shape)
        for (one, two), (before, after) in zip(pairwise(shapes), pairwise(outputs), strict=True):
            assert away(before, after) < 2 * away(one, two)


@pytest.mark.parametrize("suffix", MOVING)
def test_what_an_armature_moves_is_filtered_into_a_file_that_plays(tmp_path: Path, suffix):
    empty()
    obj = bending_body()
    obj.shape_key_clear()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = FRAMES[0], FRAMES[-1]
    source, target = tmp_path / "in.blend", tmp_path / f"out{suffix}"
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    shapes = [seen(frame) for frame in FRAMES]
    assert np.abs(shapes[-1][0] - shapes[0][0]).max() > 0.3
    options = [*SMALL, *GAINS, "--frames", "all"]
    assert run(["decompose", str(source), "-o", str(target), *options]) == 0
    load(target)
    for frame, wanted in zip(FRAMES, expected(shapes), strict=True):
        same(seen(frame), wanted)


@pytest.mark.parametrize("keeps_vertices", [True, False])
@pytest.mark.parametrize("suffix", ["ply", "obj"])
def test_a_folder_of_numbered_files_is_filtered_frame_by_frame(
    tmp_path: Path, suffix, keeps_vertices
):
    shapes = shapes_of(keeps_vertices)
    folder, results = write_folder(tmp_path / "frames", shapes, suffix), tmp_path / "results"
    results.mkdir()
    (folder / "notes.txt").touch()
    options = [*SMALL, *GAINS, "--frames", "all"]
    wanted = expected(shapes)
    assert run(["decompose", str(folder), "-o", str(results), *options]) == 0
    names = [path.name for path in sorted(results.iterdir()) if path.suffix != ".mtl"]
    assert names == [f"body_{frame:04d}.{suffix}" for frame in FRAMES]
    for name, shape in zip(names, wanted, strict=True):
        load(results / name)
        same(seen(0), shape)
    for other in MOVING:
        target = tmp_path / f"out{other}"
        assert run(["decompose", str(folder), "-o", str(target), *options]) == 0
        load(target)
        for frame, shape in zip(FRAMES, wanted, strict=True):
            same(seen(frame), shape)


def test_a_format_of_keyframes_gets_files_where_vertices_come_and_go(tmp_path: Path, capfd):
    folder = write_folder(tmp_path / "frames", shapes_of(keeps_vertices=False))
    options = [*SMALL, "--frames", "4-6:2"]
    assert run(["decompose", str(folder), "-o", str(tmp_path / "out.glb"), *options]) == 0
    names = sorted(path.name for path in tmp_path.glob("*.glb"))
    assert names == ["out_0004.glb", "out_0006.glb"]
    assert "frames: wrote" in capfd.readouterr().err


def test_sizes_may_be_relative_to_all_frames(tmp_path: Path):
    vertices, faces = frames(1, 0.02, subdivisions=3)[0]
    shapes = [(scale * vertices, faces) for scale in (0.5, 1, 1, 1, 2)]
    source, target = write_folder(tmp_path / "frames", shapes), tmp_path / "out.blend"
    area = spectral_tv.Mesh(*shapes[1]).area
    for options, wanted in (
        (["--scales", "first"], expected(shapes)),
        (["--scales", "all"], expected(shapes, area)),
    ):
        every = [*SMALL, *GAINS, "--frames", "all", *options]
        assert run(["decompose", str(source), "-o", str(target), *every]) == 0
        load(target)
        for frame, shape in zip(FRAMES, wanted, strict=True):
            same(seen(frame), shape)


def test_a_recipe_is_made_of_frames_by_the_sizes_of_the_first(tmp_path: Path):
    vertices, faces = frames(1, 0.02, subdivisions=3)[0]
    shapes = [(scale * vertices, faces) for scale in (1, 1, 1, 1, 2)]
    source = write_folder(tmp_path / "frames", shapes)
    target, single = tmp_path / "out.blend", tmp_path / "single.blend"
    choice = ["--recipe", "Exaggerate Skin", "--strength", "1"]
    assert run(["recipe", str(source), "-o", str(target), "--frames", "all", *choice]) == 0
    load(target)
    outputs = [seen(frame)[0] for frame in FRAMES]
    for later in outputs[1:-1]:
        np.testing.assert_allclose(later, outputs[0], atol=1e-5)
    assert run(["recipe", str(source / "body.07.ply"), "-o", str(single), *choice]) == 0
    load(single)
    assert np.abs(seen(1)[0] - outputs[-1]).max() > 1e-3


def test_folders_that_are_no_sequence_are_refused(tmp_path: Path, capfd):
    folder, target = tmp_path / "frames", tmp_path / "out.blend"
    shapes = shapes_of(keeps_vertices=True)
    folder.mkdir()
    for make, frames_asked, message in (
        ((folder / "a1.ply").touch, "2-3", "there is no file of frame 2 in it"),
        ((folder / "a1.ply").touch, "all", "a1.ply: the file is empty"),
        ((folder / "a01.ply").touch, "all", "have the same number"),
        (lambda: (folder / "a01.ply").rename(folder / "b2.ply"), "all", "several sequences in it"),
    ):
        make()
        choice = ["--frames", frames_asked, *SMALL]
        assert run(["decompose", str(folder), "-o", str(target), *choice]) == 1
        assert message in capfd.readouterr().err
    good = write_folder(tmp_path / "good", shapes)
    assert run(["decompose", str(good), "-o", str(good), "--frames", "all", *SMALL]) == 2
    assert "the results would be among the frames" in capfd.readouterr().err
    one = str(good / "body.03.ply")
    assert run(["decompose", one, "-o", str(target), "--scales", "all", *SMALL]) == 2
    assert "--scales goes with --frames" in capfd.readouterr().err
    assert not target.exists()
