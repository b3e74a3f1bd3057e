"""The decompositions that a mesh remembers, and which shape keys their bands are today."""

from collections.abc import Iterator
from itertools import islice
from typing import Any

import bpy
from spectral_tv.later import uuid
from spectral_tv.refusal import Refusal

from . import keeping
from .contents import topology_digest
from .decomposition import LABEL, SpectralTVRecord
from .fingerprints import Likeness, digests
from .property_values import set_values_of, values_of


def records_of(obj: bpy.types.Object | None) -> list[SpectralTVRecord]:
    """The records of a mesh object's decompositions; those of files of old, of one, as well."""
    if obj is None or obj.type != "MESH":
        return []
    kept = obj.data.spectral_tv
    found = [each for each in (kept.decomposition, *kept.decompositions) if _is_there(each)]
    keys = obj.data.shape_keys
    if keys is not None and keys.spectral_tv.bands:  # of 0.1.0
        found.insert(0, keys.spectral_tv)
    return found


def record_of(obj: bpy.types.Object | None) -> SpectralTVRecord | None:
    """The record of the active decomposition of a mesh object, or None."""
    found = records_of(obj)
    if not found:
        return None
    kept = obj.data.spectral_tv
    chosen = kept.decompositions[kept.active_decomposition :][:1]
    return chosen[0] if chosen and chosen[0] in found else found[-1]


def chosen_record(obj: bpy.types.Object, name: str) -> SpectralTVRecord:
    """The record of that name, or of the active decomposition if it is ""; raises Refusal."""
    if not name:
        return record_of(obj)
    for record in records_of(obj):
        if record.name == name:
            return record
    raise Refusal(f"it has no decomposition {name!r}")


def activate(mesh: bpy.types.Mesh, name: str) -> bool:
    """Make the decomposition of a name the active one; tells whether there is one."""
    place = mesh.spectral_tv.decompositions.find(name)
    if place >= 0:
        mesh.spectral_tv.active_decomposition = place
    return place >= 0


def keeping_of(record: SpectralTVRecord) -> "keeping.Keeping":
    """Where its bands are kept."""
    return keeping.PLACES[record.kept]


def _mark(record: SpectralTVRecord) -> str:
    return record.mark or record.identifier


def _is_there(record: SpectralTVRecord) -> bool:
    """Whether it has bands, and what kept them still is what it was."""
    return bool(record.bands) and keeping_of(record).is_marked(record.id_data, _mark(record))


def keep_in(obj: bpy.types.Object, record: SpectralTVRecord, kind: str) -> None:
    """Have the bands of a record be kept in a place of that name, where they are by now."""
    record.kept = kind
    others = [_mark(each) for each in records_of(obj) if each.kept == kind and each != record]
    record.mark = others[0] if others else record.identifier
    keeping_of(record).mark(obj.data, record.mark)


def new_identity(obj: bpy.types.Object, record: SpectralTVRecord) -> None:
    """Have a record be of no flow so far, and of the vertices and faces that there are."""
    former = [_mark(each) for each in records_of(obj) if each.kept == record.kept]
    record.identifier = uuid.uuid4().hex
    if record.id_data == obj.data:
        record.mark = former[0] if former else record.identifier
        keeping_of(record).mark(obj.data, record.mark)
    record.topology = topology_digest(obj.data)
    record.vertex_count = len(obj.data.vertices)
    record.corner_count = len(obj.data.loops)


def add_record(obj: bpy.types.Object) -> SpectralTVRecord:
    """A new record, the active one, without bands so far.

    Records that were at hand before are elsewhere now.
    """
    kept = obj.data.spectral_tv
    record = kept.decompositions.add()
    kept.active_decomposition = len(kept.decompositions) - 1
    return record


def remove_record(obj: bpy.types.Object, name: str) -> None:
    """Remove the record of a name; another one becomes active if it was.

    Records that were at hand before are elsewhere now.
    """
    kept = obj.data.spectral_tv
    place, active = kept.decompositions.find(name), kept.active_decomposition
    kept.decompositions.remove(place)
    least = min(active, len(kept.decompositions) - 1)
    kept.active_decomposition = max(active - 1 if place < active else least, 0)
    obj.data.update_tag()


def adopt(mesh: bpy.types.Mesh) -> None:
    """Put the record of a file of old, where a mesh has one, into the list."""
    kept, keys = mesh.spectral_tv, mesh.shape_keys
    if keys is not None and keys.spectral_tv.bands:  # of 0.1.0
        values = values_of(keys.spectral_tv)
        keys.spectral_tv.bands.clear()
        keys.spectral_tv.spectrum.clear()
        _add(mesh, values)
    if _is_there(kept.decomposition):
        values = values_of(kept.decomposition)
        kept.property_unset("decomposition")
        _add(mesh, values)


def adopt_all() -> None:
    """Do so for all meshes of this file."""
    for mesh in bpy.data.meshes:
        if mesh.library is None and mesh.override_library is None:
            adopt(mesh)


def _add(mesh: bpy.types.Mesh, values: dict[str, Any]) -> None:
    """Add a record of old to the list, and give it a name."""
    kept = mesh.spectral_tv
    record = kept.decompositions.add()
    kept.active_decomposition = len(kept.decompositions) - 1
    set_values_of(record, values)
    record.mark = _mark(record)
    names = [band.given or band.key for band in record.bands]
    stems = [name.partition(LABEL)[0] for name in names if LABEL in name]
    for number, (band, name) in enumerate(zip(record.bands, names, strict=True), start=1):
        # 0.1.0 did not keep what a band was called first.
        if stems and name == f"{stems[0]}{LABEL}{number}":
            band.given = name
    record.name = stems[0] if stems else record.method


