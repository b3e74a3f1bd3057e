"""What a mesh remembers of its decomposition, kept in the file.

A record names the shape key of each band and has its fingerprint. So bands are found again after
keys were renamed, reordered or sculpted, and no other key is taken for a band.
"""

import uuid

import bpy
import numpy as np
from bpy.props import BoolProperty, CollectionProperty, FloatProperty, IntProperty, StringProperty

from .contents import topology_digest
from .fingerprints import Fingerprint, Likeness, digests, recognise
from .keeping import PLACES, Band, Keeping


class SpectralTVBand(Fingerprint, bpy.types.PropertyGroup):
    """One band: the shape key it is, and the times it covers."""

    given: StringProperty(name="Given", description="The name that it was given")
    start: FloatProperty(name="Start", description="Time at which the band starts, length²")
    end: FloatProperty(name="End", description="Time at which the band ends, length²")
    is_sculpted: BoolProperty(
        name="Sculpted", description="It was when the others were last cut anew"
    )
    was_muted: BoolProperty(
        name="Was Muted", description="Before another band was soloed",
        override={"LIBRARY_OVERRIDABLE"}
    )  # fmt: skip


class SpectralTVSample(bpy.types.PropertyGroup):
    """One component of the spectrum, in files of older versions."""

    time: FloatProperty(name="Time", description="Length²")
    strength: FloatProperty(name="Strength", description="Length³")


class SpectralTVRecord(bpy.types.PropertyGroup):
    """The last decomposition of a mesh."""

    # Of 0.1.0; today a mark of the block, see keeping.
    owner = bpy.types.Key, "spectral_tv", "LIBRARY_OVERRIDABLE"

    identifier: StringProperty(name="Identifier", description="Of the flow, while it is in memory")
    kept: StringProperty(name="Kept", description="Where the bands are", default="KEYS")
    method: StringProperty(name="Method")
    settings: StringProperty(name="Settings", description="What it was decomposed by, as JSON")
    area: FloatProperty(name="Area", description="Of the surface in world space, length²")
    topology: StringProperty(name="Topology", description="Digest of the polygons")
    vertex_count: IntProperty(name="Vertices")
    corner_count: IntProperty(name="Face Corners")
    solo: IntProperty(
        name="Solo", description="The band that is heard alone, from 1; 0 if none is",
        override={"LIBRARY_OVERRIDABLE"}
    )  # fmt: skip
    bands: CollectionProperty(type=SpectralTVBand, override={"LIBRARY_OVERRIDABLE"})
    components: StringProperty(
        name="Components", description="Times, length², and strengths, length³, by turns"
    )
    spectrum: CollectionProperty(type=SpectralTVSample)

    def keep_spectrum(self, times: np.ndarray, strengths: np.ndarray) -> None:
        """Keep the spectrum: of each component the time (N,) and the strength (N,)."""
        # As a text, which takes a hundredth of what a collection does.
        numbers = np.column_stack([times, strengths]).astype(np.float32).ravel()
        self.components = " ".join(f"{number:.9g}" for number in numbers)
        self.spectrum.clear()

    @property
    def kept_spectrum(self) -> np.ndarray:
        """The times and the strengths, (N, 2)."""
        samples = [(sample.time, sample.strength) for sample in self.spectrum]
        return np.array(samples or self.components.split(), dtype=np.float32).reshape(-1, 2)


def record_of(obj: bpy.types.Object | None) -> SpectralTVRecord | None:
    """The record of a mesh object's decomposition, or None."""
    if obj is None or obj.type != "MESH":
        return None
    record = obj.data.spectral_tv.decomposition
    if record.bands:
        return record if keeping_of(record).is_marked(obj.data, record.identifier) else None
    keys = obj.data.shape_keys
    if keys is not None and keys.spectral_tv.bands:  # of 0.1.0
        return keys.spectral_tv
    return None


def keeping_of(record: SpectralTVRecord) -> Keeping:
    """Where its bands are kept."""
    return PLACES[record.kept]


def new_identity(obj: bpy.types.Object, record: SpectralTVRecord) -> None:
    """Have a record be of no flow so far, and of the vertices and faces that there are."""
    record.identifier = uuid.uuid4().hex
    if record.id_data == obj.data:
        keeping_of(record).mark(obj.data, record.identifier)
    record.topology = topology_digest(obj.data)
    record.vertex_count = len(obj.data.vertices)
    record.corner_count = len(obj.data.loops)


def forget(record: SpectralTVRecord) -> None:
    """Clear a record, as its bands are no bands any more."""
    record.bands.clear()
    record.keep_spectrum([], [])
    record.solo = 0
    record.id_data.update_tag()


def forget_stale(*_arguments: object) -> None:
    """Clear the records of bands that were all removed, which Blender tells nobody."""
    for mesh in bpy.data.meshes:
        if mesh.library is None and mesh.is_property_set("spectral_tv"):
            record = mesh.spectral_tv.decomposition
            if record.bands and not keeping_of(record).is_marked(mesh, record.identifier):
                forget(record)


def bands_of(obj: bpy.types.Object) -> list[Band | None]:
    """The bands, None for those that were deleted."""
    there = keeping_of(record_of(obj)).all(obj.data)
    return [there[name] if name else None for name, _ in recognise_bands(obj)]


def bands_shown(obj: bpy.types.Object) -> list[Band | None]:
    """The same for panels, which ask at every redraw: known again only when names change."""
    record = record_of(obj)
    there = keeping_of(record).all(obj.data)
    question = (obj.data.session_uid, record.identifier, *there.keys())
    if question not in _shown:
        _shown.clear()
        _shown[question] = [name for name, _ in recognise_bands(obj)]
    return [there[name] if name else None for name in _shown[question]]


# The last answer.
_shown: dict[tuple, list[str]] = {}


def recognise_bands(obj: bpy.types.Object) -> list[tuple[str, Likeness]]:
    """The name of every band today, "" if it was deleted; and how like the band it is."""
    record = record_of(obj)
    return recognise(obj, keeping_of(record).written, record.bands, any_copy=True)


def renew_bands(obj: bpy.types.Object) -> None:
    """Follow what bands are called today, and what rounding made of them."""
    record = record_of(obj)
    written = keeping_of(record).written
    for band, (name, likeness) in zip(record.bands, recognise_bands(obj), strict=True):
        is_same = likeness == Likeness.SAME
        if is_same and (name, digests(obj, written, [name])[name]) != (band.key, band.digest):
            band.take(obj, written, name)


def topology_changed(obj: bpy.types.Object) -> bool:
    """Whether vertices or faces were added or removed since the decomposition."""
    record = record_of(obj)
    counts = len(obj.data.vertices), len(obj.data.loops)
    return counts != (record.vertex_count, record.corner_count)
