"""What meshes hold, as arrays, and digests of it."""

import hashlib
from collections.abc import Iterable

import bpy
import numpy as np

# Of every type of attribute that has numbers: where its data are, how many, and their dtype.
TYPES = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int8),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
}


def coordinates(data: bpy.types.bpy_prop_collection) -> np.ndarray:
    """Flat float32 coordinates of vertices or shape key points."""
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat


def displacement(key: bpy.types.ShapeKey) -> np.ndarray:
    """How far a shape key moves the vertices at value 1, (V, 3) in object space.

    That is from the key that it is relative to, which need not be Basis.
    """
    shape = coordinates(key.data).reshape(-1, 3).astype(np.float64)
    if key == key.id_data.reference_key or key.relative_key in (None, key):
        return np.zeros_like(shape)
    return shape - coordinates(key.relative_key.data).reshape(-1, 3)


def weights(
    obj: bpy.types.Object, names: Iterable[str]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """The vertices of vertex groups and their weights, by the groups' names."""
    groups = {obj.vertex_groups[name].index: name for name in names}
    found: dict[str, tuple[list[int], list[float]]] = {name: ([], []) for name in groups.values()}
    for vertex in obj.data.vertices:
        for membership in vertex.groups:
            name = groups.get(membership.group)
            if name is not None:
                found[name][0].append(vertex.index)
                found[name][1].append(membership.weight)
    return {
        name: (np.array(vertices, dtype=np.int32), np.array(values, dtype=np.float32))
        for name, (vertices, values) in found.items()
    }


def attribute_values(attribute: bpy.types.Attribute) -> np.ndarray:
    """The numbers of an attribute, flat; none of a type whose values are no numbers."""
    field, channels, dtype = TYPES.get(attribute.data_type, ("", 0, np.float32))
    flat = np.empty(channels * len(attribute.data), dtype=dtype)
    if channels:
        attribute.data.foreach_get(field, flat)
    return flat


def topology_digest(mesh: bpy.types.Mesh) -> str:
    """Digest of which vertices the polygons connect."""
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_start", starts)
    return digest(corners, starts)


def digest(*arrays: np.ndarray) -> str:
    """A short digest of arrays' bytes."""
    state = hashlib.blake2b(digest_size=12)
    for array in arrays:
        state.update(np.ascontiguousarray(array).tobytes())
    return state.hexdigest()
