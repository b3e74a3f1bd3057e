"""Bands that are vector attributes: a modifier adds them to the shape that shape keys show."""

from __future__ import annotations

import bpy
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from . import band_nodes, node_inputs
from .band_nodes import SpectralTVNodeBand
from .contents import attribute_values
from .weights import weights_of

# Types of attributes that Blender takes for numbers, where they are a mask.
NUMBERS = ("FLOAT", "INT", "INT8", "BOOLEAN")


class AttributeBand:
    """A band, used like a shape key."""

    def __init__(self, modifier: bpy.types.NodesModifier, gain: str) -> None:
        """That of a modifier with this input as its gain."""
        self.modifier, self.gain = modifier, gain

    @property
    def id_data(self) -> bpy.types.Object:
        """The object whose modifier has it."""
        return self.modifier.id_data

    @property
    def entry(self) -> SpectralTVNodeBand:
        """What the node group knows of it."""
        bands = self.modifier.node_group.spectral_tv.bands
        return next(each for each in bands if each.gain == self.gain)

    @property
    def name(self) -> str:
        """That of its attribute."""
        return self.entry.name

    @name.setter
    def name(self, name: str) -> None:
        own_group(self.modifier)
        attribute = attribute_of(self.id_data.data, self.name)
        if attribute is not None:
            attribute.name = name
        band_nodes.rename(self.modifier.node_group, self.entry, name)

    @property
    def value(self) -> float:
        """How much is added: −1 removes the band, 0 leaves it, 1 doubles it."""
        return self._within(float(node_inputs.value_of(self.modifier, self.gain)))

    @value.setter
    def value(self, value: float) -> None:
        node_inputs.set_value(self.modifier, self.gain, self._within(float(value)))

    def _within(self, value: float) -> float:
        """A value as it acts: animation and drivers may lead beyond the ends."""
        socket = self._socket
        return min(max(value, socket.min_value), socket.max_value)

    @property
    def mute(self) -> bool:
        """Whether it does not act."""
        return bool(node_inputs.value_of(self.modifier, self.entry.mute))

    @mute.setter
    def mute(self, mute: bool) -> None:
        node_inputs.set_value(self.modifier, self.entry.mute, bool(mute))

    @property
    def vertex_group(self) -> str:
        """The vertex group, or another attribute, that masks it; "" if a number does."""
        return node_inputs.attribute_of(self.modifier, self.entry.mask)

    @vertex_group.setter
    def vertex_group(self, name: str) -> None:
        node_inputs.set_attribute(self.modifier, self.entry.mask, name)

    @property
    def share(self) -> float:
        """How much of it acts, where no vertex group masks it."""
        return float(node_inputs.value_of(self.modifier, self.entry.mask))

    @property
    def lock_shape(self) -> bool:
        """Whether its shape key is locked, if it becomes one."""
        return self.entry.lock_shape

    @lock_shape.setter
    def lock_shape(self, lock: bool) -> None:
        self.entry.lock_shape = lock

    @property
    def slider_min(self) -> float:
        """The least value."""
        return self._socket.min_value

    @slider_min.setter
    def slider_min(self, value: float) -> None:
        if value != self._socket.min_value:
            group = own_group(self.modifier)
            band_nodes.set_ends(group, self.gain, value, self._socket.max_value)

    @property
    def slider_max(self) -> float:
        """The largest value."""
        return self._socket.max_value

    @slider_max.setter
    def slider_max(self, value: float) -> None:
        if value != self._socket.max_value:
            group = own_group(self.modifier)
            band_nodes.set_ends(group, self.gain, self._socket.min_value, value)

    @property
    def _socket(self) -> bpy.types.NodeTreeInterfaceSocket:
        return band_nodes.socket_of(self.modifier.node_group, self.gain)

    def displacement(self) -> np.ndarray:
        """How far it moves the vertices at 1, (V, 3) in object space."""
        attribute = attribute_of(self.id_data.data, self.name)
        return attribute_values(attribute).reshape(-1, 3).astype(np.float64)

    def weights(self) -> np.ndarray:
        """How much of it reaches every vertex, (V,).

        Raises Refusal if that is an attribute whose values are not of vertices.
        """
        obj, name = self.id_data, self.vertex_group
        count = len(obj.data.vertices)
        if not name:
            return np.full(count, self.share)
        if name in obj.vertex_groups:
            return weights_of(obj, obj.vertex_groups[name])
        attribute = obj.data.attributes.get(name)
        if attribute is None:  # so does Blender
            return np.zeros(count)
        if attribute.domain != "POINT" or attribute.data_type not in NUMBERS:
            raise Refusal(f"the mask {name!r} of {self.name!r} has no number for each vertex")
        return attribute_values(attribute).astype(np.float64)

    def __eq__(self, other: object) -> bool:
        """Whether both are the same band of the same object."""
        return isinstance(other, AttributeBand) and self._identity == other._identity

    def __hash__(self) -> int:
        """A hash of that."""
        return hash(self._identity)

    @property
    def _identity(self) -> tuple[int, str]:
        return self.modifier.as_pointer(), self.gain


def has_bands(modifier: bpy.types.Modifier) -> bool:
    """Whether a modifier was made for bands."""
    group = modifier.node_group if modifier.type == "NODES" else None
    return group is not None and len(group.spectral_tv.bands) > 0


def modifiers_of(obj: bpy.types.Object) -> list[bpy.types.NodesModifier]:
    """The modifiers of an object that were made for bands."""
    return [each for each in obj.modifiers if has_bands(each)]


def attribute_of(mesh: bpy.types.Mesh, name: str) -> bpy.types.Attribute | None:
    """The vector attribute of vertices of a name, if there is one."""
    attribute = mesh.attributes.get(name)
    is_vector = attribute is not None and attribute.data_type == "FLOAT_VECTOR"
    return attribute if is_vector and attribute.domain == "POINT" else None


def attribute_bands(obj: bpy.types.Object) -> list[AttributeBand]:
    """The bands of an object whose attributes are there."""
    return [
        AttributeBand(modifier, entry.gain)
        for modifier in modifiers_of(obj)
        for entry in modifier.node_group.spectral_tv.bands
        if attribute_of(obj.data, entry.name) is not None
    ]


def own_group(modifier: bpy.types.NodesModifier) -> bpy.types.NodeTree:
    """The group of a modifier, a copy if objects with another mesh have it too."""
    obj, group = modifier.id_data, modifier.node_group
    users = [
        (user, each)
        for user in bpy.data.objects
        if user.type == "MESH"
        for each in user.modifiers
        if each.type == "NODES" and each.node_group == group
    ]
    if any(user.data != obj.data for user, _ in users) or group.library is not None:
        copy = group.copy()
        for user, each in users:
            if user.data == obj.data:
                each.node_group = copy
    return modifier.node_group
