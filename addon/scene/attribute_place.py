"""The place where bands are vector attributes, which a Geometry Nodes modifier adds to the shape.

The modifier comes first, so that bands act at rest, before an armature; shape keys act before it.
Values, mutes and masks are inputs of the modifier, and animated as such.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import groupby
from typing import Any

import bpy
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from . import band_nodes, node_inputs
from .attribute_band import (
    AttributeBand,
    attribute_bands,
    attribute_of,
    modifiers_of,
    own_group,
)
from .channels import animation_at, insert_keyframe, remove_channels
from .decomposition import LABEL, SpectralTVRecord
from .drivers import path_readers, retarget_paths
from .fingerprints import Likeness, digests
from .modifiers import bending_parent
from .names import free_name, taken_names
from .whole import whole

# Modifiers that Blender has before all others, and that change the shape.
FIRST = ("MULTIRES", "SOFT_BODY")


class Attributes:
    """Bands as attributes: of one object, as the values are of its modifier."""

    written = "ATTRIBUTE"
    has_own_values = True
    label, label_of_one = "attributes", "attribute"

    @staticmethod
    def refusal(obj: bpy.types.Object) -> str | None:
        """Why bands of an object cannot be attributes, or be changed as such; None if they can."""
        if obj.data.users > 1:
            return (
                f"{obj.data.users} objects share this mesh, but bands that are attributes are of "
                "one; make it single-user first"
            )
        parent = bending_parent(obj)
        if parent is not None:
            return (
                f"{parent.name} bends the object as its parent, before bands that are attributes; "
                "use a modifier for that"
            )
        before = [each.name for each in obj.modifiers if each.type in FIRST]
        if before:
            return f"{before[0]} has to be the first modifier, before bands that are attributes"
        return None

    @staticmethod
    def all(obj: bpy.types.Object) -> dict[str, AttributeBand]:
        """All bands of an object that are there, by name."""
        return {band.name: band for band in attribute_bands(obj)}

    @classmethod
    def add(
        cls, obj: bpy.types.Object, names: Sequence[str], displacements: Iterable[np.ndarray]
    ) -> list[AttributeBand]:
        """Add one attribute per displacement (V, 3) in object space, and a modifier with them, at
        value 0; all of it or nothing.

        Raises Refusal if bands of the object cannot be attributes.
        """
        reason = cls.refusal(obj)
        if reason is not None:
            raise Refusal(reason)
        active = obj.data.attributes.active_index
        with whole(obj):
            given = []
            for name, displacement in zip(names, displacements, strict=True):
                free = free_name(name, "", taken_names(obj, "ATTRIBUTE"))
                given.append(obj.data.attributes.new(free, "FLOAT_VECTOR", "POINT").name)
                _write(obj, given[-1], displacement)
            stem = names[0].partition(LABEL)[0]
            modifier = obj.modifiers.new(stem, "NODES")
            modifier.node_group = band_nodes.make(stem, given)
            modifier.show_expanded = False
            _move_first(obj, modifier)
        obj.data.attributes.active_index = active
        obj.data.update_tag()
        bands = modifier.node_group.spectral_tv.bands
        return [AttributeBand(modifier, each.gain) for each in bands]

    @staticmethod
    def set(obj: bpy.types.Object, band: AttributeBand, displacement: np.ndarray) -> None:
        """Have a band move the vertices by (V, 3), in object space."""
        _write(obj, band.name, displacement)
        obj.data.update_tag()

    @staticmethod
    def rename(_obj: bpy.types.Object, band: AttributeBand, name: str) -> None:
        """Give a band another name, which is free; its inputs follow."""
        band.name = name

    @staticmethod
    def call(bands: Sequence[AttributeBand], name: str) -> None:
        """Have the modifiers of bands, and their groups, have the name of a decomposition."""
        for modifier in dict.fromkeys(band.modifier for band in bands):
            modifier.name = name
            own_group(modifier).name = name

    @staticmethod
    def displacement(band: AttributeBand) -> np.ndarray:
        """How far a band moves the vertices at 1, (V, 3) in object space."""
        return band.displacement()

    @staticmethod
    def draw(row: bpy.types.UILayout, band: AttributeBand, name: str, **how: Any) -> None:
        """Draw a property of a band, its value or mute, as a field."""
        socket = {"value": band.gain, "mute": band.entry.mute}[name]
        node_inputs.draw_value(row, band.modifier, socket, **how)

    @staticmethod
    def block(obj: bpy.types.Object) -> bpy.types.Object:
        """What curves and drivers of bands are of."""
        return obj

    @staticmethod
    def path(band: AttributeBand, name: str) -> str:
        """The path from the object to a property of a band: its value, mute or share."""
        sockets = {"value": band.gain, "mute": band.entry.mute, "share": band.entry.mask}
        return node_inputs.path_of(band.modifier, sockets[name])

    @classmethod
    def property_of(cls, band: AttributeBand, path: str) -> str:
        """The name of the property of a band that a path leads to; "" if it is not of the band."""
        return next((each for each in PROPERTIES if cls.path(band, each) == path), "")

    @classmethod
    def keyframe(cls, band: AttributeBand, name: str, frame: float) -> bool:
        """Insert a keyframe for a property of a band, and tell whether Blender did."""
        return insert_keyframe(band.id_data, cls.path(band, name), frame)

    @classmethod
    def animation_of(cls, band: AttributeBand, name: str) -> str:
        """How a property of a band is animated, "keyed" or "driven"; nothing if it is not."""
        return animation_at(band.id_data, cls.path(band, name))

    @classmethod
    def readers(cls, obj: bpy.types.Object, bands: Sequence[AttributeBand]) -> list[str]:
        """Names of the data-blocks with drivers that read bands, but for those of the bands."""
        return path_readers(obj, {cls.path(band, each) for band in bands for each in PROPERTIES})

    @classmethod
    def remove(cls, obj: bpy.types.Object, bands: Sequence[AttributeBand]) -> None:
        """Remove bands with all that animates them, and modifiers that have none any more."""
        paths = {cls.path(band, each) for band in bands for each in PROPERTIES}
        remove_channels(obj, paths.__contains__)
        names = [band.name for band in bands]
        by_modifier = [
            (modifier, {band.gain for band in some})
            for modifier, some in groupby(
                sorted(bands, key=lambda band: band.modifier.name), lambda band: band.modifier
            )
        ]
        for modifier, gains in by_modifier:
            group = modifier.node_group
            if gains >= {each.gain for each in group.spectral_tv.bands}:
                obj.modifiers.remove(modifier)
                band_nodes.discard(group)
            else:
                band_nodes.remove(own_group(modifier), gains)
        for name in names:
            obj.data.attributes.remove(obj.data.attributes[name])
        obj.data.update_tag()

    @classmethod
    def hand_over(
        cls, obj: bpy.types.Object, gone: Sequence[str], heirs: Mapping[str, AttributeBand]
    ) -> Callable[[Sequence[AttributeBand]], None]:
        """Note what reads bands that will be removed; see `ShapeKeys.hand_over`."""
        there = cls.all(obj)
        modifiers = list(dict.fromkeys(there[name].modifier for name in gone))
        label = modifiers[0].name if modifiers else ""
        read = [
            (cls.path(there[name], each), heir, each)
            for name, heir in heirs.items()
            for each in PROPERTIES
        ]

        def take(new: Sequence[AttributeBand]) -> None:
            if label and label not in obj.modifiers:
                cls.call(new, label)
            renamed = {path: cls.path(heir, each) for path, heir, each in read}
            retarget_paths(obj, renamed, obj)

        return take

    @classmethod
    def recognise(
        cls, obj: bpy.types.Object, records: Sequence[SpectralTVRecord]
    ) -> list[tuple[str, Likeness]]:
        """Of all bands of records the name today, and whether it is unchanged; "" if it was
        deleted. Where vertices came or went, attributes were carried along, and count as
        unchanged."""
        there, found = cls.all(obj), []
        for record in records:
            is_carried = len(obj.data.vertices) != record.vertex_count
            for band in record.bands:
                if band.key not in there:
                    found.append(("", Likeness.OTHER))
                    continue
                is_same = (
                    is_carried or digests(obj, "ATTRIBUTE", [band.key])[band.key] == band.digest
                )
                found.append((band.key, Likeness.SAME if is_same else Likeness.CHANGED))
        return found

    @staticmethod
    def follow_names(obj: bpy.types.Object, record: SpectralTVRecord) -> None:
        """Have the inputs and the record follow attributes that the user has renamed."""
        entries = {
            entry.name: AttributeBand(modifier, entry.gain)
            for modifier in modifiers_of(obj)
            for entry in modifier.node_group.spectral_tv.bands
        }
        missing = [
            band
            for band in record.bands
            if band.key in entries and attribute_of(obj.data, band.key) is None
        ]
        others = {each.name for each in obj.data.attributes} - entries.keys() if missing else set()
        free = [name for name in others if attribute_of(obj.data, name) is not None]
        prints = digests(obj, "ATTRIBUTE", free)
        for band in missing:
            same = [name for name in free if prints[name] == band.digest]
            if same:
                entries[band.key].name = band.key = same[0]
                free.remove(same[0])

    @staticmethod
    def mark(mesh: bpy.types.Mesh, identifier: str) -> None:
        """Mark the modifiers of bands of a mesh as those of the record of this identifier."""
        for modifier in _modifiers(mesh):
            modifier.node_group.spectral_tv.mark = identifier

    @staticmethod
    def is_marked(mesh: bpy.types.Mesh, identifier: str) -> bool:
        """Whether they still are there: the user may have removed or applied them."""
        return any(each.node_group.spectral_tv.mark == identifier for each in _modifiers(mesh))


# What of a band can be animated.
PROPERTIES = ("value", "mute", "share")


def _modifiers(mesh: bpy.types.Mesh) -> list[bpy.types.NodesModifier]:
    users = [each for each in bpy.data.objects if each.data == mesh]
    return [modifier for user in users for modifier in modifiers_of(user)]


def _write(obj: bpy.types.Object, name: str, displacement: np.ndarray) -> None:
    values = displacement.astype(np.float32).ravel()
    obj.data.attributes[name].data.foreach_set("vector", values)


def _move_first(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
    """Have a modifier come first, but for those that Blender has before all others."""
    place = obj.modifiers.find(modifier.name)
    while place > 0:
        try:
            obj.modifiers.move(place, place - 1)
        except RuntimeError:
            note(f"{obj.modifiers[place - 1].name!r} stays before the bands")
            return
        place -= 1
