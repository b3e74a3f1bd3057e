"""What a user does to a dressed body: maps, other meshes and armatures, and bands of both kinds.

Each item checks that what it is for was done; what is to stay, the test compares.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from contents import contents, differences
from deform_scene import evaluated
from dressed_body import CLOTHES, EYES, RETOPOLOGY, SHIRT, choose
from following import assert_follow, in_world
from map_scene import values_of
from production_items import OPS, Item, as_attributes, bands, dialled, masked, split
from rigged_body import FRAMES

KINDS = ("DISPLACEMENT", "TANGENT", "OBJECT", "NORMAL")
MAP = {"size": 64, "margin": 2}


def baked(**options) -> np.ndarray:
    """A map's values (64, 64, 3); nothing else in the file changes, but by ``material``."""
    before = contents()
    path = str(Path(bpy.data.filepath).with_name("map.exr"))
    assert OPS.bake_map(filepath=path, **MAP, **options) == {"FINISHED"}
    changed = differences(before, contents())
    assert not [each for each in changed if "map.exr" not in each], changed
    values = values_of(path)
    assert np.ptp(values) > 0
    return values


def maps(**options) -> Item:
    """Maps of all kinds, beside the stirred bands."""

    def work(obj) -> None:
        masked(obj)
        bpy.context.scene.frame_set(FRAMES[1])
        choose("Body", *([RETOPOLOGY] if options.get("onto") else []))
        found = {kind: baked(kind=kind, **options) for kind in KINDS}
        along = np.abs(found["DISPLACEMENT"]).max()
        assert 0 < along <= 1.01 * np.linalg.norm(found["TANGENT"], axis=2).max()
        assert found["NORMAL"].min() >= 0 and found["NORMAL"].max() <= 1

    return work


def map_shown(obj) -> None:
    """A material with the map, on the retopology; undone, as the slots have it otherwise."""
    dialled(obj)
    choose("Body", RETOPOLOGY)
    target = bpy.data.objects[RETOPOLOGY]
    baked(kind="TANGENT", onto="OTHER", material=True)
    (slot,) = target.material_slots
    assert slot.link == "OBJECT" and slot.material.name == f"{RETOPOLOGY} Map"
    slot.link = "DATA"


def taken_by_surface(into: str) -> Item:
    """The retopology has the bands of the body."""

    def work(obj) -> None:
        masked(obj)
        target = choose(RETOPOLOGY, "Body")
        if into == "REPLACE":
            split(target)
        before = evaluated(target)
        assert OPS.take_bands(first=1, last=3, into=into) == {"FINISHED"}
        assert np.abs(evaluated(target) - before).max() > 1e-4
        if into == "ADD":
            assert_follow([target], obj)
            assert OPS.remove_decomposition() == {"FINISHED"}
        else:
            before = evaluated(target)
            target.data.shape_keys.key_blocks[-1].points[0].co.z += 0.001  # it stays, muted
            assert OPS.take_bands(first=1, last=3, into=into) == {"FINISHED"}
            np.testing.assert_allclose(evaluated(target), before, rtol=0, atol=1e-6)
        choose("Body")

    return work


def carried(obj) -> None:
    """All clothes follow on all frames."""
    masked(obj)
    choose("Body", *CLOTHES)
    assert OPS.carry_along() == {"FINISHED"}
    assert_follow([bpy.data.objects[name] for name in CLOTHES], obj)


def carried_again(obj) -> None:
    """Once more after a change of name, and after strokes on a key: none acts twice."""
    carried(obj)
    shirt = bpy.data.objects[SHIRT]
    before, keys = evaluated(shirt), shirt.data.shape_keys.key_blocks
    count = len(keys)
    obj.name = "Figure"
    choose("Figure", *CLOTHES)
    assert OPS.carry_along() == {"FINISHED"}
    obj.name = "Body"
    assert len(keys) == count
    np.testing.assert_allclose(evaluated(shirt), before, rtol=0, atol=1e-5)
    keys[-1].points[0].co.z += 0.001
    choose("Body", *CLOTHES)
    assert OPS.carry_along() == {"FINISHED"}
    assert [key.mute for key in keys[-2:]] == [True, False] and len(keys) == count + 1
    np.testing.assert_allclose(evaluated(shirt), before, rtol=0, atol=1e-5)


