"""The settings of a segmentation."""

from typing import Literal

from spectral_tv.dataclass import dataclass
from spectral_tv.options.declaring import integer, several

# What is decomposed, by which method, and the part of the work that it is.
METHOD: Literal["m2"] = "m2"
DECOMPOSING = 0.95
OUTPUTS = (
    ("COLOR", "Colors", "A color attribute named Segment", "COLOR", 1),
    ("GROUPS", "Vertex Groups", "A vertex group per part", "GROUP_VERTEX", 2),
    (
        "FACE_SETS",
        "Face Sets",
        "A face set per part, for sculpting. Your own are kept as an attribute",
        "FACE_MAPS",
        4,
    ),
)


@dataclass(frozen=True)
class Settings:
    """How many parts are found by what, and how they are written."""

    segments: int = integer("Segments", "Number of parts", 6, 1, 64, place="parts")
    steps: int = integer(
        "Steps",
        "Number of time steps of the flow. More steps find the same parts in more different poses",
        48, 4, 1000, place="parts"
    )  # fmt: skip
    seed: int = integer("Seed", "Of the random starts", 0, 0, None, place="seed")
    outputs: frozenset[str] = several(
        "Write", "How the parts are written", OUTPUTS, ("COLOR", "GROUPS"), place="outputs"
    )
