"""Results of functions on a mesh: written beside their source, over the results of the last time.

A mesh remembers the results of each source, with their fingerprints. What still has its fingerprint
is ours, and is written over whatever its name is today. What the user changed, locked or made is
the user's: it stays, and the result is written beside it.
"""

from collections.abc import Callable, Collection, Mapping
from types import MappingProxyType

import bpy
from bpy.props import BoolProperty, CollectionProperty, IntProperty, PointerProperty, StringProperty
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from . import shape_keys
from .contents import TYPES
from .decomposition import SpectralTVRecord
from .documents import SpectralTVDocument
from .fingerprints import Fingerprint, Likeness, digests, names, recognise
from .masks import SpectralTVMask
from .names import free_name, taken_names
from .weights import add_group, set_weights
from .whole import whole

# Blender's own attributes that end it where they are of another type; 5.2 refuses none of them.
OF_ONE_TYPE = {"material_index", "sharp_edge", "uv_seam"}
THINGS = {"KEY": "shape key", "GROUP": "vertex group", "ATTRIBUTE": "attribute"}
# Kinds of results that others ask for: the parts of a mesh, and their connected parts.
SEGMENTS, PARTS = "SEGMENTS", "PARTS"


class SpectralTVResult(Fingerprint, bpy.types.PropertyGroup):
    """One thing that was written."""

    kind: StringProperty(name="Kind", description="Of the source")
    source: StringProperty(name="Source")
    label: StringProperty(name="Label", description="What it is of the source")
    written: StringProperty(name="Written", description="As an attribute, a group or a key")


class SpectralTVMesh(bpy.types.PropertyGroup):
    """What a mesh remembers of what was written on it and of it."""

    owner = bpy.types.Mesh, "spectral_tv", "LIBRARY_OVERRIDABLE"

    decompositions: CollectionProperty(type=SpectralTVRecord, override={"LIBRARY_OVERRIDABLE"})
    active_decomposition: IntProperty(
        name="Active Decomposition",
        description="The one whose bands are shown and set",
        min=0,
        override={"LIBRARY_OVERRIDABLE"},
    )
    # Of files from before there were several.
    decomposition: PointerProperty(type=SpectralTVRecord, override={"LIBRARY_OVERRIDABLE"})
    results: CollectionProperty(type=SpectralTVResult)
    masks: CollectionProperty(type=SpectralTVMask)
    table: PointerProperty(type=bpy.types.Text, name="Table", description="Of values over time")
    picture: PointerProperty(type=bpy.types.Image, name="Picture", description="Of the same")
    accuracy: PointerProperty(type=bpy.types.Text, name="Accuracy", description="Of its bands")
    deviation: PointerProperty(type=bpy.types.Text, name="Deviation", description="By its bands")
    shows_deviation: BoolProperty(
        name="Show Deviation",
        description="Show in color how far the bands of all decompositions move the surface: "
        "outwards in red, inwards in blue. It follows the sliders",
        override={"LIBRARY_OVERRIDABLE"},
    )
    documents: CollectionProperty(type=SpectralTVDocument)


@dataclass(frozen=True)
class Piece:
    """One thing to write: a KEY's displacements (V, 3), a GROUP's weights (V,), or an ATTRIBUTE of
    a type that :data:`TYPES` has, on vertices or as ``domain`` says."""

    written: str
    values: "np.ndarray"
    data_type: str = ""
    domain: str = "POINT"


