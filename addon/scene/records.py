"""What a mesh remembers of its decomposition: kept in the file, on the mesh's shape keys.

A record names the shape key of each band and has its fingerprint, so that bands are found again
after keys were renamed, reordered or sculpted, and no other key is taken for one.
"""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    FloatProperty,
    IntProperty,
    StringProperty,
)

from .fingerprints import Fingerprint, Likeness, digests, recognise


class SpectralTVBand(Fingerprint, bpy.types.PropertyGroup):
    """One band: the shape key it is, and the times it covers."""

    start: FloatProperty(name="Start", description="Time at which the band starts, length²")
    end: FloatProperty(name="End", description="Time at which the band ends, length²")
    was_muted: BoolProperty(
        name="Was Muted",
        description="Before another band was soloed",
        override={"LIBRARY_OVERRIDABLE"},
    )


class SpectralTVSample(bpy.types.PropertyGroup):
    """One component of the spectrum."""

    time: FloatProperty(name="Time", description="Length²")
    strength: FloatProperty(name="Strength", description="Length³")


class SpectralTVRecord(bpy.types.PropertyGroup):
    """The last decomposition of a mesh."""

    identifier: StringProperty(name="Identifier", description="Of the flow, while it is in memory")
    method: StringProperty(name="Method")
    settings: StringProperty(name="Settings", description="What it was decomposed by, as JSON")
    area: FloatProperty(name="Area", description="Of the surface in world space, length²")
    topology: StringProperty(name="Topology", description="Digest of the polygons")
    vertex_count: IntProperty(name="Vertices")
    corner_count: IntProperty(name="Face Corners")
    solo: IntProperty(
        name="Solo",
        description="The band that is heard alone, from 1; 0 if none is",
        override={"LIBRARY_OVERRIDABLE"},
    )
    bands: CollectionProperty(type=SpectralTVBand, override={"LIBRARY_OVERRIDABLE"})
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
    blocks = obj.data.shape_keys.key_blocks
    return [blocks[name] if name else None for name, _ in recognise_bands(obj)]


def bands_shown(obj: bpy.types.Object) -> list[bpy.types.ShapeKey | None]:
    """The same for panels, which ask at every redraw: known again only when names change."""
    keys = obj.data.shape_keys
    question = (keys.session_uid, keys.spectral_tv.identifier, *keys.key_blocks.keys())
    if question not in _shown:
        _shown.clear()
        _shown[question] = [name for name, _ in recognise_bands(obj)]
    return [keys.key_blocks[name] if name else None for name in _shown[question]]


# The last answer.
_shown: dict[tuple, list[str]] = {}


def recognise_bands(obj: bpy.types.Object) -> list[tuple[str, Likeness]]:
    """The name of every band's key today, "" if it was deleted; and how like the band it is."""
    return recognise(obj, "KEY", obj.data.shape_keys.spectral_tv.bands, any_copy=True)


def renew_bands(obj: bpy.types.Object) -> None:
    """Follow what the keys of bands are called today, and what rounding made of them."""
    bands = obj.data.shape_keys.spectral_tv.bands
    for band, (name, likeness) in zip(bands, recognise_bands(obj), strict=True):
        is_same = likeness == Likeness.SAME
        if is_same and (name, digests(obj, "KEY", [name])[name]) != (band.key, band.digest):
            band.take(obj, "KEY", name)


def topology_changed(obj: bpy.types.Object) -> bool:
    """Whether vertices or faces were added or removed since the decomposition."""
    record = obj.data.shape_keys.spectral_tv
    counts = len(obj.data.vertices), len(obj.data.loops)
    return counts != (record.vertex_count, record.corner_count)
