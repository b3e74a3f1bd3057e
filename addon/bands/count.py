"""The number of bands: the flow of an object cut anew, in their places, as one changes a field."""

import sys

import bpy
from bpy.props import IntProperty
from spectral_tv.bands.settings import Settings
from spectral_tv.options.declaring import options_of

from ..job.operator import REFUSALS
from ..scene.decomposition import SpectralTVRecord
from ..scene.objects import user_of
from ..scene.records import record_of, renew_bands
from . import adding, remarks
from .set_bands import cut_refusal

OPTION = options_of(Settings)["bands"]


class SpectralTVCount(bpy.types.PropertyGroup):
    """Into how many bands the active decomposition of a mesh is cut."""

    owner = bpy.types.Mesh, "spectral_tv_count"

    def _get(self) -> int:
        record = record_of(user_of(self.id_data))
        return 1 if record is None else len(record.bands)

    def _set(self, count: int) -> None:
        obj = user_of(self.id_data)
        reason = cut_refusal(obj)
        if reason is None:
            try:
                take_count(obj, count)
            except REFUSALS as error:
                reason = str(error)
        if reason is not None:  # the field is greyed then, so it was a script
            sys.stderr.write(f"Bands of {self.id_data.name!r} stay as they are: {reason}\n")

    bands: IntProperty(
        name=OPTION.label,
        description="Number of bands of the active decomposition. Another one cuts the same flow "
        "anew; the new bands take over what was set of the present ones",
        min=OPTION.least,
        max=OPTION.most,
        options=set(),
        get=_get,
        set=_set,
    )


def take_count(obj: bpy.types.Object, count: int) -> None:
    """Cut the bands of an object into so many, or as many as its flow has components.

    Raises Refusal as `flow_of`.
    """
    record = record_of(obj)
    count = min(count, most_bands(record))
    if count == len(record.bands):
        return
    renew_bands(obj)
    with remarks.remarked(obj.data, "count", lambda: state(record_of(obj))):
        adding.cut_again(obj, count)


def most_bands(record: SpectralTVRecord) -> int:
    """How many bands its flow can be cut into."""
    return len(record.kept_spectrum)


def state(record: SpectralTVRecord) -> tuple:
    """What a remark on the number of bands is about."""
    return record.identifier, tuple(band.key for band in record.bands)