def forget(mesh: bpy.types.Mesh) -> None:
    """Clear all records of a mesh, as their bands are no bands any more."""
    kept = mesh.spectral_tv
    for name in ("decomposition", "decompositions", "active_decomposition"):
        kept.property_unset(name)
    if mesh.shape_keys is not None:
        mesh.shape_keys.spectral_tv.bands.clear()
        mesh.shape_keys.spectral_tv.spectrum.clear()
    mesh.update_tag()


def forget_stale(*_arguments: object) -> None:
    """Clear the records of bands that were all removed, which Blender tells nobody."""
    for mesh in bpy.data.meshes:
        if mesh.library is not None or not mesh.is_property_set("spectral_tv"):
            continue
        kept = mesh.spectral_tv
        if kept.decomposition.bands and not _is_there(kept.decomposition):
            kept.property_unset("decomposition")
            mesh.update_tag()
        for place in reversed(range(len(kept.decompositions))):
            if not _is_there(kept.decompositions[place]):
                kept.decompositions.remove(place)
                kept.active_decomposition = max(len(kept.decompositions) - 1, 0)
                mesh.update_tag()


def bands_of(
    obj: bpy.types.Object, record: SpectralTVRecord | None = None
) -> "list[keeping.Band | None]":
    """The bands of a decomposition, None for those that were deleted; of the active one if none is
    named."""
    record = record_of(obj) if record is None else record
    there = keeping_of(record).all(obj)
    return [there[name] if name else None for name, _ in recognise_bands(obj, record)]


def band_of(obj: bpy.types.Object, number: int) -> "keeping.Band":
    """A band of the active decomposition, 1 being the finest; raises Refusal if it is not there."""
    found = bands_of(obj)
    if number > len(found):
        raise Refusal(f"it has no band {number}, but {len(found)} bands")
    band = found[number - 1]
    if band is None:
        raise Refusal(f"band {number} was deleted")
    return band


def all_bands_of(obj: bpy.types.Object) -> "list[keeping.Band]":
    """The bands of all decompositions that are there."""
    found = []
    for record, likes in recognise_all(obj):
        there = keeping_of(record).all(obj)
        found += [there[name] for name, _ in likes if name]
    return found


def bands_shown(
    obj: bpy.types.Object, record: SpectralTVRecord | None = None
) -> "list[keeping.Band | None]":
    """What `bands_of` gives, for panels, which ask at every redraw: known again only when names
    change."""
    record = record_of(obj) if record is None else record
    there = keeping_of(record).all(obj)
    identifiers = (each.identifier for each in records_of(obj))
    question = (obj.data.session_uid, *identifiers, *there.keys())
    if question not in _shown:
        _shown.clear()
        found = recognise_all(obj)
        _shown[question] = {each.identifier: [name for name, _ in names] for each, names in found}
    return [there[name] if name else None for name in _shown[question][record.identifier]]


def all_bands_shown(obj: bpy.types.Object) -> "list[keeping.Band]":
    """What `all_bands_of` gives, for panels."""
    found = (bands_shown(obj, record) for record in records_of(obj))
    return [band for bands in found for band in bands if band is not None]


# The last answer.
_shown: dict[tuple, dict[str, list[str]]] = {}


def recognise_all(
    obj: bpy.types.Object,
) -> list[tuple[SpectralTVRecord, list[tuple[str, Likeness]]]]:
    """Of every decomposition the name of every band today, "" if it was deleted; and how like the
    band it is. No key is a band of two."""
    records = records_of(obj)
    found = []
    for place in dict.fromkeys(keeping_of(each) for each in records):
        own = [each for each in records if keeping_of(each) == place]
        likes: Iterator = iter(place.recognise(obj, own))
        found += [(each, list(islice(likes, len(each.bands)))) for each in own]
    return found


def recognise_bands(
    obj: bpy.types.Object, record: SpectralTVRecord | None = None
) -> list[tuple[str, Likeness]]:
    """The same of one decomposition, of the active one if none is named."""
    record = record_of(obj) if record is None else record
    return next(likes for each, likes in recognise_all(obj) if each == record)


def renew_bands(obj: bpy.types.Object) -> None:
    """Follow what bands are called today, and what rounding made of them."""
    for record in records_of(obj):
        keeping_of(record).follow_names(obj, record)
    for record, likes in recognise_all(obj):
        written = keeping_of(record).written
        for band, (name, likeness) in zip(record.bands, likes, strict=True):
            is_same = likeness == Likeness.SAME
            if is_same and (name, digests(obj, written, [name])[name]) != (band.key, band.digest):
                band.take(obj, written, name)


def topology_changed(obj: bpy.types.Object, record: SpectralTVRecord | None = None) -> bool:
    """Whether bands are of no use any more, as vertices or faces were added or removed since a
    decomposition, the active one if none is named. Bands that are attributes are carried along."""
    record = record_of(obj) if record is None else record
    return keeping_of(record).written == "KEY" and counts_differ(obj, record)


def place_refusal(obj: bpy.types.Object) -> str | None:
    """Why bands of an object can neither come nor go, where they are; None if they can."""
    reasons = (keeping_of(each).refusal(obj) for each in records_of(obj))
    return next((reason for reason in reasons if reason is not None), None)


def counts_differ(obj: bpy.types.Object, record: SpectralTVRecord) -> bool:
    """Whether vertices or faces were added or removed since a decomposition."""
    counts = len(obj.data.vertices), len(obj.data.loops)
    return counts != (record.vertex_count, record.corner_count)
