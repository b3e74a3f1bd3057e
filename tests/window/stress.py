"""What impatient users do while a job runs; Blender runs this: see run.sh.

Nothing crashes, what was there stays, no job is left behind, and messages say what happened.
"""

from __future__ import annotations

import random
import sys
import tempfile
from collections import Counter
from itertools import count
from pathlib import Path
from typing import Any

import bpy

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parent))

import changes
from contents import contents, differences
from deform import new_dumbbell
from interruptions import interruptions
from pictures import activate, new_monkey
from screen import PICTURES, Steps, centre, in_view, key, move, picture, region, run, told, until
from work import (
    ENDLESS,
    FEW,
    LONG_WORK,
    SHORT_WORK,
    all_ended,
    is_running,
    megabytes,
    start,
    workers,
)

MODULE = "bl_ext.user_default.spectral_tv"
CANCELLATIONS = 100
# Megabytes that Blender itself may come to need during these; each job takes more than five.
NOISE = 60


def stress() -> Steps[None]:
    yield 1
    yield from undo_every_job()
    yield from cancel_at_random_moments()
    yield from change_it_meanwhile()
    yield from live()
    yield from interruptions()
    yield from start_another_at_once()
    yield from two_windows()
    yield from disable_meanwhile()
    yield from save_and_reopen()
    yield from picture("stressed")
    (PICTURES / "stress.passed").touch()
    bpy.ops.wm.quit_blender()


def undo_every_job() -> Steps[None]:
    """Of each operator that runs a job, Ctrl-Z takes back what came of it, and no more."""
    kinds = sys.modules[f"{MODULE}.job.operator"].JobOperator.__subclasses__()
    assert {kind.bl_idname.removeprefix("spectral_tv.") for kind in kinds} == SHORT_WORK.keys()
    precious()
    start("decompose", bands=3, steps=FEW + 2)  # so that there are bands to bake
    yield from all_ended()
    start("fill_mask", source="GROUP", group="Cap")  # and a mask to blur
    for group, kind in (("Eye", "PIN"), ("Ear", "OBJECT")):
        bpy.context.object.vertex_groups.active = bpy.context.object.vertex_groups[group]
        start("constraint_add", kind=kind)
    bpy.context.object.spectral_tv.constraints[1].target.location.x += 0.5
    photo = bpy.data.images.new("Photo", 16, 16)
    photo.pixels[0] = 0.5
    photo.pack()
    photo.use_fake_user = True  # or it is not saved
    bpy.ops.ed.undo_push(message="Ready")
    before = contents()
    yield from move(*centre(region("WINDOW")))
    for name, arguments in SHORT_WORK.items():
        start(name, **arguments)
        yield from all_ended()
        after = contents()
        assert after != before, name
        yield from key("ctrl+z")
        unchanged(before)
        yield from key("ctrl+shift+z")
        unchanged(after)
        yield from key("ctrl+z")


def cancel_at_random_moments() -> Steps[None]:
    """By Esc, by the button, or by Blender; all work ends, and its memory is free again."""
    precious(subdivisions=3)
    before = contents()
    chance = random.Random(7)
    yield from move(*centre(region("WINDOW")))
    used = 0.0
    for number in range(CANCELLATIONS):
        name, arguments = chance.choice(LONG_WORK)
        start(name, **arguments)
        yield chance.uniform(0, 0.25)
        assert is_running(), f"{name} was over at once"
        if chance.random() < 0.5:
            yield from key("Escape")
        else:
            bpy.ops.spectral_tv.cancel()
        yield from all_ended()
        if number == CANCELLATIONS // 5:
            used = megabytes()
    print(f"{megabytes() - used:.0f} MB more after {CANCELLATIONS} cancellations")
    assert megabytes() - used < NOISE
    unchanged(before)


