"""Which filter the bands of a function get: what the user chooses, and what it comes to."""

from typing import Any, Protocol

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..scene.notes import note
from ..scene.objects import Refusal
from . import filter_curve
from .gains import PRESETS, curve_values, idle_reason, preset_values, usual_band

FILTERS = (
    *(preset for preset in PRESETS if preset[0] != "RESET"),
    ("GAINS", "Gains", "A gain for every band: 0 removes it, 1 keeps it, 2 doubles it"),
    ("CURVE", "Filter Curve", "The curve of the panel Filter Curve: left is the finest band"),
)


# What the user is told of gains that are all 1.
KEEPS_ALL = "the filter changes nothing: it keeps every band"


class Chosen(Protocol):
    """What of a choice `filter_values` reads."""

    bands: int
    preset: str
    first: int
    last: int
    amount: float
    gains: str
    keep_rest: bool


def filter_values(choice: Chosen) -> list[float]:
    """What is added to every band, times the band: −1 removes it.

    That a filter changes nothing is noted. Raises Refusal if the gains are not one number per band,
    or there is no curve.
    """
    values = _values(choice)
    if choice.keep_rest and not any(values):
        range_ = choice.bands, choice.first, choice.last, choice.amount
        is_preset = choice.preset not in ("GAINS", "CURVE")
        reason = idle_reason(choice.preset, *range_) if is_preset else None
        note(reason or KEEPS_ALL)
    return values


def _values(choice: Chosen) -> list[float]:
    if choice.preset == "GAINS":
        try:
            gains = [float(word) for word in choice.gains.replace(",", " ").split()]
        except ValueError as error:
            raise Refusal(f"the gains are not numbers: {choice.gains!r}") from error
        if len(gains) != choice.bands or not np.isfinite(gains).all():
            raise Refusal(f"{choice.bands} bands need as many gains, not {choice.gains!r}")
        return [gain - 1 for gain in gains]
    if choice.preset == "CURVE":
        node = filter_curve.find()
        if node is None:
            raise Refusal("there is no filter curve")
        return curve_values(lambda position: filter_curve.evaluate(node, position), choice.bands)
    return preset_values(choice.preset, choice.bands, choice.first, choice.last, choice.amount)


def sidebar_band(end: str, **options: Any) -> Any:
    """A property of a sidebar's choices, "first" or "last": the usual band until one is chosen.

    What is chosen is in ``own_first`` and ``own_last``, which are 0 until then.
    """

    def get(choices: Any) -> int:
        own, other = getattr(choices, f"own_{end}"), choices.own_first or choices.own_last
        if own:
            return own
        usual = usual_band(choices.preset, choices.band_count())
        # So that one that is chosen stays the end that it is.
        return usual if not other else min(usual, other) if end == "first" else max(usual, other)

    def choose(choices: Any, value: int) -> None:
        setattr(choices, f"own_{end}", value)

    return IntProperty(get=get, set=choose, min=1, **options)


FIRST = {"name": "From", "description": "First of the chosen bands; 1 is the finest"}
LAST = {"name": "To", "description": "Last of the chosen bands; 1 is the finest"}


class SidebarFilter:
    """The chosen bands of a filter in a sidebar. Ahead of the other bases of a class, so that these
    properties take the place of the operator's."""

    own_first: IntProperty(options={"HIDDEN"})
    own_last: IntProperty(options={"HIDDEN"})
    first: sidebar_band("first", **FIRST)
    last: sidebar_band("last", **LAST)

    def band_count(self) -> int:
        """How many bands there are."""
        return self.bands


class FilterProperties:
    """The number of bands, of steps, and what happens to the bands."""

    bands: IntProperty(
        name="Bands", description="Number of bands, finest first", default=5, min=1, max=32
    )
    steps: IntProperty(
        name="Steps",
        description="Number of time steps of the flow. More steps are more accurate and separate "
        "scales more sharply",
        default=32,
        min=2,
        soft_max=128,
        max=1000,
    )
    preset: EnumProperty(
        name="Filter", description="What happens to the bands", items=FILTERS, default="LOW_PASS"
    )
    first: IntProperty(**FIRST, default=3, min=1)
    last: IntProperty(**LAST, default=3, min=1)
    amount: FloatProperty(
        name="Exaggerate by",
        description="How much is added to the chosen bands: 1 doubles them",
        default=1,
        soft_min=-1,
        soft_max=4,
    )
    gains: StringProperty(
        name="Gains",
        description="A number for every band, finest first, with spaces or commas between: "
        "0 removes it, 1 keeps it, 2 doubles it",
        default="0 0 1 1 1",
    )
    keep_rest: BoolProperty(
        name="Keep the Rest",
        description="Keep what no band holds: the values' largest spots and their mean",
        default=True,
    )

    def draw_filter(self, column: bpy.types.UILayout) -> None:
        """Lay out the filter, and only what has an effect."""
        column.prop(self, "preset")
        if self.preset == "GAINS":
            column.prop(self, "gains")
        elif self.preset != "CURVE":
            column.prop(self, "first")
            column.prop(self, "last")
        if self.preset == "EXAGGERATE":
            column.prop(self, "amount")
        column.prop(self, "keep_rest")
