"""The operator that makes the mix of the bands the shape itself."""

from collections.abc import Sequence

import bpy
from bpy.props import EnumProperty
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from ..scene import keeping, masks, mix
from ..scene.applying import FOLLOWERS
from ..scene.look import become
from ..scene.objects import take_place
from ..scene.records import all_bands_of, forget, place_refusal, records_of
from . import carrying
from .set_bands import BandsOperator, bands_refusal

WHERE = (
    ("HERE", "This Object", "The object itself takes the shape"),
    ("COPY", "A New Object", "A copy takes the shape; the object stays, hidden in renders too"),
)


class SPECTRAL_TV_OT_apply_look(BandsOperator, bpy.types.Operator):
    """Make the mix of the bands of all decompositions the shape of the mesh, and remove them. Other
    shape keys, masks, drivers, UV maps, vertex groups and modifiers stay"""

    bl_idname = "spectral_tv.apply_look"
    bl_label = "Apply Look"
    changes_keys = True

    place: EnumProperty(
        name="To", description="What takes the shape", items=WHERE, options={"SKIP_SAVE"}
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return look_refusal(context.active_object)

    @classmethod
    def description(cls, _context, properties) -> str:
        copied = " of a copy" if properties.place == "COPY" else ""
        return cls.__doc__.replace("of the mesh", f"of the mesh{copied}")

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> str:
        bands = all_bands_of(obj)
        note_unsettled(obj, bands, "applied as they are on this frame")
        if not any(part.key in bands for part in mix.parts(obj)):
            raise Refusal("the bands change nothing at their present values")
        users = [each.name for each in context.blend_data.objects if each.data == obj.data]
        if self.place == "COPY":
            obj = _copied(obj)
        elif len(users) > 1:
            note(f"the mesh is shared: {', '.join(users)} have the shape now")
        become_look(obj, all_bands_of(obj))
        left = "" if obj.data.shape_keys is not None else "; it has no shape keys any more"
        return f"{len(bands)} bands became the shape of {obj.name!r}{left}"


def become_look(obj: bpy.types.Object, spent: "Sequence[keeping.Band]") -> None:
    """Have what some keys do now, masks and mutes included, be the shape of the mesh.

    They are removed, and the mesh has no decompositions any more.
    """
    parts = [part for part in mix.parts(obj) if part.key in spent]
    displacement = mix.Moves().of(obj, parts)
    _tell_readers(obj, spent)
    forget(obj.data)
    renewals = [follow(obj) for follow in FOLLOWERS]
    become(obj, displacement, spent)
    for renew in renewals:
        renew()
    masks.release(obj)


def _tell_readers(obj: bpy.types.Object, spent: "Sequence[keeping.Band]") -> None:
    """Have what follows bands by Carry Along stay as it is, and note what else reads them."""
    settled = carrying.settle(obj, spent)
    if settled:
        note(f"these stay as the look has them, and follow no longer: {listed(settled)}")
    for place in keeping.PLACES.values():
        left = place.readers(obj, [band for band in spent if keeping.place_of(band) == place])
        if left:
            note(f"drivers of {listed(left)} read these bands, and find them no more")


def look_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why no look can be applied now, in a sentence for the user; None if one can be."""
    reason = bands_refusal(obj, override=False)
    if reason is not None:
        return reason
    if obj.mode != "OBJECT":
        return "Go to Object Mode first"
    return place_refusal(obj) or pinned_refusal(obj)


def pinned_refusal(obj: bpy.types.Object) -> str | None:
    """Why the mix of the bands is not what is shown; None if it is."""
    if not obj.show_only_shape_key:
        return None
    setting = obj.bl_rna.properties["show_only_shape_key"].name
    return f"{setting} shows one shape key alone; turn it off first"


def note_unsettled(obj: bpy.types.Object, bands: "list[keeping.Band]", done: str) -> None:
    """Note which bands are animated, and that they are ``done`` all the same; and which are soloed,
    so that others do not count."""
    moving = [key.name for key in bands if keeping.place_of(key).animation_of(key, "value")]
    if moving:
        note(f"animated, {done}: {listed(moving)}")
    for record in records_of(obj):
        if record.solo:
            note(f"of {record.name!r} one band is soloed, and counts alone")


def _copied(obj: bpy.types.Object) -> bpy.types.Object:
    """A copy with a mesh of its own, now the active object; ``obj`` is hidden."""
    copy = obj.copy()
    copy.data = obj.data.copy()
    copy.name = f"{obj.name} Look"
    for collection in obj.users_collection:
        collection.objects.link(copy)
    take_place(copy, obj)
    obj.hide_render = True
    note(f"{obj.name!r} is hidden, in renders too")
    return copy
