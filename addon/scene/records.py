"""What a mesh remembers of its decomposition: kept in the file, on the mesh's shape keys.

A record names the shape key of each band and holds a digest of its shape, so that bands are
found again after keys were renamed or reordered.
"""

import hashlib

import bpy
import numpy as np
from bpy.props import CollectionProperty, FloatProperty, IntProperty, StringProperty


class SpectralTVBand(bpy.types.PropertyGroup):
    """One band: the shape key it is, and the times it covers."""

    key: StringProperty(name="Shape Key")
    digest: StringProperty(name="Digest", description="Of the shape key's coordinates")
    start: FloatProperty(name="Start", description="Time at which the band starts, length²")
    end: FloatProperty(name="End", description="Time at which the band ends, length²")


class SpectralTVSample(bpy.types.PropertyGroup):
    """One component of the spectrum."""

    time: FloatProperty(name="Time", description="Length²")
    strength: FloatProperty(name="Strength", description="Length³")


class SpectralTVRecord(bpy.types.PropertyGroup):
    """The last decomposition of a mesh."""

    identifier: StringProperty(name="Identifier", description="Of the flow, while it is in memory")
    method: StringProperty(name="Method")
    area: FloatProperty(name="Area", description="Of the surface in world space, length²")
    topology: StringProperty(name="Topology", description="Digest of the polygons")
    vertex_count: IntProperty(name="Vertices")
    corner_count: IntProperty(name="Face Corners")
    vertex_group: StringProperty(name="Vertex Group", description="Limits the bands")
    bands: CollectionProperty(type=SpectralTVBand)
    spectrum: CollectionProperty(type=SpectralTVSample)


CLASSES = (SpectralTVBand, SpectralTVSample, SpectralTVRecord)


def record_of(obj: bpy.types.Object | None) -> SpectralTVRecord | None:
    """The record of a mesh object's decomposition, or None."""
    if obj is None or obj.type != "MESH" or obj.data.shape_keys is None:
        return None
    record = obj.data.shape_keys.spectral_tv
    return record if record.bands else None


def band_keys(obj: bpy.types.Object) -> list[bpy.types.ShapeKey | None]:
    """The shape key of every band, None for those that were deleted."""
    keys = obj.data.shape_keys
    record = keys.spectral_tv
    names = [key.name for key in keys.key_blocks]
    wanted = [band.key for band in record.bands]
    found = _found.get((keys.session_uid, record.identifier, *names))
    if found is None:
        found = _match(keys, record, names, wanted)
        _found.clear()
        _found[keys.session_uid, record.identifier, *names] = found
    return [keys.key_blocks[name] if name else None for name in found]


# The last answer, as panels ask at every redraw and digests are not free.
_found: dict[tuple, list[str]] = {}


def _match(keys: bpy.types.Key, record: SpectralTVRecord, names: list[str], wanted: list[str]):
    """Names of the bands' keys today: by name where all are there, else by their shapes too."""
    if all(name in names for name in wanted):
        return wanted
    present = set(wanted) & set(names)
    spare = {
        digest(coordinates(key.data)): key.name
        for key in keys.key_blocks
        if key.name not in present
    }
    return [
        band.key if band.key in present else spare.get(band.digest, "") for band in record.bands
    ]


def topology_changed(obj: bpy.types.Object) -> bool:
    """Whether vertices or faces were added or removed since the decomposition."""
    record = obj.data.shape_keys.spectral_tv
    counts = len(obj.data.vertices), len(obj.data.loops)
    return counts != (record.vertex_count, record.corner_count)


def topology_digest(mesh: bpy.types.Mesh) -> str:
    """Digest of which vertices the polygons connect."""
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_start", starts)
    return digest(corners, starts)


def coordinates(data: bpy.types.bpy_prop_collection) -> np.ndarray:
    """Flat float32 coordinates of vertices or shape key points."""
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat


def digest(*arrays: np.ndarray) -> str:
    """A short digest of arrays' bytes."""
    state = hashlib.blake2b(digest_size=12)
    for array in arrays:
        state.update(np.ascontiguousarray(array).tobytes())
    return state.hexdigest()


def register() -> None:
    """Register the properties, on the shape keys of every mesh."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Key.spectral_tv = bpy.props.PointerProperty(type=SpectralTVRecord)


def unregister() -> None:
    """Unregister the properties; files keep what they hold."""
    del bpy.types.Key.spectral_tv
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
