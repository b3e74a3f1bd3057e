"""Objects of another file, linked and overridden: what can be kept is done, all else is refused."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import bpy
import pytest
from ball import ball
from conftest import MODULE
from contents import contents
from deform_scene import evaluated

RECORDS = import_module(f"{MODULE}.scene.records")
bands_of, all_bands_of = RECORDS.bands_of, RECORDS.all_bands_of


def values(obj) -> list[float]:
    return [round(band.value, 6) for band in bands_of(obj)]


def muted(obj) -> list[bool]:
    return [band.mute for band in bands_of(obj)]


def override(obj) -> bpy.types.Object:
    """An editable copy of a linked object, mesh and shape keys that remembers what was changed."""
    scene = bpy.context.scene
    made = obj.override_hierarchy_create(scene, bpy.context.view_layer, do_fully_editable=True)
    if made.data.override_library is None:
        made.data.override_create(remap_local_usages=True)
    bpy.context.view_layer.objects.active = made
    return made


@pytest.fixture(params=["KEYS", "ATTRIBUTES"])
def linked(request, tmp_path: Path):
    """A ball with bands and the vertex group Cap, from another file."""
    obj = ball("Ball")
    bpy.ops.spectral_tv.decompose(bands=3, steps=8, bands_as=request.param)
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
    "blur_mask": {},
    "caricature": {"bands": 3, "steps": 8},
    "choose_mask": {"group": "Cap"},
    "constraint_add": {"kind": "PIN"},
    "copy_mask": {},
    "cosegment": {"segments": 3, "steps": 8},
    "cut": {"bands": 2},
    "decompose": {"bands": 2, "steps": 8},
    "deform": {},
    "fill_mask": {"source": "GROUP", "group": "Cap"},
    "flow_attribute": {"kind": "GROUP", "source": "Cap", "steps": 4},
    "invert_mask": {},
    "measure_accuracy": {"bands": 2, "steps": 8},
    "own_mask": {},
    "paint_mask": {},
    "remove_decomposition": {},
    "remove_mask": {},
    "split_segments": {},
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
    bands_of(obj)[0].mute = True
    assert bpy.ops.spectral_tv.filter(preset="LOW_PASS", first=2) == {"FINISHED"}
    assert bpy.ops.spectral_tv.solo(band=3) == {"FINISHED"}
    changed = values(obj)
    assert changed == [-1, 0, 0]
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    (obj,) = (obj for obj in bpy.data.objects if obj.library is None)
    assert values(obj) == changed
    assert muted(obj) == [True, True, False]
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.spectral_tv.solo(band=3) == {"FINISHED"}
    assert muted(obj) == [True, False, False]
    assert bpy.ops.spectral_tv.filter(preset="RESET") == {"FINISHED"}
    assert values(obj) == [0, 0, 0]


def test_made_local_it_is_like_any_other(linked):
    obj = override(linked)
    obj.make_local()
    obj.data.make_local()
    assert bpy.ops.spectral_tv.decompose(bands=2, steps=8, into="ADD") == {"FINISHED"}
    assert len(all_bands_of(obj)) == 5


def reopened(obj, path: Path) -> bpy.types.Object:
    """The same object after the file was saved and opened again."""
    name = obj.name
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    (obj,) = (each for each in bpy.data.objects if each.name == name and each.library is None)
    bpy.context.view_layer.objects.active = obj
    return obj


@pytest.mark.parametrize("linked", ["ATTRIBUTES"], indirect=True)
@pytest.mark.parametrize("is_override", [True, False])
def test_objects_of_a_linked_mesh_have_filters_of_their_own(linked, is_override, tmp_path: Path):
    """Bands that are attributes have their values on the object, and the mesh stays linked."""
    if is_override:
        obj = linked.override_create(remap_local_usages=True)
    else:
        obj = linked.copy()
        bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    before = evaluated(obj)
    assert bpy.ops.spectral_tv.filter(preset="HIGH_PASS", first=1, last=2) == {"FINISHED"}
    assert values(obj) == [0, 0, -1]
    assert bpy.ops.spectral_tv.keyframe() == {"FINISHED"}
    look = evaluated(obj)
    assert abs(look - before).max() > 1e-3
    for name in ("solo", "show_original", "switch_decomposition", "fill_mask", "decompose"):
        with pytest.raises(RuntimeError, match="linked from another file"):
            getattr(bpy.ops.spectral_tv, name)()
    obj = reopened(obj, tmp_path / "scene.blend")
    assert obj.data.library is not None
    assert values(obj) == [0, 0, -1]
    assert abs(evaluated(obj) - look).max() < 1e-6
    bpy.context.scene.frame_set(2)
    assert bpy.ops.spectral_tv.filter(preset="RESET") == {"FINISHED"}
    assert abs(evaluated(obj) - before).max() < 1e-6
