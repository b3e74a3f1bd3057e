"""Faces of a file that Blender leaves out or changes are counted, and it is told why."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import bpy
import pytest
import sheet_files
from command_line_files import write_scene
from sheet_files import WRITERS, grid, told, write_obj
from spectral_tv.files import ply_table as tables

pytestmark = pytest.mark.once
leave_an_empty_file = sheet_files.leave_an_empty_file
ORDINARY = re.compile(r"\d+ %|: wrote |the filter changes nothing")


@pytest.mark.parametrize("name", WRITERS)
def test_faces_that_blender_leaves_out_are_counted(tmp_path: Path, capfd, name):
    points, faces = grid()
    good = [face.tolist() for face in faces]
    broken = [good[3][:2] + good[3][:1], good[7][::-1]]  # a vertex twice, a face twice
    if not name.endswith("stl"):
        broken += [[*good[0][:2], 99], [*good[0][:2], -1], good[0][:2]]
    if name == "sheet.obj":
        broken[-2] = [*good[0][:2], -2]  # −1 would be the last vertex; this becomes f … −1
    source = WRITERS[name](tmp_path / name, points, good + broken)
    if name == "sheet.obj":
        text = source.read_text()
        source.write_text(text.replace(" -1\n", " 0\n"))
    error = told(source, tmp_path / f"out{source.suffix}", capfd)
    if source.suffix == ".ply":  # Blender 5.2 takes the first vertex for one that is not there
        corners = tables.read(tmp_path / "out.ply").faces.corners.reshape(-1, 3)
        assert {frozenset(face) for face in corners.tolist()} == {frozenset(face) for face in good}
    total = len(good) + len(broken)
    assert f"{len(broken)} of {total} faces were left out" in error
    assert f"1 has a vertex twice (the first is face {len(good)})" in error
    assert f"1 has the vertices of another face (the first is face {len(good) + 1})" in error
    if not name.endswith("stl"):
        assert f"2 refer to a vertex that is not there (the first is face {len(good) + 2}" in error
        assert f"1 has fewer than 3 corners (the first is face {len(good) + 4})" in error


@pytest.mark.parametrize("name", WRITERS)
def test_of_whole_files_nothing_is_told(tmp_path: Path, capfd, name):
    source = WRITERS[name](tmp_path / name, *grid())
    lines = told(source, tmp_path / f"out{source.suffix}", capfd).splitlines()
    assert [
        line for line in lines if line.startswith(str(source)) and not ORDINARY.search(line)
    ] == []


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_faces_of_gltf_that_blender_leaves_out_are_counted(tmp_path: Path, capfd, suffix):
    points, faces = grid()
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    mesh.shade_smooth()
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Sheet", mesh))
    source, target = write_scene(tmp_path / f"in{suffix}"), tmp_path / f"out{suffix}"
    assert "left out" not in told(source, target, capfd)
    data = source if suffix == ".glb" else source.with_suffix(".bin")
    content = data.read_bytes()
    corners = struct.pack("<3H", *faces[3])
    assert content.count(corners) == 1
    data.write_bytes(content.replace(corners, struct.pack("<3H", *faces[4])))
    assert "1 of 50 faces were left out" in told(source, target, capfd)


def test_an_obj_cut_in_a_face_is_told(tmp_path: Path, capfd):
    source = write_obj(tmp_path / "sheet.obj", *grid())
    source.write_text(source.read_text().rstrip("\n").rsplit(" ", 1)[0])
    error = told(source, tmp_path / "out.obj", capfd)
    assert "its last line has no end: it may have been cut short" in error
    assert "1 of 50 faces were left out" in error
    assert "1 has fewer than 3 corners" in error


def test_a_polygon_of_an_obj_that_blender_changes_is_told(tmp_path: Path, capfd):
    points, faces = grid()
    a, b, c = faces[0].tolist()
    source = write_obj(tmp_path / "sheet.obj", points, [[a, b, b, c], *faces[1:].tolist()])
    error = told(source, tmp_path / "out.obj", capfd)
    assert "faces were changed" in error
    assert "1 has a vertex twice" in error
