"""bpy.ops.spectral_tv.solo: the other bands are muted, and in the end as they were before."""

from __future__ import annotations

from pathlib import Path

import banded_monkey
import bpy
import pytest
from banded_monkey import activate

banded = banded_monkey.banded


def mutes(obj) -> list[bool]:
    return [key.mute for key in obj.data.shape_keys.key_blocks if "Band" in key.name]


def test_solo_mutes_the_others_and_gives_them_back(banded):
    keys = banded.data.shape_keys.key_blocks[1:]
    bpy.ops.spectral_tv.solo(band=2)
    assert [key.mute for key in keys] == [True, False, True, True]
    bpy.ops.spectral_tv.solo(band=2)
    assert not any(key.mute for key in keys)


def test_solo_gives_back_what_the_user_had_muted(banded):
    banded.data.shape_keys.key_blocks["Shape Detail Band 1"].mute = True
    bpy.ops.spectral_tv.solo(band=2)
    assert mutes(banded) == [True, False, True, True]
    bpy.ops.spectral_tv.solo(band=1)
    assert mutes(banded) == [False, True, True, True]
    bpy.ops.spectral_tv.solo(band=1)
    assert mutes(banded) == [True, False, False, False]


def test_what_is_muted_or_unmuted_meanwhile_stays_so(banded):
    keys = banded.data.shape_keys.key_blocks
    keys["Shape Detail Band 1"].mute = True
    bpy.ops.spectral_tv.solo(band=2)
    keys["Shape Detail Band 3"].mute = False
    keys["Shape Detail Band 2"].mute = True
    bpy.ops.spectral_tv.solo(band=4)
    assert mutes(banded) == [True, True, True, False]
    bpy.ops.spectral_tv.solo(band=4)
    assert mutes(banded) == [True, True, False, False]


def test_solo_is_kept_in_files(banded, tmp_path: Path):
    banded.data.shape_keys.key_blocks["Shape Detail Band 1"].mute = True
    bpy.ops.spectral_tv.solo(band=2)
    path, name = str(tmp_path / "solo.blend"), banded.name
    bpy.data.libraries.write(path, {banded})
    bpy.data.batch_remove([banded])
    with bpy.data.libraries.load(path) as (_, target):
        target.objects = [name]
    loaded = target.objects[0]
    bpy.context.collection.objects.link(loaded)
    activate(loaded)
    bpy.ops.spectral_tv.solo(band=2)
    assert mutes(loaded) == [True, False, False, False]
    with pytest.raises(RuntimeError, match="no band 5"):
        bpy.ops.spectral_tv.solo(band=5)