def carried_and_converted(obj) -> None:
    """The clothes go on following when the bands become of the other kind, and back."""
    carried(obj)
    choose("Body")
    shirt = bpy.data.objects[SHIRT]
    before = evaluated(shirt)
    kind = bands(obj)[0].__class__.__name__ == "ShapeKey"
    for to in ("ATTRIBUTES", "KEYS") if kind else ("KEYS", "ATTRIBUTES"):
        assert OPS.convert_bands(to=to) == {"FINISHED"}
        np.testing.assert_allclose(evaluated(shirt), before, rtol=0, atol=1e-5)
        bands(obj)[2].value = 0
        assert np.abs(evaluated(shirt) - before).max() > 1e-3
        bands(obj)[2].value = 0.7


def carried_and_removed(obj) -> None:
    """What followed bands that are gone is as it was without."""
    carried(obj)
    choose("Body")
    assert OPS.remove_decomposition() == {"FINISHED"}


def applied(obj) -> None:
    """The clothes keep the look as the body does, also once more is carried along."""
    carried(obj)
    choose("Body")
    shirt = bpy.data.objects[SHIRT]
    before = evaluated(shirt)
    OPS.apply_look(place="COPY")
    look = choose("Body Look")
    np.testing.assert_allclose(evaluated(shirt), before, rtol=0, atol=1e-6)
    bpy.data.batch_remove([look])
    choose("Body").hide_set(False)
    seen = evaluated(obj)
    assert OPS.apply_look() == {"FINISHED"}
    np.testing.assert_allclose(evaluated(shirt), before, rtol=0, atol=1e-6)
    split(obj)
    choose("Body", SHIRT)
    assert OPS.carry_along() == {"FINISHED"}
    np.testing.assert_allclose(evaluated(shirt), before, rtol=0, atol=1e-6)
    np.testing.assert_allclose(evaluated(obj), seen, rtol=0, atol=1e-5)


def refitted(obj) -> None:
    """To the look and back: nothing that is seen at rest moves."""
    carried(obj)
    rig = choose("Body", "Rig") and bpy.data.objects["Rig"]
    joints, before = _joints(rig), _resting(rig)
    for _ in range(2):
        assert OPS.refit_armature() == {"FINISHED"}
        assert np.abs(_joints(rig) - joints).max() > 1e-4
        for name, points in _resting(rig).items():
            np.testing.assert_allclose(points, before[name], rtol=0, atol=2e-6, err_msg=name)
    assert rig.mode == "OBJECT" and rig.data.pose_position == "POSE"
    OPS.filter(preset="RESET")
    assert OPS.refit_armature() == {"FINISHED"}
    np.testing.assert_allclose(_joints(rig), joints, rtol=0, atol=1e-6)
    choose("Body")


def _joints(rig) -> np.ndarray:
    return np.array([(*bone.head_local, *bone.tail_local) for bone in rig.data.bones])


def _resting(rig) -> dict[str, np.ndarray]:
    """Where all meshes are seen in the world while the armature rests."""
    rig.data.pose_position = "REST"
    found = {}
    for obj in [each for each in bpy.context.view_layer.objects if each.type == "MESH"]:
        found[obj.name] = in_world(obj)
    rig.data.pose_position = "POSE"
    bpy.context.view_layer.update()
    return found


def _heights(obj) -> list[str]:
    return [each.name for each in obj.data.attributes if each.name.endswith("Height")]


def heights(obj) -> None:
    """Written anew with other bands, whatever these are called, and left without them."""
    split(obj)
    assert OPS.write_heights() == {"FINISHED"}
    obj.data.spectral_tv.decompositions[0].name = "Skin"
    OPS.cut(bands=2)
    assert _heights(obj) == ["Skin Band 1 Height", "Skin Band 2 Height"]
    obj.data.spectral_tv.decompositions[0].name = "Shape Detail"
    split(obj, method="M2", into="REPLACE_ANY")
    (record,) = obj.data.spectral_tv.decompositions
    assert _heights(obj) == [f"{record.name} Band {number} Height" for number in (1, 2, 3)]
    before = _values(obj, _heights(obj))
    assert OPS.write_heights() == {"FINISHED"}
    assert _values(obj, _heights(obj)).keys() == before.keys()
    assert OPS.remove_decomposition() == {"FINISHED"}
    assert len(_heights(obj)) == 3


