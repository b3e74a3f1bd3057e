"""Attributes as arrays, and digests of what meshes hold."""

from __future__ import annotations

import bpy
from spectral_tv.later import hashlib, np

from .arrays import corner_vertices, polygon_starts

# Of every type of attribute that has numbers: where its data are, how many, and their dtype.
TYPES = {
    "FLOAT": ("value", 1, "float32"),
    "INT": ("value", 1, "int32"),
    "INT8": ("value", 1, "int8"),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT2": ("vector", 2, "float32"),
    "FLOAT_VECTOR": ("vector", 3, "float32"),
    "FLOAT_COLOR": ("color", 4, "float32"),
    "BYTE_COLOR": ("color", 4, "float32"),
}


def attribute_values(attribute: bpy.types.Attribute) -> np.ndarray:
    """The numbers of an attribute, flat; none of a type whose values are no numbers."""
    field, channels, dtype = TYPES.get(attribute.data_type, ("", 0, "float32"))
    flat = np.empty(channels * len(attribute.data), dtype=dtype)
    if channels:
        attribute.data.foreach_get(field, flat)
    return flat


def topology_digest(mesh: bpy.types.Mesh) -> str:
    """Digest of which vertices the polygons connect."""
    corners = corner_vertices(mesh)
    starts = polygon_starts(mesh)
    return digest(corners, starts)


def digest(*arrays: np.ndarray) -> str:
    """A short digest of arrays' bytes."""
    state = hashlib.blake2b(digest_size=12)
    for array in arrays:
        state.update(np.ascontiguousarray(array).tobytes())
    return state.hexdigest()
