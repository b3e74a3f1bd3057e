"""The place where the bands of a mesh are kept: its shape keys.

Code that works on bands uses a `Keeping`, and bands that are like shape keys: they have a
``name``, a ``value`` between ``slider_min`` and ``slider_max``, ``mute``, the ``vertex_group`` that
masks them, and ``lock_shape``. Another place is another class, and its name in PLACES.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

import bpy
import numpy as np

from .channels import insert_keyframe, key_path
from .mix import key_displacement
from .shape_keys import add_displacements, move_key, remove_key

Band = bpy.types.ShapeKey


class Keeping(Protocol):
    """A place for bands."""

    # What fingerprints call what is there.
    written: str

    def all(self, obj: bpy.types.Object) -> Mapping[str, Band]:
        """All that is kept there on ``obj``, bands or not, by name."""

    def add(
        self, obj: bpy.types.Object, names: Sequence[str], displacements: Iterable[np.ndarray]
    ) -> list[Band]:
        """Add bands, K displacements of (V, 3) in object space, at value 0; all of them or none."""

    def remove(self, obj: bpy.types.Object, band: Band) -> None:
        """Remove a band with all that animates it."""

    def move(self, obj: bpy.types.Object, band: Band, place: int) -> None:
        """Move a band up the list to a place, as far as Blender does that now."""

    def displacement(self, band: Band) -> np.ndarray:
        """How far a band at 1 moves the vertices, (V, 3) in object space."""

    def animated(self, obj: bpy.types.Object) -> bpy.types.ID:
        """What curves and drivers of bands are of."""

    def path(self, band: Band, name: str = "") -> str:
        """The path from there to a property of a band, or what all such paths begin with."""

    def keyframe(self, band: Band, frame: float) -> bool:
        """Insert a keyframe for the value, and tell whether Blender did."""

    def mark(self, mesh: bpy.types.Mesh, identifier: str) -> None:
        """Mark what is kept as that of the record of this identifier."""

    def is_marked(self, mesh: bpy.types.Mesh, identifier: str) -> bool:
        """Whether it still is that: Blender may have removed it all."""


class ShapeKeys:
    """Bands as shape keys relative to Basis, so that Basis with all at −1 is the residual."""

    written = "KEY"
    remove, move = staticmethod(remove_key), staticmethod(move_key)
    add = staticmethod(add_displacements)
    displacement, path = staticmethod(key_displacement), staticmethod(key_path)

    @staticmethod
    def all(obj: bpy.types.Object) -> Mapping[str, Band]:
        """The shape keys."""
        keys = obj.data.shape_keys
        return {} if keys is None else keys.key_blocks

    @staticmethod
    def animated(obj: bpy.types.Object) -> bpy.types.Key:
        """The block that has them."""
        return obj.data.shape_keys

    @staticmethod
    def keyframe(band: Band, frame: float) -> bool:
        """Insert a keyframe for the value, and tell whether Blender did."""
        return insert_keyframe(band, "value", frame)

    @staticmethod
    def mark(mesh: bpy.types.Mesh, identifier: str) -> None:
        """Mark the block; the record that 0.1.0 kept there is none any more."""
        mesh.shape_keys.spectral_tv.bands.clear()
        mesh.shape_keys.spectral_tv.spectrum.clear()
        mesh.shape_keys.spectral_tv.identifier = identifier

    @staticmethod
    def is_marked(mesh: bpy.types.Mesh, identifier: str) -> bool:
        """Whether the block is there, and no other one."""
        keys = mesh.shape_keys
        return keys is not None and keys.spectral_tv.identifier == identifier


PLACES: Mapping[str, Keeping] = {"KEYS": ShapeKeys()}
