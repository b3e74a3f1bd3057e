"""The settings of work on files: Blender's, without what only Blender has."""

from spectral_tv.attributes import settings as attributes
from spectral_tv.bands.limits import LimitSettings
from spectral_tv.bands.settings import BASES, Settings
from spectral_tv.dataclass import dataclass
from spectral_tv.deformation import settings as deformation
from spectral_tv.options.declaring import Only, redeclared
from spectral_tv.segmentation import settings as segmentation

NUMBERS = "numbers at the vertices of the file, by their name"


@dataclass(frozen=True)
class ReadingSettings:
    """How surfaces are read."""

    weld: float = redeclared(Settings, "weld")
    leaves_out: bool = redeclared(Settings, "leaves_out")


@dataclass(frozen=True)
class FileSettings(Settings):
    """Arguments of a decomposition; see `Settings`."""

    base: str = redeclared(
        Settings, "base", items=tuple(each for each in BASES if each[0] != "KEY"), other=("", "")
    )
    vertex_group: str = redeclared(
        Settings,
        "vertex_group",
        text="Limits where the bands have an effect, from 0 to 1: " + NUMBERS,
    )
    shape: str = redeclared(Settings, "shape", argument="")
    bands_as: str = redeclared(Settings, "bands_as", argument="")
    heights: bool = redeclared(Settings, "heights", argument="")


@dataclass(frozen=True)
class FileLimit(LimitSettings):
    """How far bands may move a vertex."""

    limit: float = redeclared(
        LimitSettings,
        "limit",
        text="No vertex is moved further than this by the bands, in the file's unit; 0 is no limit",
    )


@dataclass(frozen=True)
class AccuracySettings(FileSettings):
    """What is measured: all steps, and nothing is limited."""

    accuracy: float = redeclared(FileSettings, "accuracy", argument="", refused=False)
    vertex_group: str = redeclared(FileSettings, "vertex_group", argument="")


@dataclass(frozen=True)
class FlowSettings(ReadingSettings, attributes.Settings):
    """What is flowed."""

    kind: str = redeclared(
        attributes.Settings,
        "kind",
        items=tuple(each for each in attributes.KINDS if each[0] in ("ATTRIBUTE", "COLOR")),
    )
    source: str = redeclared(
        attributes.Settings,
        "source",
        text=f"Which attribute: {NUMBERS}; the only ones if left empty",
        applies=(Only("kind", ["ATTRIBUTE"]),),
        refused=True,
    )
    bands: int = redeclared(attributes.Settings, "bands", refused=True)
    elements: str = redeclared(attributes.Settings, "elements", refused=True)
    size: float = redeclared(attributes.Settings, "size", refused=True)
    finest: float = redeclared(attributes.Settings, "finest", refused=True)
    largest: float = redeclared(attributes.Settings, "largest", refused=True)


@dataclass(frozen=True)
class DeformSettings(ReadingSettings, deformation.Settings):
    """How the unconstrained vertices follow."""


@dataclass(frozen=True)
class SegmentSettings(ReadingSettings, segmentation.Settings):
    """How many parts are found by what."""
