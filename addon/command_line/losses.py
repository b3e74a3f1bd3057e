"""What a format does not keep of what a scene holds, told in a line each."""

from collections.abc import Callable, Sequence
from itertools import groupby

from ..scene.notes import listed, note
from .contents import Thing
from .formats import APPLIED, BLEND, FORMATS, HOLDS, KINDS, NO, ONE, a

# Kinds of which users want to know which ones.
NAMED = ("colors", "uvs", "attributes", "groups", "keys", "armatures", "others", "curves")


def tell_losses(things: Sequence[Thing], suffix: str, source: str) -> None:
    """Note what a file of this suffix does not keep of these, which are of one of another."""
    if suffix == BLEND:
        return
    lost, applied = [], []
    for kind, text in KINDS.items():
        there = [thing for thing in things if thing.kind == kind]
        if not there:
            continue
        word = HOLDS[suffix][kind]
        if word == APPLIED:
            applied.append(f"{text} ({_names(there)})")
        elif word == ONE:
            _tell_one(there, suffix, text)
        elif (kind, word) in PARTS:
            if word == HOLDS[source][kind] != NO:  # nothing was there to be lost
                continue
            told = PARTS[kind, word](there, suffix)
            if told:
                note(f"{a(suffix)} holds {told}")
        elif word == NO:
            lost.append(f"{text} ({_names(there)})" if kind in NAMED else text)
    if lost:
        note(f"left out, as {a(suffix)} does not hold them: {', '.join(lost)}")
    if applied:
        note(f"applied, as {a(suffix)} does not keep them apart: {', '.join(applied)}")


def _tell_one(things: Sequence[Thing], suffix: str, text: str) -> None:
    """Note which layers of objects that have several are left out; the first is kept."""
    for owner, layers in groupby(things, key=lambda thing: thing.owner):
        first, *rest = layers
        if rest:
            left = _names(rest)
            kept = f"{first.name} stays; left out: {left}"
            note(f"{owner}: {a(suffix)} holds one of its {text}: {kept}")


def _names(things: Sequence[Thing]) -> str:
    return listed(thing.name for thing in things)


def _total(things: Sequence[Thing]) -> int:
    return sum(thing.count for thing in things)


def _objects(things: Sequence[Thing], _suffix: str) -> str | None:
    return f"one object: {len(things)} were joined" if len(things) > 1 else None


def _object_names(things: Sequence[Thing], _suffix: str) -> str | None:
    return f"no object names: {_names(things)}" if len(things) > 1 else None


def _polygons(things: Sequence[Thing], _suffix: str) -> str | None:
    return f"triangles alone: {_total(things)} larger polygons were split"


def _colors(things: Sequence[Thing], _suffix: str) -> str | None:
    wide = [thing for thing in things if thing.detail == "FLOAT_COLOR"]
    return f"vertex colors with 8 bits: {_names(wide)} lost digits" if wide else None


def _materials(_things: Sequence[Thing], _suffix: str) -> str | None:
    return "the names of materials alone"


def _normals(_things: Sequence[Thing], _suffix: str) -> str | None:
    return "one normal per vertex: custom ones of its corners are lost"


def _attributes(things: Sequence[Thing], suffix: str) -> str | None:
    domains = FORMATS[suffix].attributes
    what = (
        "custom attributes of vertices alone"
        if len(domains) == 1
        else "no custom attributes of edges"
    )
    left = [thing for thing in things if thing.detail not in domains]
    return f"{what}; left out: {_names(left)}" if left else None


def _edges(things: Sequence[Thing], _suffix: str) -> str | None:
    edges = [thing for thing in things if thing.name == "edges"]
    return f"no loose edges: {_total(edges)} were left out" if edges else None


def _points(things: Sequence[Thing], _suffix: str) -> str | None:
    points = [thing for thing in things if thing.name == "points"]
    return (
        f"loose points as vertices of nothing: {_total(points)} may not be read" if points else None
    )


def _animation(things: Sequence[Thing], _suffix: str) -> str | None:
    moving = [thing for thing in things if thing.detail == "shape"]
    if not moving:
        return None
    return f"no vertices that move by themselves: {_names(moving)} is as in the current frame"


def _curves(things: Sequence[Thing], _suffix: str) -> str | None:
    return f"curves and texts as meshes: {_names(things)}"


def _texts(things: Sequence[Thing], _suffix: str) -> str | None:
    texts = [thing for thing in things if thing.detail in ("FONT", "META")]
    return f"no texts: {_names(texts)} is left out" if texts else None


# By the words of the table, what is lost of a kind of which a format holds a part.
PARTS: dict[tuple[str, str], Callable[[Sequence[Thing], str], str | None]] = {
    ("objects", NO): _objects,
    ("polygons", NO): _polygons,
    ("colors", "8 bits"): _colors,
    ("materials", "names"): _materials,
    ("normals", "per vertex"): _normals,
    ("attributes", "not of edges"): _attributes,
    ("attributes", "of vertices"): _attributes,
    ("loose", "points"): _edges,
    ("loose", "edges"): _points,
    ("names", NO): _object_names,
    ("animation", "keyframes"): _animation,
    ("curves", "meshes"): _curves,
    ("curves", "curves"): _texts,
}
