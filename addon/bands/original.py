"""The original beside the look: the bands of all decompositions are muted for a while.

Each band remembers whether it was muted. So a solo, and mutes of the user, are as before
afterwards.
"""

from collections.abc import Iterator

import bpy

from ..scene.decomposition import SpectralTVBand, SpectralTVRecord
from ..scene.keeping import Band
from ..scene.records import bands_of, bands_shown, records_of

REASON = "The original is shown, without its bands; press Show Look first"


def is_shown(obj: bpy.types.Object | None) -> bool:
    """Whether the original is shown; for panels too. It is not, once a band was unmuted."""
    records = [each for each in records_of(obj) if each.shows_original]
    bands = [band for each in records for band in bands_shown(obj, each) if band is not None]
    return bool(records) and all(band.mute for band in bands)


def show(obj: bpy.types.Object) -> None:
    """Mute all bands, and remember which were."""
    end(obj)
    for record in records_of(obj):
        for band, key in _pairs(obj, record):
            band.was_silent = key.mute
            key.mute = True
        record.shows_original = True


def end(obj: bpy.types.Object) -> None:
    """Have the bands be muted or not as they were; what was unmuted meanwhile stays so."""
    for record in records_of(obj):
        if not record.shows_original:
            continue
        for band, key in _pairs(obj, record):
            if key.mute:
                key.mute = band.was_silent
        record.shows_original = False


def _pairs(
    obj: bpy.types.Object, record: SpectralTVRecord
) -> Iterator[tuple[SpectralTVBand, Band]]:
    for band, key in zip(record.bands, bands_of(obj, record), strict=True):
        if key is not None:
            yield band, key
