"""What decompositions and their bands are called: ``Skin``, and ``Skin Band 1`` and so on."""

from collections.abc import Callable, Iterable
from itertools import chain, count

import bpy

from .decomposition import LABEL, NAMED, SpectralTVRecord
from .masks import fit_names
from .names import LONGEST, free_name, taken_names
from .objects import user_of
from .records import bands_of, keeping_of, recognise_bands, records_of

# What a decomposition is called that was given no name.
NAMELESS = "Bands"


def band_names(stem: str, number: int) -> list[str]:
    """What so many bands of a decomposition are called."""
    return [free_name(stem, f"{LABEL.strip()} {band}", ()) for band in range(1, number + 1)]


def free_stem(
    obj: bpy.types.Object,
    wanted: Iterable[str],
    number: int,
    own: SpectralTVRecord | None = None,
    except_keys: Iterable[str] = (),
) -> str:
    """The first of the wanted names, or of these with numbers, that no other decomposition has, and
    no key or attribute but ``except_keys`` has of ``number`` bands of it."""
    decompositions = {each.name for each in obj.data.spectral_tv.decompositions if each != own}
    keys = (taken_names(obj, "KEY") | taken_names(obj, "ATTRIBUTE")) - {*except_keys}
    first, *others = wanted
    room = LONGEST - len(f"{LABEL}{number}".encode())

    def is_free(name: str) -> bool:
        return name not in decompositions and keys.isdisjoint(band_names(name, number))

    numbered = (free_name(first, str(index), ()) for index in count(2))
    names: Iterable[str] = chain((first, *others), numbered)
    return next(name for name in map(_fitting(room), names) if is_free(name))


def _fitting(room: int) -> Callable[[str], str]:
    """A function that cuts names that are too long."""

    def fitting(name: str) -> str:
        return name.encode()[:room].decode(errors="ignore").rstrip()

    return fitting


def _rename_bands(record: SpectralTVRecord) -> None:
    """Have bands follow the name of their decomposition, but for those that were renamed."""
    mesh = record.id_data
    obj = user_of(mesh) if isinstance(mesh, bpy.types.Mesh) else None
    if obj is None or record not in records_of(obj):
        return
    keeping = keeping_of(record)
    there = keeping.all(obj)
    found = [name for name, _ in recognise_bands(obj, record)]
    pairs = zip(record.bands, found, strict=True)
    own = [name for band, name in pairs if name and name == band.given]
    wanted = [record.name.strip() or NAMELESS]
    free = free_stem(obj, wanted, len(record.bands), record, own)
    if free != record.name:
        record.name = free  # which comes here again
        return
    for band, name, given in zip(record.bands, found, band_names(free, len(found)), strict=True):
        if name in own and name != given:
            keeping.rename(obj, there[name], given)
            band.given = band.key = given
    keeping.call([band for band in bands_of(obj, record) if band is not None], free)
    fit_names(obj, [band for band in bands_of(obj, record) if band is not None])


NAMED.append(_rename_bands)