def change_it_meanwhile() -> Steps[None]:
    """A result that no longer fits is not written, and the user is told why."""
    expected: Counter[str] = Counter()
    for change, reason in (
        (changes.delete, "removed or renamed in the meantime"),
        (changes.rename, "removed or renamed in the meantime"),
        (changes.edit, "as it changed in the meantime"),
        (changes.move_a_vertex, "as it changed in the meantime"),
        (changes.exchange_the_mesh, "as it changed in the meantime"),
        (changes.undo, "as it changed in the meantime"),
        (changes.enter_edit_mode, "Leave Edit Mode first"),
        (changes.enter_edit_mode_by_a_twin, "in Edit Mode as that of another object"),
        (changes.turn_dyntopo_on, "Turn Dyntopo off first"),
        (changes.make_keys_absolute, "relative ones are needed"),
    ):
        obj = precious()
        start("decompose", steps=FEW)
        change(obj)
        changed = contents()
        yield from all_ended()
        expected[reason] += 1
        assert (yield from told()).count(reason) == expected[reason], change.__name__
        unchanged(changed)
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
    for change in (
        changes.add_a_key,
        changes.remove_the_keys,
        changes.remove_the_groups,
        changes.sculpt,
        changes.another_scene,
    ):
        obj = precious()
        name = obj.name
        for work, arguments in (
            ("decompose", {"steps": FEW}),
            ("flow_attribute", {"kind": "KEY", "source": "Smile", "steps": FEW}),
        ):
            if "Smile" not in keys(obj) and work == "flow_attribute":
                continue
            start(work, **arguments)
            if work == "decompose" or change is changes.remove_the_keys:
                change(obj)
            yield from all_ended()
            obj = bpy.data.objects[name]
        assert "Shape Detail Band 5" in keys(obj) or change is changes.remove_the_keys, (
            change.__name__
        )
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")


def live() -> Steps[None]:
    """One step of undo takes a whole live deformation back; it ends when it can no longer go on."""
    obj = new_dumbbell()
    for group in ("Feet", "Head"):
        obj.vertex_groups.active = obj.vertex_groups[group]
        with in_view():
            bpy.ops.spectral_tv.constraint_add(kind="PIN" if group == "Feet" else "OBJECT")
    bpy.ops.ed.undo_push(message="Dumbbell")
    before = contents()
    yield from drag_live()
    yield from key("Escape")
    yield from until(lambda: not live_runs(), "the live deformation to end")
    after = contents()
    assert after != before
    for _ in range(2):
        yield from key("ctrl+z")
        unchanged(before)
        yield from key("ctrl+shift+z")
        unchanged(after)
    for change, reason in (
        (changes.enter_edit_mode, "no longer live: Leave Edit Mode first"),
        (changes.edit, "no longer live: its vertices or faces changed"),
        (changes.delete, "no longer live: it was removed or renamed"),
    ):
        yield from drag_live()
        change(bpy.data.objects["Dumbbell"])
        yield from until(lambda: not live_runs(), "the live deformation to end")
        assert reason in (yield from told())
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
    yield from all_ended()


def start_another_at_once(window: bpy.types.Window | None = None) -> Steps[None]:
    """What was cancelled takes no notice of what comes next."""
    obj = precious()
    start("decompose", method="M2", steps=ENDLESS)
    bpy.ops.spectral_tv.cancel()
    start("decompose", window, method="M1", steps=FEW)
    yield from all_ended()
    assert [name for name in keys(obj) if "Band" in name] == [
        f"Shape Detail Band {band}" for band in range(1, 6)
    ]


def two_windows() -> Steps[None]:
    """One job at a time, whichever window it is of; it ends with its window."""
    with in_view():
        bpy.ops.wm.window_new()
    yield 1
    second = bpy.context.window_manager.windows[-1]
    if not any(area.type == "VIEW_3D" for area in second.screen.areas):
        second.screen.areas[0].type = "VIEW_3D"
        yield 0.2
    yield from start_another_at_once(second)
    obj = precious()
    start("decompose", second, steps=ENDLESS)
    with in_view():
        assert not bpy.ops.spectral_tv.decompose.poll()
        bpy.ops.spectral_tv.cancel()
    yield from all_ended()
    start("decompose", second, steps=FEW)
    yield from all_ended()
    assert "Shape Detail Band 5" in keys(obj)
    before = contents()
    start("decompose", second, method="M2", steps=ENDLESS)
    yield 0.3
    with in_view(second):
        bpy.ops.wm.window_close()
    yield from all_ended()
    unchanged(before)
    with in_view():
        assert bpy.ops.spectral_tv.decompose.poll()