def write(
    obj: bpy.types.Object,
    kind: str,
    source: str,
    pieces: Mapping[str, Piece],
    stale: Callable[[str], bool] = lambda _label: False,
    wanted: Callable[[str, str], tuple[str, str]] = lambda source, label: (source, label),
    over: Mapping[str, str] = MappingProxyType({}),
) -> list[str]:
    """Write pieces, by their labels, as ``source`` ``label``; all or none. Returns their names.

    ``wanted`` makes of the source and a label the two parts of a name. What was written of the
    source before under a label that is ``stale``, and is not written again, is removed. ``over``
    names, by label, what is written over whatever it holds.
    """
    concerned = {*pieces} - {*over}
    found = _own(obj, kind, source, lambda label: label in concerned or stale(label))
    targets = dict(over)
    with whole(obj):
        for label, piece in pieces.items():
            if label not in over:
                name = found.get((label, piece.written))
                targets[label] = name or _add(obj, piece, *wanted(source, label))
    for label, piece in pieces.items():
        _fill(obj, piece, targets[label])
    for (label, written), name in found.items():
        if stale(label) and name not in targets.values():
            _remove(obj, written, name)
    results = obj.data.spectral_tv.results
    for place in reversed(range(len(results))):
        each = results[place]
        is_again = each.label in pieces and each.written == pieces[each.label].written
        if (each.kind, each.source) == (kind, source) and (is_again or stale(each.label)):
            results.remove(place)
    for label, piece in pieces.items():
        each = results.add()
        each.kind, each.source, each.label, each.written = kind, source, label, piece.written
        each.take(obj, piece.written, targets[label])
    obj.data.update_tag()
    return [targets[label] for label in pieces]


def groups_shown(obj: bpy.types.Object, kind: str) -> list[str]:
    """Vertex groups of a kind that are there under their names, for panels."""
    records = [each for each in obj.data.spectral_tv.results if each.written == "GROUP"]
    return [each.key for each in records if each.kind == kind and each.key in obj.vertex_groups]


def written_names(obj: bpy.types.Object, written: str) -> list[str]:
    """Names today of the KEYs, GROUPs or ATTRIBUTEs that were written, changed since or not."""
    records = [each for each in obj.data.spectral_tv.results if each.written == written]
    present = names(obj, written)
    known = zip(records, recognise(obj, written, records), strict=True)
    return [name or each.key for each, (name, _) in known if (name or each.key) in present]


def follow(obj: bpy.types.Object) -> Callable[[], None]:
    """Note which results are there; the function returned takes their fingerprints anew."""
    was = [pair for written in THINGS for pair in known(obj, written).items()]

    def renew() -> None:
        for place, name in was:
            each = obj.data.spectral_tv.results[place]
            each.take(obj, each.written, name)

    return renew


def hand_on(obj: bpy.types.Object, copy: bpy.types.Object) -> None:
    """Have a copy with other vertices know its groups and attributes that are ``obj``'s results."""
    results = obj.data.spectral_tv.results
    for written in ("GROUP", "ATTRIBUTE"):
        there = names(copy, written)
        found = {place: name for place, name in known(obj, written).items() if name in there}
        fresh = digests(copy, written, [*found.values()]) if found else {}
        for place, name in found.items():
            each = copy.data.spectral_tv.results.add()
            for field in ("kind", "source", "label", "written"):
                setattr(each, field, getattr(results[place], field))
            each.key, each.digest = name, fresh[name]


def known(obj: bpy.types.Object, written: str) -> dict[int, str]:
    """Which of the written KEYs, GROUPs or ATTRIBUTEs are there unchanged.

    By their places in the record, with their names today.
    """
    results = obj.data.spectral_tv.results
    places = [place for place, each in enumerate(results) if each.written == written]
    likes = recognise(obj, written, [results[place] for place in places])
    pairs = zip(places, likes, strict=True)
    return {place: name for place, (name, likeness) in pairs if likeness == Likeness.SAME}


def mute_kept(obj: bpy.types.Object, kind: str, source: str) -> None:
    """Mute the shape keys of a source that `write` keeps beside those that it writes anew, as both
    would act."""
    for each, key, likeness in keys_written(obj, kind):
        is_kept = likeness != Likeness.SAME or key.lock_shape
        if each.source == source and is_kept and not key.mute:
            key.mute = True
            note(f"{key.name!r} is muted, as a new one acts in its place")


