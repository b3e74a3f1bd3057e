"""A decomposition written as bands, beside those that there are or in the place of one of them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from itertools import pairwise
from typing import Any

import bpy
import spectral_tv
from spectral_tv.bands.settings import Settings
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import about, listed, note

from ..scene import masks
from ..scene.decomposition import SpectralTVRecord
from ..scene.fingerprints import Likeness
from ..scene.keeping import PLACES, Band
from ..scene.names import free_name, taken_names
from ..scene.naming import band_names, free_stem
from ..scene.places import world_scale
from ..scene.records import (
    add_record,
    adopt,
    forget_stale,
    keeping_of,
    new_identity,
    recognise_bands,
    record_of,
)
from ..scene.surface import Surface
from ..scene.whole import whole
from . import heights
from .bands import Flow, displacements, flow_of, keep_flow, settings_of, source_of
from .converting import convert
from .overlap import Overlap, overlap_of_flows
from .recut import Former, Recut
from .replacing import replaced
from .solo import end_solo

# What the name of a band has in addition that was sculpted, where a new band gets its name.
SCULPTED = "Sculpted"


@dataclass(frozen=True)
class Part:
    """An object, its surface, and the decomposition of that with its arguments."""

    obj: bpy.types.Object
    surface: Surface
    arguments: dict[str, Any]
    split: spectral_tv.Decomposition


def add_bands(parts: Sequence[Part], settings: Settings, name: str = "") -> str:
    """Write decompositions as bands, all or none, and remember them; returns what was done.

    They take the place of active decompositions, or are added; see :func:`replaced`. Those that are
    added have the ``name``, or that of their method if there is none.
    """
    forget_stale()
    with whole(*(part.obj for part in parts)):
        pending = [_Pending.of(part, settings, name, len(parts) > 1) for part in parts]
    for each in pending:
        with about(each.part.obj.name) if len(parts) > 1 else nullcontext():
            each.settle()
    count = len(pending[0].new)
    bands = "1 band" if count == 1 else f"{count} bands"
    former = dict.fromkeys(each.former for each in pending)
    if None in former:
        return f"{bands} of {settings.by.label} added"
    names = listed(repr(name) for name in former)
    verb = "takes" if count == 1 else "take"
    return f"{bands} of {settings.by.label} {verb} the place of those of {names}"


@dataclass(frozen=True)
class _Pending:
    """New bands that are there as keys, but in no record so far.

    ``former`` is the name of the decomposition whose place they will take, ``stem`` that of theirs.
    """

    part: Part
    settings: Settings
    flow: Flow
    edges: np.ndarray
    former: str | None
    stem: str
    new: list[Band]
    is_part: bool

    @classmethod
    def of(cls, part: Part, settings: Settings, name: str, is_part: bool) -> _Pending:
        """Add the keys."""
        adopt(part.obj.data)
        record = replaced(part.obj, settings)
        edges = part.split.band_edges(settings.band_count)
        flow = Flow(part.split, part.surface, source_of(part.surface, part.arguments))
        if record is None:
            _note_kept(part.obj, settings)
            wanted = [name] if name else _usual_names(settings)
            former, stem = None, free_stem(part.obj, wanted, len(edges) - 1)
        else:
            former, stem = record.name, _stem_after(part.obj, record, settings, len(edges) - 1)
        keeping = PLACES[settings.bands_as if record is None else record.kept]
        found = displacements(flow, edges, settings.limbs_kept)
        new = keeping.add(part.obj, band_names(stem, len(edges) - 1), found)
        return cls(part, settings, flow, edges, former, stem, new, is_part)

    def settle(self) -> None:
        """Have a record remember them, and have them take the place of others."""
        obj, settings = self.part.obj, self.settings
        if self.former is None:
            record = add_record(obj)
            record.kept = settings.bands_as
            record.name = self.stem
            names = given = [band.name for band in self.new]
            for band in self.new:
                band.vertex_group = settings.vertex_group
        else:
            record = obj.data.spectral_tv.decompositions[self.former]
            wanted = band_names(self.stem, len(self.new))
            names, given = _take_place(obj, record, self.new, wanted, self._overlap(record))
            record.recipe = record.recipe if record.method == settings.method else ""
            settings = replace(self._mask(settings_of(record)), bands_as=record.kept)
            masks.settle(obj, self.new)
        record.method, record.settings = settings.method, settings.text()
        record.solo, record.area = 0, self.part.surface.mesh.area
        record.scale = world_scale(obj)
        new_identity(obj, record)
        split = self.part.split
        record.keep_spectrum(split.times[1:-1], split.spectrum)
        record.is_part = self.is_part
        record_bands(obj, record, names, given, self.edges)
        if record.name != self.stem:
            heights.hand_over(obj, record.name, self.stem)
            record.name = self.stem
        keep_flow(record.identifier, self.flow)
        if record.kept != self.settings.bands_as:
            convert(obj, record, self.settings.bands_as)
            note(f"its bands are {keeping_of(record).label} now")
        heights.renew(obj, record, self.settings.heights)

    def _overlap(self, record: SpectralTVRecord) -> Overlap:
        """That with the former bands, whose sizes are those of the object then."""
        grown = 1.0  # files of before do not tell
        if record.scale:
            grown = (world_scale(self.part.obj) / record.scale) ** 2
        edges = [0.0, *(grown * band.end for band in record.bands)]
        times = grown * record.kept_spectrum[:, 0], self.part.split.times[1:-1]
        return overlap_of_flows(edges, self.edges, times)

    def _mask(self, before: Settings) -> Settings:
        """The settings with the mask that counts; masks go over unless another one is chosen."""
        own = self.settings.vertex_group
        carried = {band.vertex_group: None for band in self.new if band.vertex_group}
        if not own or own == before.vertex_group:
            if carried and not own:
                note(f"its bands stay limited to {listed(carried)}")
            return replace(self.settings, vertex_group=own or before.vertex_group)
        for band in self.new:
            band.vertex_group = own
        lost = [name for name in carried if name != own]
        if lost:
            note(f"its bands are limited to {own}, no longer to {listed(lost)}")
        return self.settings


def cut_again(obj: bpy.types.Object, count: int, keep_limbs: float | None = None) -> list[str]:
    """Cut the remembered flow into ``count`` bands that take the place of the present ones.

    What was set of these goes over, see :mod:`recut`; those that were sculpted since stay, muted.
    As much of limbs is kept as before, if nothing else is asked for. Raises Refusal as `flow_of`.
    """
    adopt(obj.data)
    record, flow = record_of(obj), flow_of(obj)
    settings = settings_of(record)
    if keep_limbs is not None:
        settings = replace(settings, keep_limbs=keep_limbs)
    edges = flow.split.band_edges(count)
    wanted = band_names(record.name, count)
    new = keeping_of(record).add(obj, wanted, displacements(flow, edges, settings.limbs_kept))
    former = [(band.start, band.end) for band in record.bands]
    overlap = Overlap.of(former, [*pairwise(edges)], flow.split.times[1:-1])
    names, given = _take_place(obj, record, new, wanted, overlap)
    masks.settle(obj, new)
    keeping_of(record).mark(obj.data, record.mark)
    record.settings = settings.text()
    record_bands(obj, record, names, given, edges)
    heights.renew(obj, record, settings.heights)
    return names


def _note_kept(obj: bpy.types.Object, settings: Settings) -> None:
    """Note that a decomposition of vertices that are no more is not replaced."""
    active = record_of(obj)
    is_alike = settings.into == "REPLACE_ANY" or (
        settings.into == "REPLACE" and active is not None and active.method == settings.method
    )
    if active is not None and is_alike:
        note(f"{active.name!r} is of other vertices, so it stays beside the new one")


def _usual_names(settings: Settings) -> list[str]:
    """What a decomposition is called, if nobody else is."""
    label, mask = settings.by.label, settings.vertex_group
    return [label, f"{label} {mask}"] if mask else [label]


def _stem_after(
    obj: bpy.types.Object, record: SpectralTVRecord, settings: Settings, count: int
) -> str:
    """What a decomposition is called that takes the place of another one: as that, unless this
    merely has the name of another method."""
    before = settings_of(record)
    own = "|".join(map(re.escape, _usual_names(before)))
    if record.method == settings.method or not re.fullmatch(rf"({own})( \d+)?", record.name):
        return record.name
    keys = [band.key for band in record.bands]
    return free_stem(obj, _usual_names(settings), count, record, keys)


def _take_place(
    obj: bpy.types.Object,
    record: SpectralTVRecord,
    new: list[Band],
    wanted: list[str],
    overlap: Overlap,
) -> tuple[list[str], list[str]]:
    """Have new bands take the place of those of a record; returns their present names, and the
    names that they were given."""
    end_solo(obj, record)
    keeping = keeping_of(record)
    there = keeping.all(obj)
    usual = band_names(record.name, len(record.bands))
    old = []
    likes = recognise_bands(obj, record)
    for band, (name, likeness), own in zip(record.bands, likes, usual, strict=True):
        # Files of 0.1.0 do not tell what a band was called.
        key, given = there[name] if name else None, band.given or own
        is_changed = likeness == Likeness.CHANGED
        if is_changed and name == given:  # which a new band gets
            given = free_name(name, SCULPTED, taken_names(obj, keeping.written))
            keeping.rename(obj, key, given)
        if is_changed:
            as_what = f" as {given!r}" if given != name else ""
            note(f"{name!r} was sculpted since; it stays{as_what}, muted, and is no longer a band")
        old.append(Former(key, is_changed, given))
    if all(each.band is None for each in old):
        for band in new:
            band.vertex_group = settings_of(record).vertex_group
    return Recut(obj, keeping, old, new, wanted, overlap).take_place()


def record_bands(
    obj: bpy.types.Object,
    record: SpectralTVRecord,
    names: list[str],
    given: list[str],
    edges: np.ndarray,
) -> None:
    """Link a record to the bands between ``edges``, and to the names that they were given."""
    record.bands.clear()
    for name, first, (start, end) in zip(names, given, pairwise(edges), strict=True):
        band = record.bands.add()
        band.take(obj, keeping_of(record).written, name)
        band.given, band.start, band.end = first, start, end
