"""What a scene holds but a format does not keep: one message each."""

from collections.abc import Callable, Sequence
from itertools import groupby

from spectral_tv.notes import a, listed, note

from .contents import Thing
from .formats import APPLIED, BLEND, FORMATS, HOLDS, NO, ONE

# Kinds of which users want to know which ones.
NAMED = (
    "vertex colors",
    "UV maps",
    "custom attributes",
    "vertex groups",
    "shape keys",
    "armatures",
    "other objects",
    "curves, texts",
)


def tell_losses(things: Sequence[Thing], suffix: str, source: str) -> None:
    """Note what a file of this suffix does not keep of these, which are of one of another."""
    if suffix == BLEND:
        return
    lost, applied = [], []
    for kind, word in HOLDS[suffix].items():
        there = [thing for thing in things if thing.kind == kind]
        if not there:
            continue
        if word == APPLIED:
            applied.append(f"{kind} ({_names(there)})")
        elif word == ONE:
            _tell_one(there, suffix, kind)
        elif (kind, word) in PARTS:
            if word == HOLDS[source][kind] != NO:  # nothing was there to be lost
                continue
            told = PARTS[kind, word](there, suffix)
            if told:
                note(f"{a(suffix)} holds {told}")
        elif word == NO:
            lost.append(f"{kind} ({_names(there)})" if kind in NAMED else kind)
    if lost:
        note(f"left out, as {a(suffix)} does not hold them: {', '.join(lost)}")
    if applied:
        note(f"applied, as {a(suffix)} does not keep them apart: {', '.join(applied)}")


def _tell_one(things: Sequence[Thing], suffix: str, kind: str) -> None:
    """Note which layers of objects that have several are left out; the first is kept."""
    for owner, layers in groupby(things, key=lambda thing: thing.owner):
        first, *rest = layers
        if rest:
            kept = f"{first.name} stays; left out: {_names(rest)}"
            note(f"{owner}: {a(suffix)} holds one of its {kind}: {kept}")


def _names(things: Sequence[Thing]) -> str:
    return listed(thing.name for thing in things)


def _total(things: Sequence[Thing]) -> int:
    return sum(thing.count for thing in things)


def _some(text: str, things: Sequence[Thing], **wanted: object) -> str | None:
    """A text about those that are wanted, their names for ``{}``; None if there are none."""
    found = [each for each in things if all(getattr(each, k) == v for k, v in wanted.items())]
    return text.format(_names(found)) if found else None


def _attributes(things: Sequence[Thing], suffix: str) -> str | None:
    domains = FORMATS[suffix].attributes
    some, none = "custom attributes of vertices alone", "no custom attributes of edges"
    left = [thing for thing in things if thing.detail not in domains]
    return f"{some if len(domains) == 1 else none}; left out: {_names(left)}" if left else None


def _loose(kind: str, text: str) -> Callable[[Sequence[Thing], str], str | None]:
    def tell(things: Sequence[Thing], _suffix: str) -> str | None:
        found = [thing for thing in things if thing.name == kind]
        return text.format(_total(found)) if found else None

    return tell


# By the words of the table, what is lost of a kind of which a format holds a part.
PARTS: dict[tuple[str, str], Callable[[Sequence[Thing], str], str | None]] = {
    ("objects apart", NO): lambda them, _: (
        f"one object: {len(them)} were joined" if len(them) > 1 else None
    ),
    ("object names", NO): lambda them, _: (
        f"no object names: {_names(them)}" if len(them) > 1 else None
    ),
    ("quads, n-gons", NO): lambda them, _: (
        f"triangles alone: {_total(them)} larger polygons were split"
    ),
    ("vertex colors", "8 bits"): lambda them, _: _some(
        "vertex colors with 8 bits: {} lost digits", them, detail="FLOAT_COLOR"
    ),
    ("materials", "names"): lambda _them, _: "the names of materials alone",
    ("custom normals", "per vertex"): lambda _them, _: (
        "one normal per vertex: custom ones of its corners are lost"
    ),
    ("custom attributes", "not of edges"): _attributes,
    ("custom attributes", "of vertices"): _attributes,
    ("loose edges, points", "points"): _loose("edges", "no loose edges: {} were left out"),
    ("loose edges, points", "edges"): _loose(
        "points", "loose points as vertices of nothing: {} may not be read"
    ),
    ("animation", "keyframes"): lambda them, _: _some(
        "no vertices that move by themselves: {} is as in the current frame", them, detail="shape"
    ),
    ("curves, texts", "meshes"): lambda them, _: f"curves and texts as meshes: {_names(them)}",
    ("curves, texts", "curves"): lambda them, _: _some(
        "no texts: {} is left out", [each for each in them if each.detail in ("FONT", "META")]
    ),
}
