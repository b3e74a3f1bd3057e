"""What a mesh remembers of one decomposition, kept in the file.

A record names the shape key of each band and has its fingerprint. So bands are found again after
keys were renamed, reordered or sculpted, and no other key is taken for a band.
"""

from collections.abc import Callable

import bpy
from bpy.props import BoolProperty, CollectionProperty, FloatProperty, IntProperty, StringProperty
from spectral_tv.later import np

from .fingerprints import Fingerprint


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
    was_silent: BoolProperty(
        name="Was Silent", description="It was muted before the original was shown",
        override={"LIBRARY_OVERRIDABLE"}
    )  # fmt: skip


class SpectralTVSample(bpy.types.PropertyGroup):
    """One component of the spectrum, in files of older versions."""

    time: FloatProperty(name="Time", description="Length²")
    strength: FloatProperty(name="Strength", description="Length³")


# What of a band's name comes after that of its decomposition.
LABEL = " Band "
# Where bands are unless a record says otherwise.
USUAL = "KEYS"

# What follows a record that is named. Each is called with the record.
NAMED: list[Callable[["SpectralTVRecord"], None]] = []


def _named(record: "SpectralTVRecord", _context: bpy.types.Context) -> None:
    for follow in NAMED:
        follow(record)


class SpectralTVRecord(bpy.types.PropertyGroup):
    """One decomposition of a mesh."""

    # Of 0.1.0; today a mark of the block, see keeping.
    owner = bpy.types.Key, "spectral_tv", "LIBRARY_OVERRIDABLE"

    name: StringProperty(
        name="Name",
        description="Of the decomposition. The names of its bands begin with it, unless you gave "
        "them others",
        update=_named,
    )
    identifier: StringProperty(name="Identifier", description="Of the flow, while it is in memory")
    mark: StringProperty(name="Mark", description="Of where the bands are; of old the identifier")
    kept: StringProperty(name="Kept", description="Where the bands are", default=USUAL)
    method: StringProperty(name="Method")
    recipe: StringProperty(name="Recipe", description="By which it was made, if by one")
    settings: StringProperty(name="Settings", description="What it was decomposed by, as JSON")
    area: FloatProperty(name="Area", description="Of the surface in world space, length²")
    scale: FloatProperty(
        name="Scale", description="Of the object in world space then; 0 if that is not known"
    )
    is_part: BoolProperty(
        name="Part", description="Its object was decomposed together with others, as one surface"
    )
    topology: StringProperty(name="Topology", description="Digest of the polygons")
    vertex_count: IntProperty(name="Vertices")
    corner_count: IntProperty(name="Face Corners")
    solo: IntProperty(
        name="Solo", description="The band that is heard alone, from 1; 0 if none is",
        override={"LIBRARY_OVERRIDABLE"}
    )  # fmt: skip
    limit: FloatProperty(
        name="Limit", description="How far its bands may move a vertex, in the scene's unit, since "
        "that was limited; 0 if it was not", subtype="DISTANCE"
    )  # fmt: skip
    shows_original: BoolProperty(
        name="Shows Original", description="Its bands are muted for a while, to show what is "
        "without them", override={"LIBRARY_OVERRIDABLE"}
    )  # fmt: skip
    bands: CollectionProperty(type=SpectralTVBand, override={"LIBRARY_OVERRIDABLE"})
    components: StringProperty(
        name="Components", description="Times, length², and strengths, length³, by turns"
    )
    spectrum: CollectionProperty(type=SpectralTVSample)

    def keep_spectrum(self, times: "np.ndarray", strengths: "np.ndarray") -> None:
        """Keep the spectrum: of each component the time (N,) and the strength (N,)."""
        # As a text, which takes a hundredth of what a collection does.
        numbers = np.column_stack([times, strengths]).astype(np.float32).ravel()
        self.components = " ".join(f"{number:.9g}" for number in numbers)
        self.spectrum.clear()

    @property
    def kept_spectrum(self) -> "np.ndarray":
        """The times and the strengths, (N, 2)."""
        samples = [(sample.time, sample.strength) for sample in self.spectrum]
        return np.array(samples or self.components.split(), dtype=np.float32).reshape(-1, 2)
