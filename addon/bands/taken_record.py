"""Bands of one object as a decomposition of another."""

from dataclasses import replace

import bpy
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..scene import masks
from ..scene.names import free_name
from ..scene.naming import band_names, free_stem
from ..scene.places import world_scale
from ..scene.records import (
    add_record,
    adopt,
    bands_of,
    forget_stale,
    keeping_of,
    new_identity,
    record_of,
)
from ..scene.whole import whole
from .adding import record_bands
from .bands import settings_of
from .corresponding import NearestSurface, SameVertices


def add_taken(
    obj: bpy.types.Object,
    source: bpy.types.Object,
    chosen: range,
    way: SameVertices | NearestSurface,
) -> str:
    """Add the chosen bands of the active decomposition of ``source`` as one of ``obj``, which
    becomes the active one. It has their values, masks and settings; returns its name.

    Raises Refusal if they cannot be kept as they are.
    """
    forget_stale()
    adopt(obj.data)
    model = record_of(source)
    keeping = keeping_of(model)
    reason = keeping.refusal(obj)
    if reason is not None:
        raise Refusal(reason[0].lower() + reason[1:])
    models = [bands_of(source, model)[band] for band in chosen]
    wanted = [model.name, free_name(source.name, model.name, ())]
    stem = free_stem(obj, wanted, len(chosen))
    reached = [masks.mask(source, band) for band in models]
    with whole(obj):
        moved = (way.vectors(keeping.displacement(band)) for band in models)
        bands = keeping.add(obj, band_names(stem, len(chosen)), moved)
    record = add_record(obj)
    record.kept, record.name = model.kept, stem
    settings = replace(
        settings_of(model), bands=len(chosen), vertex_group="", into="ADD", bands_as=model.kept
    )
    record.method, record.settings, record.recipe = model.method, settings.text(), model.recipe
    record.area, record.scale = way.area, world_scale(obj)
    new_identity(obj, record)
    times, strengths = model.kept_spectrum.T
    record.keep_spectrum(times * way.scale**2, strengths * way.scale**3)
    first, last = model.bands[chosen[0]], [model.bands[band].end for band in chosen]
    edges = way.scale**2 * np.array([first.start, *last])
    names = [band.name for band in bands]
    record_bands(obj, record, names, names, edges)
    keyed = []
    for band, like, weights in zip(bands, models, reached, strict=True):
        band.slider_min, band.slider_max = like.slider_min, like.slider_max
        band.value, band.mute = like.value, like.mute
        if weights.min() < 1:
            masks.give(obj, band, way.values(weights))
        if keeping.animation_of(like, "value"):
            keyed.append(like.name)
    if keyed:
        note(f"the animation of {', '.join(keyed)} is not taken, but the values on this frame")
    return record.name
