"""What a user does to a production's scene, item by item."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

import bpy
from ball import ball
from conftest import MODULE
from deform_scene import members
from spectral_tv.bands.gains import PRESETS

QUICK = {"bands": 3, "steps": 8}
OPS = bpy.ops.spectral_tv
RECIPES = import_module(f"{MODULE}.recipes.recipes").RECIPES

Item = Callable[[bpy.types.Object], object]


def split(obj, **more) -> None:
    """Decompose, and check that it was done."""
    assert OPS.decompose(**{**QUICK, **more}) == {"FINISHED"}


def bands(obj) -> list[bpy.types.ShapeKey]:
    """Those of the active decomposition."""
    return import_module(f"{MODULE}.scene.records").bands_of(obj)


def dialled(obj, values=(1.5, -0.4, 0.7)) -> None:
    split(obj)
    for band, value in zip(bands(obj), values, strict=True):
        band.value = value


def masked(obj) -> None:
    """The same, with a mask of the second band."""
    dialled(obj)
    OPS.fill_mask(band=2, source="GROUP", group="Lids")


def select(obj) -> None:
    for vertex in obj.data.vertices:
        vertex.select = vertex.co.z > 0


def curve(obj) -> None:
    dialled(obj)
    OPS.add_curve()
    node = import_module(f"{MODULE}.bands.filter_curve").find()
    node.mapping.curves[0].points[0].location.y = 2.0
    node.mapping.update()
    OPS.apply_curve()
    assert bands(obj)[0].value > 0.5
    bpy.data.node_groups.remove(node.id_data)


def another_method(obj) -> None:
    dialled(obj)
    split(obj, method="M2", bands=2)
    split(obj, method="M3", bands=2, base="KEY", base_key="Smile")
    assert len(obj.data.spectral_tv.decompositions) == 3


def replaced(obj) -> None:
    masked(obj)
    split(obj, bands=4, into="REPLACE")
    assert len(obj.data.spectral_tv.decompositions) == 1 and len(bands(obj)) == 4


def sculpted(obj) -> None:
    """A band that was sculpted stays as a key of its own."""
    masked(obj)
    for point in bands(obj)[1].points[:40]:
        point.co.x += 0.01
    assert OPS.cut(bands=2) == {"FINISHED"}


def renamed(obj) -> None:
    masked(obj)
    obj.data.spectral_tv.decompositions[0].name = "Skin"
    assert bands(obj)[0].name == "Skin Band 1"


def removed(obj) -> None:
    masked(obj)
    split(obj, method="M2")
    OPS.remove_decomposition()
    OPS.remove_decomposition()
    assert not obj.data.spectral_tv.decompositions


def switched(obj) -> None:
    dialled(obj)
    split(obj, method="M2")
    OPS.switch_decomposition(name=obj.data.spectral_tv.decompositions[0].name)
    OPS.filter(preset="EXAGGERATE")


def from_selection(obj) -> None:
    dialled(obj)
    select(obj)
    OPS.fill_mask(band=1, source="SELECTION")
    OPS.fill_mask(band=1, source="GROUP", group="Bone", combine="SUBTRACT")


def painted(obj) -> None:
    dialled(obj)
    assert OPS.paint_mask(band=2, weight=0.5) == {"FINISHED"} and obj.mode == "WEIGHT_PAINT"
    # Strokes need a window; this changes the active group, too.
    bpy.ops.object.vertex_group_levels(group_select_mode="ACTIVE", gain=0.5)
    assert OPS.paint_mask(band=2) == {"FINISHED"} and obj.mode == "OBJECT"
    assert members(obj, bands(obj)[1].vertex_group).size == len(obj.data.vertices)


def from_segment(obj) -> None:
    dialled(obj)
    OPS.cosegment(segments=3, steps=8)
    group = next(each for each in obj.vertex_groups if each.name.startswith("Segment"))
    OPS.fill_mask(band=1, source="GROUP", group=group.name)


def taken(obj) -> None:
    """Bands of a twin in the place of its own."""
    twin = obj.copy()
    twin.data = obj.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    for each in (twin, obj):
        bpy.context.view_layer.objects.active = each
        each.select_set(True)
        split(each)
    assert OPS.take_bands(first=1, last=2) == {"FINISHED"}


def copied_filter(obj) -> None:
    taken(obj)
    OPS.copy_filter()


def caricature(obj) -> None:
    other = ball("Ball")
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    assert OPS.caricature(bands=3, steps=8, first=2, last=3) == {"FINISHED"}
    assert other.data.shape_keys is not None


def posed(obj) -> None:
    patches = {
        "held": [{"name": "", "point": (0, 0, -1.4), "radius": 0.4}],
        "pulled": [{"name": "", "point": (0, 0, 1.4), "radius": 0.4}],
    }
    assert OPS.hold_and_pull(**patches) == {"FINISHED"}
    obj.spectral_tv.algorithm = "POSE"
    obj.spectral_tv.constraints[1].target.location.x += 0.4
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()
    assert OPS.deform() == {"FINISHED"}
    assert obj.data.shape_keys.key_blocks["Deformation"].value == 1


def undone(obj) -> None:
    bpy.ops.ed.undo_push(message="before")
    OPS.decompose("EXEC_DEFAULT", True, **QUICK)
    bpy.ops.ed.undo()
    assert not bpy.data.objects["Body"].data.spectral_tv.decompositions


def reloaded(obj) -> None:
    masked(obj)
    path = bpy.data.filepath.replace(".blend", " again.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)


def as_one(obj) -> None:
    other = ball("Ball")
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    split(obj, together=True)
    assert other.data.shape_keys is not None


def convex(obj) -> None:
    posed(obj)
    obj.spectral_tv.algorithm = "CONVEX"
    assert OPS.deform() == {"FINISHED"}


def all_in_turn(obj) -> None:
    masked(obj)
    for work in (
        lambda: OPS.blur_mask(band=2, radius=5),
        lambda: OPS.cut(bands=4),
        lambda: split(obj, bands=2, into="REPLACE"),
        lambda: OPS.recipe(recipe="Caricature"),
        OPS.bake_safe,
        OPS.bake,
        lambda: OPS.cosegment(segments=3, steps=8),
        lambda: OPS.flow_attribute(kind="KEY", source="Blink", steps=8),
        OPS.remove_decomposition,
        OPS.remove_decomposition,
    ):
        assert work() in ({"FINISHED"}, None)
    assert not obj.data.spectral_tv.decompositions


def in_mode(mode: str, item: Item) -> Item:
    """The same in a mode of the object, with a face key that is the active one meanwhile."""

    def work(obj) -> None:
        obj.active_shape_key_index = obj.data.shape_keys.key_blocks.find("Smile")
        bpy.ops.ed.undo_push(message="without it Sculpt Mode has no undo in the background")
        bpy.ops.object.mode_set(mode=mode)
        item(obj)
        assert obj.mode == mode
        bpy.ops.object.mode_set(mode="OBJECT")
        assert obj.active_shape_key.name == "Smile"
        obj.active_shape_key_index = 0

    return work


def as_attributes(item: Item) -> Item:
    """The same with bands that are attributes."""

    def work(obj) -> None:
        QUICK["bands_as"] = "ATTRIBUTES"
        try:
            item(obj)
        finally:
            del QUICK["bands_as"]

    return work


def converted(obj) -> None:
    """Animated and masked bands, as attributes and as shape keys again."""
    split(obj)
    OPS.fill_mask(band=2, source="GROUP", group="Lids")
    OPS.keyframe()
    assert OPS.convert_bands(to="ATTRIBUTES") == {"FINISHED"}
    assert OPS.convert_bands(to="KEYS") == {"FINISHED"}


def mask_from_edit_mode(obj) -> None:
    split(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    assert OPS.fill_mask(band=1, source="SELECTION") == {"FINISHED"} and obj.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")


# What is done without bands that are split off by it.
ABOUT_NO_BANDS = (
    "recipe",
    "caricature",
    "pose",
    "bake the pose",
    "segments",
    "split",
    "flow",
    "thickness",
    "undo",
    "total variation",
    "eigenset",
    "decompose with",
    "selected as one",
)
OF_EITHER_KIND: dict[str, Item] = {
    "decompose as shown": split,
    "decompose Basis": lambda obj: split(obj, shape="BASIS"),
    "decompose with modifiers applied": lambda obj: split(obj, shape="APPLIED"),
    "dial": dialled,
    "keyframe": lambda obj: (split(obj), OPS.keyframe()),
    "solo": lambda obj: (dialled(obj), OPS.solo(band=2)),
    "widen": lambda obj: (dialled(obj), OPS.widen_sliders()),
    **{
        f"filter {preset}": lambda obj, preset=preset: (dialled(obj), OPS.filter(preset=preset))
        for preset, *_ in PRESETS
    },
    "filter curve": curve,
    "another method": another_method,
    "replace": replaced,
    "cut again": lambda obj: (masked(obj), OPS.cut(bands=2, keep_limbs=0.5)),
    "cut again beside a sculpted band": sculpted,
    "rename": renamed,
    "remove": removed,
    "switch": switched,
    "mask of the selection": from_selection,
    "mask of a segment": from_segment,
    "paint mask": painted,
    "invert mask": lambda obj: (masked(obj), OPS.invert_mask(band=2)),
    "blur mask": lambda obj: (masked(obj), OPS.blur_mask(band=2, radius=10)),
    "copy mask": lambda obj: (masked(obj), OPS.copy_mask(band=2)),
    "choose mask": lambda obj: (masked(obj), OPS.choose_mask(band=2, group="Bone")),
    "invert a chosen mask": lambda obj: (
        dialled(obj), OPS.choose_mask(band=2, group="Bone"), OPS.invert_mask(band=2)
    ),
    "remove mask": lambda obj: (masked(obj), OPS.remove_mask(band=2)),
    **{
        f"recipe {recipe.name}": lambda obj, name=recipe.name: OPS.recipe(recipe=name)
        for recipe in RECIPES
    },
    "caricature": caricature,
    "bake mix": lambda obj: (masked(obj), OPS.bake()),
    "bake safe": lambda obj: (masked(obj), OPS.bake_safe()),
    "apply look to a copy": lambda obj: (masked(obj), OPS.apply_look(place="COPY")),
    "take bands": taken,
    "copy filter": copied_filter,
    "pose": posed,
    "bake the pose": lambda obj: (posed(obj), OPS.bake_deformation(frame_end=3)),
    "segments": lambda obj: OPS.cosegment(segments=3, steps=8),
    "split segments": lambda obj: (OPS.cosegment(segments=3, steps=8), OPS.split_segments()),
    "flow of a face key": lambda obj: OPS.flow_attribute(kind="KEY", source="Smile", steps=8),
    "thickness": lambda obj: OPS.measure_thickness(),
    "undo": undone,
    "save and load": reloaded,
    "limit to": lambda obj: split(obj, vertex_group="Lids"),
    "selected as one": as_one,
    "total variation": convex,
    "accuracy": lambda obj: (split(obj), OPS.measure_accuracy(**QUICK)),
    "eigenset": lambda obj: OPS.test_eigenset(group="Bone"),
    "all in turn": all_in_turn,
    "mask in Edit Mode": mask_from_edit_mode,
    **{
        f"{name} in {mode}": in_mode(mode, item)
        for mode in ("SCULPT", "WEIGHT_PAINT", "TEXTURE_PAINT")
        for name, item in (
            ("decompose", dialled),
            ("replace", replaced),
            ("remove", removed),
            ("recipe", lambda obj: OPS.recipe(recipe="Caricature")),
        )
    },
}  # fmt: skip


ITEMS: dict[str, Item] = {
    **OF_EITHER_KIND,
    **{
        f"{name} as attributes": as_attributes(item)
        for name, item in OF_EITHER_KIND.items()
        if name not in ("cut again beside a sculpted band", "mask in Edit Mode")
        and not name.startswith(("decompose in", "replace in", "remove in", "recipe in"))
        and not name.startswith(ABOUT_NO_BANDS)
    },
    "convert and back": converted,
}


def worked_on(_head) -> bpy.types.Object:
    """The work object of the sculpt, split into bands, all at 0."""
    assert OPS.work_object() == {"FINISHED"}
    work = bpy.context.object
    split(work)
    return work


def written_back(sculpt) -> None:
    worked_on(sculpt)
    assert OPS.write_back() == {"FINISHED"}


def written_back_and_forth(sculpt) -> None:
    """Another shape, and the former one again."""
    work = worked_on(sculpt)
    bands(work)[0].value = -1
    OPS.write_back()
    assert OPS.work_object() == {"FINISHED"} and bpy.context.object == work
    bands(work)[0].value = 0
    assert OPS.write_back() == {"FINISHED"}


HEAD_ITEMS: dict[str, Item] = {
    "decompose the cage": split,
    "decompose the top level": lambda obj: split(obj, shape="MULTIRES"),
    "decompose with modifiers applied": lambda obj: split(obj, shape="APPLIED"),
    "write back": written_back,
    "write back and forth": written_back_and_forth,
    "mask, cut again, remove": lambda obj: (masked(obj), OPS.cut(bands=2), removed(obj)),
    "recipe": lambda obj: OPS.recipe(recipe="Caricature"),
    "bake safe": lambda obj: (masked(obj), OPS.bake_safe()),
    "apply look to a copy": lambda obj: (dialled(obj), OPS.apply_look(place="COPY")),
    "segments": lambda obj: OPS.cosegment(segments=3, steps=8),
}
