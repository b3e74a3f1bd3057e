"""Fingerprints of what was written on a mesh: they recognise it whatever its name is today.

Vertex groups, attributes and shape keys can hold no mark. So what was written is recognised by its
contents, which have to be exactly the same. A shape key is compared up to rounding. If about half
of it is as it was, it is recognised as one that was changed.
"""

from collections.abc import Collection, Sequence
from enum import IntEnum

import bpy
from bpy.props import FloatVectorProperty, IntVectorProperty, StringProperty
from spectral_tv.later import np

from .contents import attribute_values, digest
from .coordinates import coordinates
from .mix import key_displacement, keys_of
from .weights import members

# Sums that a sketch has, and vertices that are sampled; Blender allows no more in a property.
SUMS, SAMPLES = 32, 10
# What rounding to single precision makes of coordinates in the mean, relative to the largest, and
# how many times as much tells of a change.
ROUNDING, CHANGE = 2.0**-24, 8.0


class Likeness(IntEnum):
    """How something there is like what was written."""

    OTHER = 0
    CHANGED = 1
    SAME = 2


class Fingerprint:
    """That of one thing that was written."""

    key: StringProperty(name="Key", description="Its name when it was last seen")
    digest: StringProperty(name="Digest", description="Of the contents")
    sketch: FloatVectorProperty(
        name="Sketch", description="Of how a shape key moves the vertices", size=SUMS
    )
    places: IntVectorProperty(
        name="Places", description="Vertices that a shape key moves far", size=SAMPLES
    )
    moves: FloatVectorProperty(name="Moves", description="How far it moves those", size=3 * SAMPLES)

    def take(self, obj: bpy.types.Object, written: str, name: str) -> None:
        """Take the name and the contents of a KEY, a GROUP or an ATTRIBUTE of ``obj``."""
        self.key, self.digest = name, digests(obj, written, [name])[name]
        if written == "KEY":
            moved = key_displacement(obj.data.shape_keys.key_blocks[name])
            lengths = np.linalg.norm(moved, axis=1)
            ranges = [part for part in np.array_split(np.arange(len(moved)), SAMPLES) if len(part)]
            places = [int(part[lengths[part].argmax()]) for part in ranges]
            self.sketch, self.places = sketch(moved), (places * SAMPLES)[:SAMPLES]
            self.moves = moved[list(self.places)].ravel()

    def likeness(self, key: bpy.types.ShapeKey) -> Likeness:
        """How like this one a shape key with another digest moves the vertices.

        If Basis is sculpted, Blender moves all keys along; their displacements stay.
        """
        moved, unit = key_displacement(key), rounding(key)
        if not any(self.sketch) and not any(self.places):  # taken by 0.1.0
            return Likeness.CHANGED
        if max(self.places) >= len(moved) or np.abs(self.moves).max() <= unit:
            return Likeness.OTHER
        apart = np.abs(sketch(moved) - self.sketch).max()
        if apart <= unit * np.sqrt(3 * len(moved) / SUMS):
            return Likeness.SAME
        apart = np.abs(moved[list(self.places)] - np.reshape(self.moves, (-1, 3))).max(axis=1)
        told = np.abs(np.reshape(self.moves, (-1, 3))).max(axis=1) > unit
        return Likeness.CHANGED if (apart[told] <= unit).mean() >= 0.5 else Likeness.OTHER


def recognise(
    obj: bpy.types.Object, written: str, prints: Sequence[Fingerprint], any_copy: bool = False
) -> list[tuple[str, Likeness]]:
    """Which of the KEYs, GROUPs or ATTRIBUTEs of ``obj`` each of the written things is today.

    Gives its name today and its likeness; the name is "" if it is gone. The recorded name alone
    proves nothing. What has that name is another thing if it is nothing like what was written, or
    if the written thing is there under another name. Of several copies, all under other names, the
    first is taken if ``any_copy`` will do, else none.
    """
    found = [("", Likeness.OTHER)] * len(prints)
    taken: set[str] = set()

    def settle(index: int, names: Sequence[str], likeness: Likeness) -> None:
        if len(names) == 1 or (names and any_copy):
            found[index] = names[0], likeness
            taken.add(names[0])

    def unsettled() -> list[tuple[int, Fingerprint]]:
        return [(i, each) for i, each in enumerate(prints) if not found[i][0]]

    present = names(obj, written)
    contents = _digests_needed(obj, written, prints, present)
    for index, each in unsettled():
        if contents.get(each.key) == each.digest:
            settle(index, [each.key], Likeness.SAME)
    for index, each in unsettled():
        copies = [n for n in present if n not in taken and contents.get(n) == each.digest]
        settle(index, copies, Likeness.SAME)
    if written != "KEY" or not unsettled():
        return found
    keys = obj.data.shape_keys.key_blocks if present else {}
    for index, each in unsettled():
        if each.key in present and each.key not in taken:
            likeness = each.likeness(keys[each.key])
            settle(index, [each.key] if likeness else [], likeness)
    for index, each in unsettled():
        others = [name for name in present if name not in taken and any(each.places)]
        alike = [name for name in others if each.likeness(keys[name]) == Likeness.SAME]
        settle(index, alike, Likeness.SAME)
    return found


def names(obj: bpy.types.Object, written: str) -> list[str]:
    """Names of all GROUPs, ATTRIBUTEs or KEYs of ``obj``, but for that of Basis."""
    if written == "KEY":
        keys = keys_of(obj.data).values()
        return [key.name for key in keys if key != key.id_data.reference_key]
    return obj.vertex_groups.keys() if written == "GROUP" else obj.data.attributes.keys()


def digests(obj: bpy.types.Object, written: str, names: Collection[str]) -> dict[str, str]:
    """Digests of what those of these names hold."""
    if written == "GROUP":
        return {name: digest(*found) for name, found in members(obj, names).items()}
    if written == "KEY":
        keys = obj.data.shape_keys
        return {name: digest(coordinates(keys.key_blocks[name].points)) for name in names}
    return {name: _attribute_digest(obj.data.attributes[name]) for name in names}


def rounding(key: bpy.types.ShapeKey) -> float:
    """By how much rounding may change how far a key moves a vertex along an axis."""
    return CHANGE * ROUNDING * float(np.abs(coordinates(key.points)).max(initial=0.0))


def sketch(displacements: "np.ndarray") -> "np.ndarray":
    """Signed sums of (V, 3) displacements, (SUMS,), whose distances are about theirs (a count
    sketch: Charikar, Chen and Farach-Colton 2002)."""
    values = displacements.ravel()
    # A multiplicative hash of the place: the same everywhere, and for ever.
    place = np.arange(len(values), dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    place ^= place >> np.uint64(29)
    place *= np.uint64(0xBF58476D1CE4E5B9)
    signs = np.where(place >> np.uint64(63), 1.0, -1.0)
    sums = (place >> np.uint64(40)) % np.uint64(SUMS)
    return np.bincount(sums.astype(np.int64), signs * values, SUMS)


def _digests_needed(
    obj: bpy.types.Object, written: str, prints: Sequence[Fingerprint], present: Sequence[str]
) -> dict[str, str]:
    """Digests of those of the recorded names, and of all others where these are not enough."""
    named = {each.key for each in prints} & set(present)
    found = digests(obj, written, named)
    if all(found.get(each.key) == each.digest for each in prints):
        return found
    return {**found, **digests(obj, written, set(present) - named)}


def _attribute_digest(attribute: bpy.types.Attribute) -> str:
    kind = f"{attribute.domain} {attribute.data_type}".encode()
    return digest(np.frombuffer(kind, dtype=np.uint8), attribute_values(attribute))
