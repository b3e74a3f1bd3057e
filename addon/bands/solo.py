"""Solo: mutes all bands of a decomposition but one, and remembers which were muted before."""

import bpy

from ..scene.decomposition import SpectralTVBand, SpectralTVRecord
from ..scene.records import band_of, bands_of, record_of


def toggle_solo(obj: bpy.types.Object, number: int) -> None:
    """Mute all bands of the active decomposition but one; if it is alone already, restore them.

    They count from 1. What the user mutes or unmutes meanwhile stays so.
    Raises Refusal if there is no such band.
    """
    record = record_of(obj)
    pairs = _pairs(obj, record)
    band_of(obj, number)
    is_alone = record.solo == number and all(
        key is None or key.mute == (place != number)
        for place, (_, key) in enumerate(pairs, start=1)
    )
    end_solo(obj, record)
    if is_alone:
        return
    for place, (band, key) in enumerate(pairs, start=1):
        band.was_muted = key is not None and key.mute
        if key is not None:
            key.mute = place != number
    record.solo = number


def end_solo(obj: bpy.types.Object, record: SpectralTVRecord) -> None:
    """Give the mutes back that a solo of a decomposition took, if there is one."""
    if not record.solo:
        return
    for place, (band, key) in enumerate(_pairs(obj, record), start=1):
        was_set = place != record.solo
        if key is not None and key.mute == was_set:
            key.mute = band.was_muted
    record.solo = 0


def _pairs(
    obj: bpy.types.Object, record: SpectralTVRecord
) -> list[tuple[SpectralTVBand, bpy.types.ShapeKey | None]]:
    return [*zip(record.bands, bands_of(obj, record), strict=True)]
