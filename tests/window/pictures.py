"""Pictures of every panel and every message, for people to look at."""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy
from screen import Steps, centre, click, find, move, picture, region, until

# From a button to the header of the panel below it.
NEXT_HEADER = 36
TOOLTIP = 2  # seconds until it is there


def panels() -> Steps[None]:
    """All panels of an object without bands, then with them; sub-panels are opened by hand."""
    obj = new_monkey()
    x, y = yield from find("spectral_tv.use_scales", column=0.175)
    yield from click(x, y)
    yield from click(x + 60, y)
    yield from away()
    yield from picture("panel_scales")
    settings().method = "M3"
    yield from away()
    x, y = yield from find("spectral_tv.length_largest", column=0.7)
    yield from click(x - 100, y - NEXT_HEADER)
    for base in ("LIMBS", "FLAT", "KEY"):
        settings().base = base
        yield from away()
        yield from picture(f"panel_base_{base.lower()}")
    obj.shape_key_add(name="Basis")
    settings().base_key = obj.shape_key_add(name="Smooth", from_mix=False).name
    yield from away()
    yield from picture("panel_base_key_chosen")
    settings().base = "FLOW"
    yield from click(*(yield from find("spectral_tv.decompose")))
    yield from until(lambda: len(obj.data.shape_keys.key_blocks) > 2, "the bands of M3")
    yield from away()
    yield from picture("panel_bands")
    settings().method = "M1"  # without the panel of bases there is room for the curve
    yield from away()
    x, y = yield from find("spectral_tv.take_bands", column=0.7)
    yield from click(x - 60, y - NEXT_HEADER)
    yield from away()
    yield from picture("panel_curve_new")
    yield from click(*(yield from find("spectral_tv.add_curve")))
    mapping = bpy.data.node_groups[".Spectral TV Filter"].nodes["Filter"].mapping
    points = mapping.curves[0].points
    points[0].location.y, points[1].location.y = 0, 2.5
    points.new(0.5, 1)
    mapping.update()
    yield from click(*(yield from find("spectral_tv.apply_curve")))
    bands = obj.data.shape_keys.key_blocks[2:]
    yield from until(lambda: bands[0].value < 0 < bands[-1].value, "the curve to be applied")
    yield from away()
    yield from picture("panel_curve")


def messages() -> Steps[None]:
    """What the panels say when something is in the way, and the tooltip of the button then."""
    obj = new_monkey()
    bpy.ops.object.mode_set(mode="EDIT")
    yield from tooltip("message_edit_mode")
    bpy.ops.object.mode_set(mode="OBJECT")

    activate(None)
    yield from tooltip("message_no_object")
    activate(bpy.data.objects["Camera"])
    yield from tooltip("message_no_mesh")
    empty = bpy.data.objects.new("Empty", bpy.data.meshes.new("Empty"))
    bpy.context.collection.objects.link(empty)
    activate(empty)
    yield from tooltip("message_no_faces")

    activate(obj)
    obj.shape_key_add(name="Basis")
    obj.data.shape_keys.use_relative = False
    yield from tooltip("message_absolute_keys")
    obj.data.shape_keys.use_relative = True

    twin = bpy.data.objects.new("Twin", obj.data)
    bpy.context.collection.objects.link(twin)
    yield from tooltip("message_two_users")
    bpy.data.objects.remove(twin)

    yield from linked(obj)

    activate(obj)
    bpy.ops.spectral_tv.decompose(bands=4, steps=8)
    obj.shape_key_remove(obj.data.shape_keys.key_blocks["Shape Detail Band 2"])
    yield from away()
    yield from picture("message_band_deleted")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    yield from away()
    yield from picture("message_mesh_changed")


def linked(obj: bpy.types.Object) -> Steps[None]:
    """A mesh of another file."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "library.blend")
        bpy.data.libraries.write(path, {obj})
        with bpy.data.libraries.load(path, link=True) as (_, target):
            target.objects = [obj.name]
        twin = target.objects[0]
        bpy.context.collection.objects.link(twin)
        activate(twin)
        yield from tooltip("message_linked")
        bpy.data.objects.remove(twin)


def new_monkey(subdivisions: int = 2) -> bpy.types.Object:
    """Suzanne, subdivided, in place of all meshes."""
    for obj in [obj for obj in bpy.data.objects if obj.type == "MESH"]:
        bpy.data.objects.remove(obj)
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    obj.modifiers.new("Subdivision", "SUBSURF").levels = subdivisions
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    settings().steps = 16
    return obj


def tooltip(name: str) -> Steps[None]:
    """Keep a picture of the button's tooltip."""
    x, y = yield from find("spectral_tv.decompose")
    yield from away()
    yield from move(x, y)
    yield from move(x + 3, y)
    yield TOOLTIP
    yield from picture(name)


def away() -> Steps[None]:
    """Move the mouse where it highlights nothing, and have all drawn anew."""
    yield from move(*centre(region("WINDOW")))
    region("UI").tag_redraw()
    yield 0.2


def activate(obj: bpy.types.Object | None) -> None:
    bpy.context.view_layer.objects.active = obj


def settings() -> bpy.types.PropertyGroup:
    return bpy.context.scene.spectral_tv
