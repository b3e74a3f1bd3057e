"""The places where the bands of a mesh are kept: its shape keys, or its attributes.

Bands are like shape keys: they have a ``name``, a ``value`` between ``slider_min`` and
``slider_max``, ``mute``, the ``vertex_group`` that masks them, and ``lock_shape``. Another place is
another class like `ShapeKeys`, and its name in PLACES.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import bpy

from .animation import animation_of
from .attribute_band import AttributeBand
from .attribute_place import Attributes
from .channels import insert_keyframe, is_of, key_path
from .decomposition import USUAL, SpectralTVRecord
from .drivers import readers, retarget_drivers
from .fingerprints import Likeness, recognise
from .mix import Slider, key_displacement, keys_of
from .shape_keys import add_displacements, move_key, remove_key, rename_key, set_displacement

Band = Slider


class ShapeKeys:
    """Bands as shape keys relative to Basis, so that Basis with all at −1 is the residual."""

    # What fingerprints call what is there.
    written = "KEY"
    # Whether an object has values of its own, whoever has the mesh.
    has_own_values = False
    # What a user calls it.
    label, label_of_one = "shape keys", "shape key"
    add, set = staticmethod(add_displacements), staticmethod(set_displacement)
    rename, displacement = staticmethod(rename_key), staticmethod(key_displacement)
    path, animation_of = staticmethod(key_path), staticmethod(animation_of)

    @staticmethod
    def refusal(_obj: bpy.types.Object) -> str | None:
        """Why bands of an object cannot be kept there, or be changed; None if they can."""
        return None

    @staticmethod
    def call(_bands: Sequence[Band], _name: str) -> None:
        """Take note that their decomposition has another name."""

    @staticmethod
    def follow_names(_obj: bpy.types.Object, _record: SpectralTVRecord) -> None:
        """Take note that bands may have other names; fingerprints tell that of keys."""

    @staticmethod
    def all(obj: bpy.types.Object) -> Mapping[str, Band]:
        """All that is kept there of an object, bands or not, by name."""
        return keys_of(obj.data)

    @staticmethod
    def draw(row: bpy.types.UILayout, band: Band, name: str, **how: Any) -> None:
        """Draw a property of a band as a field."""
        row.prop(band, name, **how)

    @staticmethod
    def block(obj: bpy.types.Object) -> bpy.types.Key:
        """What curves and drivers of bands are of."""
        return obj.data.shape_keys

    @staticmethod
    def property_of(band: Band, path: str) -> str:
        """The name of the property of a band that a path leads to; "" if it is not of the band."""
        return path.removeprefix(key_path(band)) if is_of(band)(path) else ""

    @staticmethod
    def keyframe(band: Band, name: str, frame: float) -> bool:
        """Insert a keyframe for a property of a band, and tell whether Blender did."""
        return insert_keyframe(band.id_data, key_path(band, name), frame)

    @staticmethod
    def readers(obj: bpy.types.Object, bands: Sequence[Band]) -> list[str]:
        """Names of the data-blocks with drivers that read bands, but for those of the bands."""
        return readers(obj.data, {band.name for band in bands})

    @classmethod
    def remove(cls, obj: bpy.types.Object, bands: Sequence[Band]) -> None:
        """Remove bands with all that animates them."""
        for name in [band.name for band in bands]:
            remove_key(obj, cls.all(obj)[name])

    @classmethod
    def hand_over(
        cls, obj: bpy.types.Object, gone: Sequence[str], heirs: Mapping[str, Band]
    ) -> Callable[[Sequence[Band]], None]:
        """Note where bands are that will be removed, by name, and what is about them.

        The function returned is called with the new bands once the others are gone and the new ones
        have their names. It puts them in these places, and has what read the others read their
        ``heirs``.
        """
        blocks = obj.data.shape_keys.key_blocks
        active = [
            (user, heirs.get(user.active_shape_key.name, user.active_shape_key))
            for user in bpy.data.objects
            if user.data == obj.data and user.active_shape_key is not None
        ]
        place = min(map(blocks.find, gone), default=None)

        def take(new: Sequence[Band]) -> None:
            retarget_drivers(obj.data, {name: band.name for name, band in heirs.items()})
            for index, band in enumerate(new if place is not None else ()):
                move_key(obj, band, place + index)
            for user, band in active:
                user.active_shape_key_index = blocks.find(band.name)

        return take

    @staticmethod
    def recognise(
        obj: bpy.types.Object, records: Sequence[SpectralTVRecord]
    ) -> list[tuple[str, Likeness]]:
        """Of all bands of records, one after the other, the name today and how like the band it is;
        "" if it was deleted. No key is a band of two."""
        prints = [band for each in records for band in each.bands]
        return recognise(obj, "KEY", prints, any_copy=True)

    @staticmethod
    def mark(mesh: bpy.types.Mesh, identifier: str) -> None:
        """Mark what is kept as that of the record of this identifier.

        The record that 0.1.0 kept there is none any more.
        """
        mesh.shape_keys.spectral_tv.bands.clear()
        mesh.shape_keys.spectral_tv.spectrum.clear()
        mesh.shape_keys.spectral_tv.identifier = identifier

    @staticmethod
    def is_marked(mesh: bpy.types.Mesh, identifier: str) -> bool:
        """Whether it still is that: Blender may have removed it all."""
        keys = mesh.shape_keys
        return keys is not None and keys.spectral_tv.identifier == identifier


Keeping = type[ShapeKeys] | type[Attributes]
PLACES: Mapping[str, Keeping] = {USUAL: ShapeKeys, "ATTRIBUTES": Attributes}


def place_of(band: Band) -> Keeping:
    """Where a band is kept."""
    return Attributes if isinstance(band, AttributeBand) else ShapeKeys
