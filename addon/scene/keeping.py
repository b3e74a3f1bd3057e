"""The place where the bands of a mesh are kept: its shape keys.

Bands are like shape keys: they have a ``name``, a ``value`` between ``slider_min`` and
``slider_max``, ``mute``, the ``vertex_group`` that masks them, and ``lock_shape``. Another place is
another class like `ShapeKeys`, and its name in PLACES.
"""

from collections.abc import Mapping

import bpy

from .animation import animation_of
from .channels import insert_keyframe, key_path
from .mix import key_displacement, keys_of
from .shape_keys import add_displacements, move_key, remove_key, set_displacement

Band = bpy.types.ShapeKey


class ShapeKeys:
    """Bands as shape keys relative to Basis, so that Basis with all at −1 is the residual."""

    # What fingerprints call what is there.
    written = "KEY"
    # All that is kept there of a mesh, bands or not, by name.
    all = staticmethod(keys_of)
    add, set = staticmethod(add_displacements), staticmethod(set_displacement)
    remove, move = staticmethod(remove_key), staticmethod(move_key)
    displacement, path = staticmethod(key_displacement), staticmethod(key_path)
    keyframe, animation_of = staticmethod(insert_keyframe), staticmethod(animation_of)

    @staticmethod
    def animated(mesh: bpy.types.Mesh) -> bpy.types.Key:
        """What curves and drivers of bands are of."""
        return mesh.shape_keys

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


Keeping = type[ShapeKeys]
# Where new bands go.
USUAL = "KEYS"
PLACES: Mapping[str, Keeping] = {USUAL: ShapeKeys}
