"""Keep Limbs: the bands of an object cut anew in their places, as one drags a slider."""

import sys
from dataclasses import replace

import bpy
from bpy.props import FloatProperty
from spectral_tv.bands.settings import Settings
from spectral_tv.notes import note
from spectral_tv.options.declaring import options_of

from ..scene.fingerprints import Likeness
from ..scene.objects import user_of
from ..scene.records import keeping_of, recognise_bands, record_of
from . import heights
from .bands import Flow, displacements, flow_of, parts_of, settings_of
from .set_bands import cut_refusal

OPTION = options_of(Settings)["keep_limbs"]


class SpectralTVLimbs(bpy.types.PropertyGroup):
    """How much of limbs the bands of a mesh leave."""

    owner = bpy.types.Mesh, "spectral_tv_limbs"

    def _get(self) -> float:
        obj = user_of(self.id_data)
        return 0.0 if record_of(obj) is None else settings_of(record_of(obj)).limbs_kept

    def _set(self, amount: float) -> None:
        obj = user_of(self.id_data)
        reason = cut_refusal(obj)
        if reason is None:
            keep_limbs(obj, amount)
        else:  # the slider is greyed then, so it was a script
            sys.stderr.write(f"Keep Limbs of {self.id_data.name!r} stays as it is: {reason}\n")

    keep: FloatProperty(
        name=OPTION.label,
        description=f"{OPTION.text}. Bands that were sculpted stay as they are",
        min=OPTION.least,
        max=OPTION.most,
        soft_max=OPTION.soft_most,
        precision=OPTION.digits,
        options=set(),
        get=_get,
        set=_set,
    )


def keep_limbs(obj: bpy.types.Object, amount: float) -> None:
    """Cut the bands of an object anew, each in its place, with so much of limbs kept.

    Objects that were decomposed as one with it follow. Bands that were sculpted stay as they are,
    and are noted. Raises Refusal as `flow_of`.
    """
    own, others = flow_of(obj), parts_of(obj)[1:]
    _keep_limbs(obj, own, amount)
    for other in others:
        reason = cut_refusal(other)
        if reason is None:
            _keep_limbs(other, flow_of(other), amount)
        else:
            note(f"{other.name}, of the same surface, is left as it is: {reason}")


def _keep_limbs(obj: bpy.types.Object, flow: Flow, amount: float) -> None:
    record = record_of(obj)
    keeping, there = keeping_of(record), keeping_of(record).all(obj)
    found = displacements(flow, flow.split.band_edges(len(record.bands)), amount)
    rows = zip(record.bands, recognise_bands(obj), found, strict=True)
    for band, (name, likeness), displacement in rows:
        band.is_sculpted = bool(name) and likeness == Likeness.CHANGED
        if band.is_sculpted:
            note(f"{name!r} was sculpted since; it stays as it is")
        elif name:
            keeping.set(obj, there[name], displacement)
            band.take(obj, keeping.written, name)
    settings = replace(settings_of(record), keep_limbs=amount)
    record.settings = settings.text()
    heights.renew(obj, record, settings.heights)
