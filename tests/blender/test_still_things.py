"""What stands still is not animated in any format, so that bands can be dialled after import."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest
from command_line_files import decompose, empty, exportable, load, meshes

FORMATS = [suffix for suffix in (".fbx", ".glb", ".usdc", ".abc") if suffix in exportable()]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def add_ball(name: str, x: float = 0.0) -> bpy.types.Object:
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, location=(x, 0, 0))
    obj = bpy.context.object
    obj.name = obj.data.name = name
    return obj


def save(path: Path) -> Path:
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def slide(obj: bpy.types.Object, axis: int = 0) -> None:
    for frame, value in ((5, 0.0), (20, 1.0)):
        obj.location[axis] = value
        obj.keyframe_insert("location", frame=frame)


def animated() -> set[str]:
    """The names of what has an action."""
    items = [*bpy.data.objects, *bpy.data.cameras]
    found = {each.name for each in items if each.animation_data and each.animation_data.action}
    for obj in meshes():
        keys = obj.data.shape_keys
        if keys is not None and keys.animation_data and keys.animation_data.action:
            found.add(f"keys of {obj.name}")
    return found


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_still_scene_has_no_animation(tmp_path: Path, suffix):
    empty()
    add_ball("Ball")
    bpy.ops.object.camera_add()
    bpy.ops.object.empty_add()
    source, target = save(tmp_path / "in.blend"), tmp_path / f"out{suffix}"
    assert decompose(source, target, "--gain", "1=0") == 0
    load(target)
    assert animated() == set()
    assert not bpy.data.actions
    assert not any(obj.modifiers or obj.constraints for obj in meshes())


@pytest.mark.parametrize("suffix", [suffix for suffix in FORMATS if suffix in (".fbx", ".glb")])
def test_bands_of_a_still_object_are_free_beside_one_that_moves(tmp_path: Path, suffix):
    empty()
    slide(add_ball("Sliding"))
    add_ball("Still", 5.0)
    source, target = save(tmp_path / "in.blend"), tmp_path / f"out{suffix}"
    assert decompose(source, target, "--gain", "1=0") == 0
    load(target)
    assert animated() == {"Sliding"}
    scene = bpy.context.scene
    keys = bpy.data.objects["Still"].data.shape_keys.key_blocks
    keys[1].value = 0.5
    scene.frame_set(8)
    bpy.context.view_layer.update()
    assert keys[1].value == 0.5


@pytest.mark.parametrize("suffix", [suffix for suffix in FORMATS if suffix in (".fbx", ".glb")])
@pytest.mark.parametrize("axis", range(3))
def test_what_moves_still_does_frame_by_frame(tmp_path: Path, suffix, axis):
    empty()
    slide(add_ball("Sliding"), axis=axis)
    scene = bpy.context.scene
    frames = range(1, 26)
    before = []
    for frame in frames:
        scene.frame_set(frame)
        before.append(bpy.data.objects["Sliding"].matrix_world.translation[axis])
    source, target = save(tmp_path / "in.blend"), tmp_path / f"out{suffix}"
    assert decompose(source, target) == 0
    load(target)
    for frame, place in zip(frames, before, strict=True):
        bpy.context.scene.frame_set(frame)
        found = bpy.data.objects["Sliding"].matrix_world.translation[axis]
        assert found == pytest.approx(place, abs=1e-5)