def converted_with_heights(obj) -> None:
    split(obj, heights=True)
    before = _values(obj, _heights(obj))
    for to in ("ATTRIBUTES", "KEYS"):
        assert OPS.convert_bands(to=to) == {"FINISHED"}
        assert OPS.write_heights() == {"FINISHED"}
        now = _values(obj, _heights(obj))
        assert now.keys() == before.keys()
        for name, values in now.items():
            np.testing.assert_allclose(values, before[name], rtol=0, atol=1e-5)


def _values(obj, names: list[str]) -> dict[str, np.ndarray]:
    found = {name: np.empty(len(obj.data.vertices), np.float32) for name in names}
    for name, values in found.items():
        obj.data.attributes[name].data.foreach_get("value", values)
    return found


def undone(prepare: Callable, work: Callable) -> Item:
    """All in the file is as before."""

    def item(obj) -> None:
        prepare(obj)
        bpy.ops.ed.undo_push(message="before")
        before = contents()
        assert work() == {"FINISHED"}
        assert differences(before, contents())
        bpy.ops.ed.undo()
        assert differences(before, contents()) == []

    return item


def _with(*others: str, active: str = "Body") -> Callable:
    return lambda obj: (masked(obj), choose(active, *others))


def all_in_turn(obj) -> None:
    carried(obj)
    choose("Body", "Rig")
    OPS.refit_armature()
    OPS.write_heights()
    choose(RETOPOLOGY, "Body")
    OPS.take_bands(first=1, last=3, into="ADD")
    choose("Body", RETOPOLOGY)
    baked(kind="TANGENT", onto="OTHER")
    choose(RETOPOLOGY, EYES)
    OPS.carry_along()
    OPS.remove_decomposition()
    choose("Body", "Rig")
    OPS.filter(preset="RESET")
    OPS.refit_armature()
    choose("Body")
    OPS.bake()
    assert OPS.remove_decomposition() == {"FINISHED"}


EXEC = ("EXEC_DEFAULT", True)
OF_EITHER_KIND: dict[str, Item] = {
    "map of the look": maps(),
    "map of a band": maps(source="BAND", band=2),
    "map of the look onto a retopology": maps(onto="OTHER"),
    "map of a band onto a retopology": maps(onto="OTHER", source="BAND", band=2),
    "map shown": map_shown,
    "take bands by the surface": taken_by_surface("ADD"),
    "take bands by the surface in the place of its own": taken_by_surface("REPLACE"),
    "carry along": carried,
    "carry along again": carried_again,
    "carry along and convert": carried_and_converted,
    "carry along and remove": carried_and_removed,
    "refit the armature": refitted,
    "heights": heights,
    "undo taking": undone(
        _with("Body", active=RETOPOLOGY), lambda: OPS.take_bands(*EXEC, first=1, last=3, into="ADD")
    ),
    "undo carrying": undone(_with(*CLOTHES), lambda: OPS.carry_along(*EXEC)),
    "undo refitting": undone(_with("Rig"), lambda: OPS.refit_armature(*EXEC)),
    "undo heights": undone(_with(), lambda: OPS.write_heights(*EXEC)),
    "all in turn": all_in_turn,
}
DRESSED_ITEMS: dict[str, Item] = {
    **OF_EITHER_KIND,
    **{f"{name} as attributes": as_attributes(item) for name, item in OF_EITHER_KIND.items()},
    "convert with heights": converted_with_heights,
    "undo converting": undone(_with(), lambda: OPS.convert_bands(*EXEC, to="ATTRIBUTES")),
    "undo converting back": as_attributes(
        undone(_with(), lambda: OPS.convert_bands(*EXEC, to="KEYS"))
    ),
}
