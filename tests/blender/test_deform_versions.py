"""Files of before: what they hold keeps the algorithm that it had."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from deform_scene import armature, constrain, dumbbell_object, empty, handle, key_positions, members

# As files of 0.1.0 keep them.
NUMBERS = {"CONVEX": 0, "PAPER": 1, "HARMONIC": 2, "BIHARMONIC": 3, "ARAP": 4}


def written(path: Path, algorithm: str | None) -> str:
    """A file with an object held by a pin and a handle, of before if it has no algorithm."""
    bpy.ops.wm.read_homefile(use_empty=True)
    obj = dumbbell_object()
    constrain(obj, "Feet", "PIN")
    constrain(obj, "Head", "OBJECT", target=empty((0, 0, 2)))
    handle(obj).location.x += 0.5
    obj.spectral_tv.property_unset("algorithm")
    if algorithm is not None:
        obj.spectral_tv.algorithm = algorithm
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    return str(path)


@pytest.mark.parametrize(
    ("saved", "expected"), [(None, "CONVEX"), ("POSE", "POSE"), ("ARAP", "ARAP")]
)
@pytest.mark.parametrize("way", ["open", "append", "link"])
def test_an_object_with_constraints_keeps_its_algorithm(tmp_path: Path, saved, expected, way):
    path = written(tmp_path / "held.blend", saved)
    if way == "open":
        bpy.ops.wm.open_mainfile(filepath=path)
    else:
        if not hasattr(bpy.app.handlers, "blend_import_post"):
            pytest.skip("this Blender does not tell of what was appended")
        bpy.ops.wm.read_homefile(use_empty=True)
        with bpy.data.libraries.load(path, link=way == "link") as (_, target):
            target.objects = ["Dumbbell"]
    assert bpy.data.objects["Dumbbell"].spectral_tv.algorithm == expected
    bpy.ops.wm.read_homefile(use_empty=True)


def test_a_handle_of_before_moves_its_group_as_it_did(tmp_path: Path):
    path = written(tmp_path / "held.blend", None)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Dumbbell"]
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.deform()
    shift = (key_positions(obj) - key_positions(obj, "Basis"))[members(obj, "Head")]
    np.testing.assert_allclose(shift, np.tile([0.5, 0, 0], (len(shift), 1)), atol=1e-6)
    bpy.ops.wm.read_homefile(use_empty=True)


def test_what_is_constrained_today_stays_with_pose(tmp_path: Path):
    obj = dumbbell_object("POSE")
    obj.spectral_tv.property_unset("algorithm")
    constrain(obj, "Feet", "PIN")
    path = str(tmp_path / "new.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert bpy.data.objects["Dumbbell"].spectral_tv.algorithm == "POSE"
    bpy.ops.wm.read_homefile(use_empty=True)


def test_objects_without_constraints_take_the_first_choice(tmp_path: Path):
    dumbbell_object().spectral_tv.property_unset("algorithm")
    path = str(tmp_path / "free.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert bpy.data.objects["Dumbbell"].spectral_tv.algorithm == "POSE"
    bpy.ops.wm.read_homefile(use_empty=True)


def test_a_bone_of_before_turns_its_group_if_pose_is_chosen(tmp_path: Path):
    obj = dumbbell_object()
    rig, _ = armature()
    constraint = constrain(obj, "Head", "OBJECT", target=rig, bone="Neck")
    constraint.property_unset("turns")
    obj.spectral_tv.property_unset("algorithm")
    path = str(tmp_path / "rigged.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert bpy.data.objects["Dumbbell"].spectral_tv.constraints[0].turns
    bpy.ops.wm.read_homefile(use_empty=True)


def test_files_keep_the_numbers_of_algorithms(held):
    items = type(held.spectral_tv).bl_rna.properties["algorithm"].enum_items
    found = {item.identifier: item.value for item in items if item.identifier}
    assert found == {**NUMBERS, "POSE": 5}
