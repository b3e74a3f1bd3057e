"""The operator that takes bands from another mesh."""

import bpy
from bpy.props import EnumProperty, IntProperty
from spectral_tv.bands.taking import TakeSettings
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from ..options.properties import choices_of
from ..scene import masks, results
from ..scene.objects import refusal
from ..scene.records import bands_of, keeping_of, record_of
from ..scene.results import Piece
from ..scene.whole import whole
from . import corresponding, taken_record
from .bands import set_values
from .set_bands import BandsOperator, bands_refusal

# More bands than a decomposition has.
MOST = 1000
INTO = (
    ("REPLACE", "Replace", "The bands take the place of as many of the active decomposition"),
    ("ADD", "Add", "The bands become a decomposition, with their values, masks and settings"),
)


class SPECTRAL_TV_OT_take_bands(
    BandsOperator, choices_of(TakeSettings, "take"), bpy.types.Operator
):
    """Take bands of the other selected object, such as the skin of a scan. If it has other
    vertices, they come from its nearest surface, so both have to be in about the same place"""

    bl_idname = "spectral_tv.take_bands"
    bl_label = "Take Bands from Selected"
    changes_keys = True

    first: IntProperty(name="From", description="First band; 1 is the finest", default=1, min=1)
    last: IntProperty(name="To", description="Last band; 1 is the finest", default=2, min=1)
    into: EnumProperty(
        name="Into",
        description="What becomes of the bands. A mesh that has none gets them as a decomposition",
        items=INTO,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.active_object
        if obj is None or record_of(obj) is None:
            return refusal(obj)
        return bands_refusal(obj, override=False)

    def draw(self, context: bpy.types.Context) -> None:
        super().draw(context)
        for name in ("first", "last", "into"):
            self.layout.prop(self, name)

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> str:
        source = source_of_bands(context)
        reason = bands_refusal(source)
        if reason is not None:
            raise Refusal(f"{source.name} has no bands to take: {reason}")
        is_added = self.into == "ADD" or record_of(obj) is None
        chosen = self._chosen(obj, source, is_added)
        way = corresponding.corresponding(obj, source, self.settings())
        if is_added:
            name = taken_record.add_taken(obj, source, chosen, way)
            done = f"{len(chosen)} bands of {source.name} as its decomposition {name!r}"
        else:
            _replace(obj, source, chosen, way)
            done = f"{len(chosen)} bands of {source.name} in place of its own"
        ends = {band + 1: record_of(source).bands[band].end for band in chosen}
        return done + way.tell({band: max(end, 0.0) ** 0.5 for band, end in ends.items()})

    def _chosen(self, obj: bpy.types.Object, source: bpy.types.Object, is_added: bool) -> range:
        """Numbers of the bands from 0; raises Refusal if they are not there."""
        others = bands_of(source)
        own = others if is_added else bands_of(obj)
        if len(own) != len(others):
            raise Refusal(
                f"it has {len(own)} bands, but {source.name} has {len(others)}; add them instead"
            )
        first, last = sorted((self.first, self.last))
        chosen = range(first - 1, min(last, len(own)))
        if not chosen:
            raise Refusal(f"it has no band {first}")
        missing = [band + 1 for band in chosen if others[band] is None or own[band] is None]
        if missing:
            raise Refusal(f"band {missing[0]} was deleted")
        return chosen


def take_all(layout: bpy.types.UILayout, **how: str) -> None:
    """Draw the button that takes all bands as a decomposition."""
    take = layout.operator(SPECTRAL_TV_OT_take_bands.bl_idname, **how)
    take.first, take.last, take.into = 1, MOST, "ADD"


def source_of_bands(context: bpy.types.Context) -> bpy.types.Object:
    """The one other selected object; raises Refusal if there is not one."""
    others = [obj for obj in context.selected_objects if obj != context.active_object]
    if len(others) != 1:
        raise Refusal("select the one object whose bands it takes, and then this one")
    return others[0]


def _replace(
    obj: bpy.types.Object,
    source: bpy.types.Object,
    chosen: range,
    way: "corresponding.SameVertices | corresponding.NearestSurface",
) -> None:
    """Have the chosen bands of the source act in the place of those of the object."""
    own, others = bands_of(obj), bands_of(source)
    displacement = keeping_of(record_of(source)).displacement
    names = []
    with whole(obj):
        for band in chosen:
            piece = Piece("KEY", way.vectors(displacement(others[band])))
            taken = {f"{source.name} {others[band].name}": piece}
            results.mute_kept(obj, corresponding.TAKEN, str(band + 1))
            # One that was taken in its place before goes.
            names += results.write(
                obj,
                corresponding.TAKEN,
                str(band + 1),
                taken,
                lambda _: True,
                lambda _source, label: (label, ""),
            )
    for name, band in zip(names, chosen, strict=True):
        key = obj.data.shape_keys.key_blocks[name]
        # Where the band is masked, it stays, and nothing takes its place.
        key.value, key.vertex_group = 1.0, own[band].vertex_group
        if masks.mask_group(obj, key) is None and masks.mask(obj, own[band]).min() < 1:
            note(f"{name!r} acts everywhere: the mask of {own[band].name!r} is no vertex group")
    left = [others[band].name for band in chosen if masks.mask(source, others[band]).min() < 1]
    if left and isinstance(way, corresponding.NearestSurface):
        note(f"masks of {source.name} are not taken where bands replace others: {listed(left)}")
    values = [key.value if key is not None else 0.0 for key in own]
    for band in chosen:
        values[band] = -1.0
    set_values(obj, values)