def disable_meanwhile() -> Steps[None]:
    """The job ends with the extension; what it had written is there when it is enabled again."""
    precious()
    start("decompose", steps=FEW)
    yield from all_ended()
    before = contents()
    for work, arguments in (("decompose", {"method": "M2", "steps": ENDLESS}), ("deform_live", {})):
        if work == "deform_live":
            for group, kind in (("Half", "PIN"), ("Eye", "OBJECT")):
                obj = bpy.context.object
                obj.vertex_groups.active = obj.vertex_groups[group]
                bpy.ops.spectral_tv.constraint_add(kind=kind)
        start(work, **arguments)
        yield 0.3
        before = contents()
        bpy.ops.preferences.addon_disable(module=MODULE)
        yield from until(lambda: not workers(), "the job to end with the extension")
        assert dir(bpy.ops.spectral_tv) == []
        yield from move(*centre(region("WINDOW")))
        yield 0.3
        bpy.ops.preferences.addon_enable(module=MODULE)
        yield 0.3
        unchanged(before)
    start("filter", preset="LOW_PASS", first=3)
    assert [band.value for band in bpy.context.object.data.shape_keys.key_blocks[2:5]] == [
        -1,
        -1,
        0,
    ]


def save_and_reopen() -> Steps[None]:
    """Saving does not disturb a job; opening a file ends it, and the file is as it was saved."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "saved.blend")
        obj = precious()
        start("decompose", steps=FEW)
        bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
        yield from all_ended()
        assert "Shape Detail Band 5" in keys(obj)
        bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
        saved = contents()
        for work in ("decompose", "cosegment"):
            start(work, steps=ENDLESS)
            yield 0.3
            bpy.ops.wm.open_mainfile(filepath=path)
            yield from all_ended()
            unchanged(saved)
        start("decompose", steps=ENDLESS)
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        yield from all_ended()
        bpy.ops.wm.open_mainfile(filepath=path)
        yield 0.5
        unchanged(saved)
        assert not is_running()
        start("decompose", method="M2", steps=FEW)
        yield from all_ended()
        assert "Limbs and Head Band 5" in keys(bpy.context.object)


_counter = count(1)


def precious(subdivisions: int = 1) -> bpy.types.Object:
    """A monkey with shape keys and vertex groups, the active object; the last step of undo."""
    obj = new_monkey(subdivisions)
    obj.vertex_groups.new(name="Half").add(range(len(obj.data.vertices) // 2), 0.5, "REPLACE")
    obj.vertex_groups.new(name="Eye").add([len(obj.data.vertices) - 1], 1.0, "REPLACE")
    obj.vertex_groups.new(name="Ear").add([0], 1.0, "REPLACE")
    cap = [vertex.index for vertex in obj.data.vertices if vertex.co.z > 0.5]
    obj.vertex_groups.new(name="Cap").add(cap, 1.0, "REPLACE")
    obj.shape_key_add(name="Basis")
    bpy.ops.ed.undo_push(message="Basis")
    obj.shape_key_add(name="Smile").data[3].co.x += 0.25
    moved = 0.01 * next(_counter)  # so that no flow in memory is that of this monkey
    obj.data.shape_keys.reference_key.data[5].co.x += moved
    obj.data.vertices[5].co.x += moved
    bpy.ops.ed.undo_push(message="Smile")
    return obj


def unchanged(before: dict[str, Any]) -> None:
    """Assert that all is as it was."""
    found = differences(before, contents())
    assert not found, found


def drag_live() -> Steps[None]:
    """Deform live, until the shape has followed."""
    obj = bpy.data.objects["Dumbbell"]
    activate(obj)
    start("deform_live")
    obj.spectral_tv.constraints[1].target.location.x += 0.3
    yield from until(lambda: "Deformation" in keys(obj), "the shape to follow")
    yield 0.3


def live_runs() -> bool:
    return (
        sys.modules[f"{MODULE}.deformation.live_operator"].SPECTRAL_TV_OT_deform_live.running
        is not None
    )


def keys(obj: bpy.types.Object) -> list[str]:
    found = obj.data.shape_keys
    return [] if found is None else [key.name for key in found.key_blocks]


bpy.context.preferences.view.show_splash = False
# It writes what Dyntopo holds into the mesh, at any moment.
bpy.context.preferences.filepaths.use_auto_save_temporary_files = False
run(stress())
