"""Objects of another file, linked and overridden: what can be kept is done, all else is refused."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest
from ball import ball
from contents import contents

BANDS = [f"M1 Band {band}" for band in (1, 2, 3)]


def values(obj) -> list[float]:
    return [round(obj.data.shape_keys.key_blocks[name].value, 6) for name in BANDS]


def override(obj) -> bpy.types.Object:
    """An editable copy of a linked object, mesh and shape keys that remembers what was changed."""
    scene = bpy.context.scene
    made = obj.override_hierarchy_create(scene, bpy.context.view_layer, do_fully_editable=True)
    if made.data.override_library is None:
        made.data.override_create(remap_local_usages=True)
    bpy.context.view_layer.objects.active = made
    return made


@pytest.fixture
def linked(tmp_path: Path):
    """A ball with bands and the vertex group Cap, from another file."""
    obj = ball("Ball")
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {obj})
    name = obj.name
    bpy.data.batch_remove([obj, obj.data])
    with bpy.data.libraries.load(path, link=True) as (_, target):
        target.objects = [name]
    obj = target.objects[0]
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    yield obj
    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes, *bpy.data.libraries])


# Operators whose results no file would keep.
WRITING = {
    "apply_modifier": {},
    "bake": {},
    "bake_deformation": {"frame_end": 2},
    "bake_safe": {},
    "caricature": {"bands": 3, "steps": 8},
    "constraint_add": {"kind": "PIN"},
    "cosegment": {"segments": 3, "steps": 8},
    "cut": {"bands": 2},
    "decompose": {"bands": 2, "steps": 8},
    "deform": {},
    "flow_attribute": {"kind": "GROUP", "source": "Cap", "steps": 4},
    "measure_accuracy": {"bands": 2, "steps": 8},
    "remove_decomposition": {},
    "plot_values": {"kind": "GROUP", "source": "Cap", "steps": 4},
    "take_bands": {},
    "test_eigenset": {"group": "Cap"},
}


@pytest.mark.parametrize(
    ("is_override", "told"),
    [
        (False, "linked from another file; make it local first"),
        (True, "overrides one of another file; make it local first"),
    ],
)
def test_what_would_be_lost_is_refused(linked, is_override, told):
    if is_override:
        override(linked)
    before = contents()
    for name, arguments in WRITING.items():
        with pytest.raises(RuntimeError, match=told):
            getattr(bpy.ops.spectral_tv, name)(**arguments)
        assert contents() == before


def test_filters_of_an_override_are_kept_in_the_file(linked, tmp_path: Path):
    obj = override(linked)
    obj.data.shape_keys.key_blocks[BANDS[0]].mute = True
    assert bpy.ops.spectral_tv.filter(preset="LOW_PASS", first=2) == {"FINISHED"}
    assert bpy.ops.spectral_tv.solo(band=3) == {"FINISHED"}
    changed = values(obj)
    assert changed == [-1, 0, 0]
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    (obj,) = (obj for obj in bpy.data.objects if obj.library is None)
    assert values(obj) == changed
    assert [obj.data.shape_keys.key_blocks[name].mute for name in BANDS] == [True, True, False]
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.spectral_tv.solo(band=3) == {"FINISHED"}
    assert [obj.data.shape_keys.key_blocks[name].mute for name in BANDS] == [True, False, False]
    assert bpy.ops.spectral_tv.filter(preset="RESET") == {"FINISHED"}
    assert values(obj) == [0, 0, 0]


def test_made_local_it_is_like_any_other(linked):
    obj = override(linked)
    obj.make_local()
    obj.data.make_local()
    assert bpy.ops.spectral_tv.decompose(bands=2, steps=8, into="ADD") == {"FINISHED"}
    assert len(obj.data.shape_keys.key_blocks) == 6
