"""The shape that relative shape keys and bands show: what each adds to Basis at its value.

What is said of keys here is true of bands that are attributes too. They are added to what shape
keys show, so a key that is pinned hides other keys, but not them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from .attribute_band import AttributeBand, attribute_bands
from .coordinates import basis_coordinates, points
from .weights import weights_of

Slider = bpy.types.ShapeKey | AttributeBand


@dataclass(frozen=True)
class Part:
    """A key that moves something now, and how far."""

    key: Slider
    value: float

    def displacement(self, obj: bpy.types.Object) -> np.ndarray:
        """What it adds to Basis, (V, 3) in object space, at its value and within its mask."""
        scale = self.value * mask(obj, self.key)
        return scale[:, np.newaxis] * key_displacement(self.key)


class Moves:
    """How far keys move the vertices; the weights of vertex groups are kept until forgotten."""

    def __init__(self) -> None:
        """Know no weights so far."""
        self._masks: dict[tuple[str, type], np.ndarray] = {}

    def forget_masks(self) -> None:
        """Read the weights of vertex groups anew, as they may have changed."""
        self._masks.clear()

    def of(self, obj: bpy.types.Object, parts: Iterable[Part]) -> np.ndarray:
        """What keys move together, (V, 3) in object space."""
        moved = np.zeros((len(obj.data.vertices), 3))
        for part in parts:
            step = key_displacement(part.key)
            name = part.key.vertex_group
            if name:
                # One that is missing is another matter for either kind.
                which = name, type(part.key)
                if which not in self._masks:
                    self._masks[which] = mask(obj, part.key)
                step *= self._masks[which][:, np.newaxis]
            elif isinstance(part.key, AttributeBand):
                step *= part.key.share
            step *= part.value
            moved += step
        return moved


def keys_of(mesh: bpy.types.Mesh) -> Mapping[str, bpy.types.ShapeKey]:
    """The shape keys of a mesh, by name; none if it has none, not even Basis."""
    return {} if mesh.shape_keys is None else mesh.shape_keys.key_blocks


def sliders_of(obj: bpy.types.Object) -> list[Slider]:
    """All shape keys of an object, and its bands that are attributes."""
    return [*keys_of(obj.data).values(), *attribute_bands(obj)]


def key_displacement(key: Slider) -> np.ndarray:
    """How far a key at 1 moves the vertices: from the key that it is relative to, (V, 3)."""
    if isinstance(key, AttributeBand):
        return key.displacement()
    return points(key.points) - points(key.relative_key.points)


def mask(obj: bpy.types.Object, key: Slider) -> np.ndarray:
    """How much of a key reaches every vertex, (V,): the weights of its vertex group, or 1."""
    if isinstance(key, AttributeBand):
        return key.weights()
    group = obj.vertex_groups.get(key.vertex_group) if key.vertex_group else None
    if group is None:  # so does Blender where the group is missing
        return np.ones(len(obj.data.vertices))
    return weights_of(obj, group)


def parts(obj: bpy.types.Object) -> list[Part]:
    """The keys that move something now; a pinned one hides all others."""
    bands = [
        Part(band, band.value)
        for band in attribute_bands(obj)
        if band.modifier.show_viewport and not band.mute and band.value != 0
    ]
    keys = obj.data.shape_keys
    if keys is None:
        return bands
    if obj.show_only_shape_key:
        pinned = obj.active_shape_key
        return [*([Part(pinned, 1.0)] if pinned not in (None, keys.reference_key) else []), *bands]
    return [
        Part(key, key.value)
        for key in keys.key_blocks
        if key != keys.reference_key and not key.mute and key.value != 0
    ] + bands


def shown(obj: bpy.types.Object, without: Collection[Slider] = ()) -> np.ndarray:
    """The shape that the keys of ``obj`` show now, but for some of them, (V, 3) in object space."""
    shape = basis_coordinates(obj.data)
    for part in parts(obj):
        if part.key not in without:
            shape += part.displacement(obj)
    return shape


def told(obj: bpy.types.Object, without: Collection[Slider] = ()) -> str:
    """The keys that move something now with their values, such as ``Smile 0.75``; or nothing."""
    names = [f"{part.key.name} {part.value:.2g}" for part in parts(obj) if part.key not in without]
    return ", ".join(names)
