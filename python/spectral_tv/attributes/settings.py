"""The settings of a flow on a mesh; sizes are percentages of the square root of its area."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.bands.filtering import IN_BANDS, FilterSettings
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.options.declaring import Only, choice, name_of, number, switch

if TYPE_CHECKING:
    from numpy.typing import NDArray

KINDS = (
    ("ATTRIBUTE", "Attribute", "An attribute of the mesh", "SPREADSHEET", 0),
    ("COLOR", "Color Attribute", "A color attribute of the mesh", "COLOR", 1),
    ("GROUP", "Vertex Group", "The weights of a vertex group", "GROUP_VERTEX", 2),
    ("KEY", "Shape Key", "How far a shape key moves the vertices", "SHAPEKEY_DATA", 3),
)

RESULTS = (
    ("FLOW", "Smoothed", "The values, flowed until spots of the chosen size are gone"),
    ("FILTER", "Filtered", "The values with their bands kept, removed or amplified"),
    ("BANDS", "Bands", "Every band of the values, and the rest; they add up to the values"),
)
LAWS = (
    ("TV", "Total Variation", "Edges stay crisp: every spot keeps its outline until it is gone"),
    ("HEAT", "Heat", "Linear diffusion, which blurs edges; for comparison"),
)
ELEMENTS = (
    ("AUTOMATIC", "Automatic", "Edges for groups, masks and others with two values, "
     "Vertices for others and for large meshes"),
    ("VERTICES", "Vertices", "For smooth values. Sets fade 2 to 7 % too fast"),
    ("EDGES", "Edges", "Sets fade at their true rates, whatever the triangles; two to three times "
     "slower"),
)  # fmt: skip
SIZE = "relative to the object's size. A round spot of this width is gone"


def _size(label: str, text: str, default: float, least: float, soft_most: float, on: Only) -> Any:
    return number(
        label, text, default, least, 1000, soft_most=soft_most, unit="PERCENTAGE", digits=2,
        applies=on, place="sizes"
    )  # fmt: skip


def elements(applies: tuple[Only, ...] = ()) -> Any:
    """Where the unknowns of an exact flow are."""
    return choice(
        "Elements", "What values are made of while they flow", ELEMENTS, applies=applies,
        dims=True, place="law"
    )  # fmt: skip


def chosen_elements(choice: str, values: NDArray[np.float64]) -> str:
    """The package's name of the elements for ``values`` (V,) or (V, C), exactly flowed; tells why
    those of a set on a large mesh are not edges."""
    if choice != "AUTOMATIC":
        return choice.lower()
    suiting = spectral_tv.suiting_elements(values)
    if suiting == "vertices" and spectral_tv.suiting_elements(np.unique(values, axis=0)) == "edges":
        note(
            f"flowed on vertices, where sets fade 2 to 7 % too fast, as the mesh has "
            f"{len(values)} of them; Elements: Edges has true rates, and takes longer"
        )
    return suiting


@dataclass(frozen=True)
class Settings(FilterSettings):
    """What is flowed, how, and what of it is written."""

    kind: str = choice("Flow", "What is flowed", KINDS, place="source")
    source: str = name_of("Name", "Which one; the active one if left empty", place="source")
    result: str = choice("Write", "What is written", RESULTS, place="source")
    law: str = choice("By", "How the values flow", LAWS, place="law")
    exact: bool = switch(
        "Exact",
        "Follow Total Variation exactly: spots fade in a straight line until they are gone. "
        "Otherwise faster, and faint remains may stay", True, applies=Only("law", ["TV"]),
        dims=True, place="law"
    )  # fmt: skip
    elements: str = elements((Only("law", ["TV"]), Only("exact", [True])))
    size: float = _size(
        "Size",
        f"How far to flow, {SIZE}: with Total Variation if it stands out by the whole range of the "
        "values, and sooner the less it does", 10, 0.01, 100, Only("result", ["FLOW"])
    )  # fmt: skip
    finest: float = _size(
        "Finest",
        f"Where the first band ends, about, {SIZE} from there on", 1, 0.001, 50, IN_BANDS
    )  # fmt: skip
    largest: float = _size(
        "Largest",
        f"Where the last band ends, {SIZE} there. What is larger stays in the rest", 40, 0.01, 100,
        IN_BANDS
    )  # fmt: skip

    @property
    def is_exact(self) -> bool:
        """Whether the flow is followed exactly."""
        return self.exact and self.law == "TV"
