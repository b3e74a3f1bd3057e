"""Scenes in other units than metres: where objects are in files, and what is told."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import decompose, empty, exportable, load, meshes

METRIC = [suffix for suffix in (".glb", ".gltf", ".fbx", ".dae") if suffix in exportable()]
UNITLESS = [suffix for suffix in (".obj", ".stl", ".ply", ".abc") if suffix in exportable()]
MILLIMETRE = 0.001


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def write_millimetres(path: Path, system: str = "METRIC") -> Path:
    """Two balls, one the child of the other, which slides; 8 and 9 mm from the origin at first."""
    empty()
    for x, name in ((8.0, "Ball"), (1.0, "Child")):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, location=(x, 0, 0), radius=0.25)
        bpy.context.object.name = bpy.context.object.data.name = name
    ball, child = bpy.data.objects["Ball"], bpy.data.objects["Child"]
    child.parent = ball
    for frame, z in ((1, 0.0), (10, 5.0)):
        ball.location.z = z
        ball.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    settings = bpy.context.scene.unit_settings
    settings.system, settings.scale_length = system, MILLIMETRE
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def middles(frame: int) -> dict[str, np.ndarray]:
    """Where meshes are, by their names."""
    bpy.context.scene.frame_set(frame)
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    found = {}
    for obj in meshes():
        points = [obj.matrix_world @ vertex.co for vertex in obj.evaluated_get(graph).data.vertices]
        found[obj.name] = (np.min(points, axis=0) + np.max(points, axis=0)) / 2
    return found


@pytest.mark.parametrize("suffix", METRIC)
def test_formats_in_metres_have_metres(tmp_path: Path, capfd, suffix):
    source, target = write_millimetres(tmp_path / "in.blend"), tmp_path / f"out{suffix}"
    assert decompose(source, target, "--gain", "1=0") == 0
    told = capfd.readouterr().err
    assert suffix == ".dae" or "converted to metres, from units of 0.001 m" in told
    assert [obj.name for obj in bpy.data.objects] == ["Ball", "Child"]
    assert not any(obj.matrix_parent_inverse != obj.matrix_parent_inverse.Identity(4)
                   for obj in bpy.data.objects)  # fmt: skip
    load(target)
    for frame, z in ((1, 0.0), (10, 0.0 if suffix == ".dae" else 0.005)):
        found = middles(frame)
        np.testing.assert_allclose(found["Ball"], (0.008, 0, z), atol=2e-5)
        np.testing.assert_allclose(found["Child"], (0.009, 0, z), atol=2e-5)


@pytest.mark.parametrize("suffix", [".glb", ".fbx"])
def test_a_named_object_alone_is_in_metres_too(tmp_path: Path, suffix):
    source, target = write_millimetres(tmp_path / "in.blend"), tmp_path / f"out{suffix}"
    assert decompose(source, target, "--object", "Child") == 0
    load(target)
    (obj,) = meshes()
    np.testing.assert_allclose(middles(1)[obj.name], (0.009, 0, 0), atol=2e-5)


@pytest.mark.skipif(".usda" not in exportable(), reason="this Blender is built without .usda")
def test_usd_is_in_the_unit_that_it_tells(tmp_path: Path):
    source, target = write_millimetres(tmp_path / "in.blend"), tmp_path / "out.usda"
    assert decompose(source, target) == 0
    read = load(target)
    unit = 1.0 if bpy.app.version >= (4, 5) else read.units["metres_per_unit"]  # converted since
    np.testing.assert_allclose(middles(1)["Child"] * unit, (0.009, 0, 0), atol=2e-5)


@pytest.mark.parametrize("suffix", UNITLESS)
def test_formats_without_a_unit_have_the_numbers_of_the_scene(tmp_path: Path, capfd, suffix):
    source, target = write_millimetres(tmp_path / "in.blend"), tmp_path / f"out{suffix}"
    assert decompose(source, target, "--object", "Ball") == 0
    assert f" {suffix} knows no unit: its numbers are in units of 0.001 m" in capfd.readouterr().err
    load(target)
    np.testing.assert_allclose(middles(1).popitem()[1], (8, 0, 0), atol=2e-2)


def test_a_scene_without_units_is_in_metres(tmp_path: Path, capfd):
    source = write_millimetres(tmp_path / "in.blend", "NONE")
    for suffix in (".glb", ".fbx", ".obj"):
        target = tmp_path / f"out{suffix}"
        assert decompose(source, target, "--object", "Ball") == 0
        assert "metres" not in (told := capfd.readouterr().err)
        assert "unit " not in told
        load(target)
        np.testing.assert_allclose(middles(1).popitem()[1], (8, 0, 0), atol=2e-2)
