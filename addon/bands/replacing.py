"""Which decomposition a new one takes the place of."""

from collections.abc import Iterable, Sequence

import bpy
from spectral_tv.bands.settings import ON_NEW_OBJECT, Settings
from spectral_tv.refusal import Refusal

from ..scene.decomposition import SpectralTVRecord
from ..scene.keeping import Band
from ..scene.records import bands_of, record_of


def replaced(obj: bpy.types.Object, settings: Settings) -> SpectralTVRecord | None:
    """The decomposition whose place a new one takes; None if it is added.

    It is the active one, if it was made by the same method, unless any is replaced, and has the
    vertices that there are.
    """
    record = record_of(obj)
    if settings.into == "ADD" or settings.shape in ON_NEW_OBJECT or record is None:
        return None
    if record.vertex_count != len(obj.data.vertices):
        return None
    is_alike = settings.into == "REPLACE_ANY" or record.method == settings.method
    return record if is_alike else None


def why_not(obj: bpy.types.Object, settings: Settings) -> str:
    """What the active decomposition is, where it stays."""
    if settings.shape in ON_NEW_OBJECT:
        return "not of the new object"
    return "of another method" if record_of(obj).method != settings.method else "of other vertices"


def replaced_identifiers(objects: Iterable[bpy.types.Object], settings: Settings) -> list[str]:
    """Those of the decompositions whose places would be taken, "" where none would."""
    found = [replaced(obj, settings) for obj in objects]
    return ["" if record is None else record.identifier for record in found]


def check_replaced(
    objects: Sequence[bpy.types.Object], settings: Settings, identifiers: Sequence[str]
) -> None:
    """Raise Refusal if other decompositions would be replaced than when the work began."""
    if replaced_identifiers(objects, settings) != [*identifiers]:
        raise Refusal("nothing was written, as another decomposition became active meanwhile")


def replaced_bands(obj: bpy.types.Object, settings: Settings) -> list[Band]:
    """Its bands, which are no part of the shape that is decomposed anew."""
    record = replaced(obj, settings)
    return [] if record is None else [band for band in bands_of(obj, record) if band is not None]