def keys_written(
    obj: bpy.types.Object, kind: str
) -> list[tuple[SpectralTVResult, bpy.types.ShapeKey, Likeness]]:
    """The shape keys that were written of a kind of source and are there, changed since or not."""
    own = [each for each in obj.data.spectral_tv.results if each.written == "KEY"]
    own = [each for each in own if each.kind == kind]
    if not own or obj.data.shape_keys is None:
        return []
    there = obj.data.shape_keys.key_blocks
    likes = zip(own, recognise(obj, "KEY", own), strict=True)
    found = [(each, there.get(name or each.key), likeness) for each, (name, likeness) in likes]
    return [(each, key, likeness) for each, key, likeness in found if key is not None]


def release(obj: bpy.types.Object, spent: Collection[SpectralTVResult]) -> None:
    """Have things that were written be the user's."""
    kept = obj.data.spectral_tv.results
    for place in reversed([place for place, each in enumerate(kept) if each in spent]):
        kept.remove(place)


def _own(
    obj: bpy.types.Object, kind: str, source: str, concerned: Callable[[str], bool]
) -> dict[tuple[str, str], str]:
    """By label and what it is, the names of what was written of a source and is ours still.

    What is no longer is noted, if its label is ``concerned``.
    """
    there: dict[str, dict[int, str]] = {}
    found = {}
    for place, each in enumerate(obj.data.spectral_tv.results):
        if (each.kind, each.source) != (kind, source) or not concerned(each.label):
            continue
        if each.written not in there:
            there[each.written] = known(obj, each.written)
        name = there[each.written].get(place, "")
        thing = THINGS[each.written]
        if not name and each.key in names(obj, each.written):
            note(f"the {thing} {each.key!r} was changed since, and is kept")
        elif name and _is_locked(obj, each.written, name):
            note(f"the {thing} {name!r} is locked, and is kept")
        elif name:
            found[each.label, each.written] = name
            if name != each.key:
                note(f"the {thing} {name!r} is written over: it was {each.key!r}")
    return found


def _is_locked(obj: bpy.types.Object, written: str, name: str) -> bool:
    if written == "GROUP":
        return obj.vertex_groups[name].lock_weight
    return written == "KEY" and obj.data.shape_keys.key_blocks[name].lock_shape


def _add(obj: bpy.types.Object, piece: Piece, stem: str, label: str) -> str:
    """Add what a piece will be written into, and return its name."""
    name = free_name(stem, label, taken_names(obj, piece.written))
    if piece.written == "KEY":
        (key,) = shape_keys.add_displacements(obj, [name], np.zeros((1, len(obj.data.vertices), 3)))
        return key.name
    if piece.written == "GROUP":
        return add_group(obj, name).name
    attribute = None
    if name not in OF_ONE_TYPE:
        attribute = obj.data.attributes.new(name, piece.data_type, piece.domain)
    if attribute is None:
        raise Refusal(f"Blender would have no attribute {name!r}; rename its source")
    return attribute.name


def _fill(obj: bpy.types.Object, piece: Piece, name: str) -> None:
    if piece.written == "KEY":
        shape_keys.set_displacement(obj, obj.data.shape_keys.key_blocks[name], piece.values)
    elif piece.written == "GROUP":
        set_weights(obj.vertex_groups[name], piece.values)
    else:
        attributes = obj.data.attributes
        attribute = attributes[name]
        if (attribute.data_type, attribute.domain) != (piece.data_type, piece.domain):
            attributes.remove(attribute)
            attribute = attributes.new(name, piece.data_type, piece.domain)
        field, _, dtype = TYPES[piece.data_type]
        attribute.data.foreach_set(field, piece.values.astype(dtype).ravel())


def _remove(obj: bpy.types.Object, written: str, name: str) -> None:
    if written == "KEY":
        shape_keys.remove_key(obj, obj.data.shape_keys.key_blocks[name])
    elif written == "GROUP":
        obj.vertex_groups.remove(obj.vertex_groups[name])
    else:
        obj.data.attributes.remove(obj.data.attributes[name])
