"""Bands are known whatever becomes of their keys and names; no other key is taken for one."""

from __future__ import annotations

from pathlib import Path

import banded_monkey
import bpy
import pytest
from banded_monkey import activate, values

banded = banded_monkey.banded


def test_bands_survive_renaming_and_reordering(banded):
    keys = banded.data.shape_keys.key_blocks
    keys["Shape Detail Band 2"].name = "Wrinkles"
    keys["Shape Detail Band 3"].name = "Shape Detail Band 9"
    bpy.ops.spectral_tv.filter(preset="BAND_PASS", first=2, last=2)
    named = {key.name: key.value for key in keys}
    assert named["Wrinkles"] == 0
    assert (
        named["Shape Detail Band 1"]
        == named["Shape Detail Band 9"]
        == named["Shape Detail Band 4"]
        == -1
    )


def test_bands_survive_duplication_and_files(banded, tmp_path: Path):
    banded.data.shape_keys.key_blocks["Shape Detail Band 1"].name = "Fine"
    twin = banded.copy()
    twin.data = banded.data.copy()
    bpy.context.collection.objects.link(twin)
    activate(twin)
    bpy.ops.spectral_tv.filter(preset="LOW_PASS", first=2, last=2)
    assert twin.data.shape_keys.key_blocks["Fine"].value == -1
    assert banded.data.shape_keys.key_blocks["Fine"].value == 0

    path = tmp_path / "bands.blend"
    bpy.data.libraries.write(str(path), {twin})
    name = twin.name
    bpy.data.batch_remove([twin, banded])
    with bpy.data.libraries.load(str(path)) as (_, target):
        target.objects = [name]
    loaded = target.objects[0]
    bpy.context.collection.objects.link(loaded)
    activate(loaded)
    bpy.ops.spectral_tv.filter(preset="RESET")
    assert loaded.data.shape_keys.key_blocks["Fine"].value == 0
    assert len(loaded.data.spectral_tv.decompositions[-1].kept_spectrum) == 11


def test_another_key_by_the_name_of_a_deleted_band_is_no_band(banded):
    banded.shape_key_remove(banded.data.shape_keys.key_blocks["Shape Detail Band 3"])
    smile = banded.shape_key_add(name="Shape Detail Band 3", from_mix=False)
    for point in list(smile.data)[:9]:
        point.co.z += 0.1
    assert smile.name == "Shape Detail Band 3"
    smile.value = 0.5
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=4)
    assert values(banded) == [-1, -1, -1, 0.5]
    bpy.ops.spectral_tv.cut(bands=2)
    assert "Shape Detail Band 3" in banded.data.shape_keys.key_blocks


def test_another_key_by_the_name_of_a_renamed_band_is_no_band(banded):
    keys = banded.data.shape_keys.key_blocks
    keys["Shape Detail Band 3"].name = "Folds"
    banded.shape_key_add(name="Shape Detail Band 3", from_mix=False).value = 0.5
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=4)
    assert keys["Shape Detail Band 3"].value == 0.5 and keys["Folds"].value == -1


def test_a_sculpted_band_is_a_band(banded):
    for point in list(banded.data.shape_keys.key_blocks["Shape Detail Band 1"].data)[:50]:
        point.co.z += 0.5
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=1)
    assert values(banded) == [-1, 0, 0, 0]


def test_bands_outlive_sculpting_of_basis_and_new_names(banded):
    bpy.ops.object.mode_set(mode="EDIT")
    banded.active_shape_key_index = 0
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.translate(value=(0.1, 0.23, 0.37))
    bpy.ops.object.mode_set(mode="OBJECT")
    banded.data.shape_keys.key_blocks["Shape Detail Band 2"].name = "Wrinkles"
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=4)
    assert values(banded) == [-1, -1, -1]
    assert banded.data.shape_keys.key_blocks["Wrinkles"].value == -1


def test_bands_go_with_all_shape_keys(banded):
    """Others that are added later are none of them."""
    banded.shape_key_clear()
    assert not bpy.ops.spectral_tv.filter.poll()
    banded.shape_key_add(name="Basis")
    banded.shape_key_add(name="Shape Detail Band 1")
    assert not bpy.ops.spectral_tv.filter.poll()
    bpy.ops.spectral_tv.decompose(bands=2, steps=8)
    assert bpy.ops.spectral_tv.filter.poll()


def test_a_deleted_band_is_left_out(banded):
    banded.shape_key_remove(banded.data.shape_keys.key_blocks["Shape Detail Band 3"])
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=4)
    assert values(banded) == [-1, -1, -1]


def test_a_changed_mesh_is_refused(banded):
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    for operator in (bpy.ops.spectral_tv.filter, bpy.ops.spectral_tv.cut):
        with pytest.raises(RuntimeError, match="decompose the mesh again"):
            operator()
    bpy.ops.spectral_tv.decompose(bands=2, steps=6)
    bpy.ops.spectral_tv.filter(preset="RESET")


def test_no_bands_is_a_message(monkey):
    with pytest.raises(RuntimeError, match="no bands; decompose it first"):
        bpy.ops.spectral_tv.filter()
