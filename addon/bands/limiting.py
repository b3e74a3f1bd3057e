"""A limit on how far bands move any vertex, as masks of the bands.

Each vertex takes such a share of the bands that it is moved by no more than the limit. That
projects what moves it onto a ball, so neighbours move apart by no more than before. The mask that a
band had counts too, and comes back when the limit goes: the label of a written mask is its name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import bpy
from spectral_tv.bands.limits import Limited
from spectral_tv.later import np
from spectral_tv.notes import note

from ..scene import mix, results
from ..scene.decomposition import SpectralTVRecord
from ..scene.keeping import Band
from ..scene.results import Piece
from ..scene.weights import weights_of
from .deviation import matrix_of

# What the masks are written as.
KIND, LABEL = "LIMIT", "Limit"
# Half a unit in the last place of Blender's coordinates, relative to them, and of weights.
ROUNDING = 2.0**-24


def limit(
    obj: bpy.types.Object,
    bands: Sequence[Band],
    length: float,
    records: Sequence[SpectralTVRecord],
) -> Limited | None:
    """Hold bands within a limit at their present values, or let them go if it is 0.

    ``records`` are the decompositions that the bands are of. Object space is measured as the
    objects that share the mesh have it in the world, by the largest. Returns None without a limit.
    """
    before = {band: band.vertex_group for band in bands}
    for band, name in lifted(obj, bands).items():
        band.vertex_group = name
    try:
        parts = [part for part in mix.parts(obj) if part.key in bands] if length > 0 else []
        moved = mix.Moves().of(obj, parts)
        farthest, shares = _shares(obj, moved, length, len(bands))
        source = records[0].identifier if len(records) == 1 else ""
        stem = records[0].name if source else "Movement"
        labels = {part.key.vertex_group for part in parts} if (shares < 1).any() else set()
        pieces = {each: Piece("GROUP", shares * _weights(obj, each)) for each in labels}
        names = results.write(
            obj, KIND, source, pieces, wanted=lambda _source, each: (each or stem, LABEL)
        )
    except BaseException:
        for band, name in before.items():
            band.vertex_group = name
        raise
    by_label = dict(zip(pieces, names, strict=True))
    for part in parts:
        part.key.vertex_group = by_label.get(part.key.vertex_group, part.key.vertex_group)
    sweep(obj)
    for record in records:
        record.limit = length
    obj.data.update_tag()
    if length <= 0:
        return None
    held = int(np.count_nonzero(shares < 1))
    return Limited(length, held, len(shares), farthest, names)


def base_of(obj: bpy.types.Object) -> Callable[[str], str]:
    """What tells of a vertex group the mask that a limit was put on by it: of others themselves."""
    places = results.known(obj, "GROUP")
    kept = obj.data.spectral_tv.results
    bases = {name: kept[place].label for place, name in places.items() if kept[place].kind == KIND}
    return lambda name: bases.get(name, name)


def lifted(obj: bpy.types.Object, bands: Iterable[Band]) -> dict[Band, str]:
    """The masks that bands have without limits, of those that have one."""
    base = base_of(obj)
    found = {}
    for band in bands:
        name = base(band.vertex_group)
        if name == band.vertex_group:
            continue
        if name and name not in obj.vertex_groups:
            note(f"the mask {name!r} that was limited is gone, so {band.name!r} acts everywhere")
            name = ""
        found[band] = name
    return found


def sweep(obj: bpy.types.Object) -> None:
    """Remove the masks of limits that mask nothing any more, unless they were changed."""
    used = {key.vertex_group for key in mix.sliders_of(obj)}
    places = results.known(obj, "GROUP")
    kept = obj.data.spectral_tv.results
    unused = [
        (kept[place].source, kept[place].label)
        for place, name in places.items()
        if kept[place].kind == KIND and name not in used
    ]
    for source in {source for source, _ in unused}:
        labels = {label for each, label in unused if each == source}
        results.write(obj, KIND, source, {}, labels.__contains__)


def held_back(obj: bpy.types.Object, bands: Iterable[Band]) -> int:
    """How many vertices limits hold back of bands, by their masks."""
    base = base_of(obj)
    is_held = np.zeros(len(obj.data.vertices), dtype=bool)
    for name in {band.vertex_group for band in bands}:
        if name in obj.vertex_groups and base(name) != name:
            is_held |= _weights(obj, name) < _weights(obj, base(name)) - ROUNDING
    return int(np.count_nonzero(is_held))


def _shares(
    obj: bpy.types.Object, moved: np.ndarray, length: float, count: int
) -> tuple[float, np.ndarray]:
    """How far the farthest vertex is moved, and the share (V,) that keeps each within the limit.

    Blender adds what ``count`` bands do in single precision; there is room for its rounding.
    """
    users = [each for each in bpy.data.objects if each.data == obj.data]
    matrices = [matrix_of(each) for each in users]
    away = np.max([np.linalg.norm(moved @ each.T, axis=1) for each in matrices], axis=0)
    away = np.nan_to_num(away)  # what is nowhere is not moved
    if length <= 0:
        return 0.0, np.ones(len(away))
    largest = max(np.linalg.norm(each, 2) for each in matrices)
    size = np.abs(mix.shown(obj)).max(axis=1) + np.abs(moved).max(axis=1)
    room = np.sqrt(3) * (count + 2) * ROUNDING * largest * size
    allowed = np.maximum(length - room, 0) * (1 - 4 * ROUNDING)
    shares = np.ones(len(away))
    is_far = away > allowed
    shares[is_far] = allowed[is_far] / away[is_far]
    return float(away.max(initial=0.0)), shares


def _weights(obj: bpy.types.Object, name: str) -> np.ndarray:
    """Those of a mask, (V,); 1 without one."""
    group = obj.vertex_groups.get(name) if name else None
    return np.ones(len(obj.data.vertices)) if group is None else weights_of(obj, group)
