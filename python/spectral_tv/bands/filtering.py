"""The filter of a function's bands: what the user chooses, and the gain of each band."""

from collections.abc import Callable

from spectral_tv.bands.gains import (
    PRESETS,
    curve_values,
    idle_reason,
    preset_values,
    too_few_steps,
)
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.options.declaring import Only, choice, integer, name_of, number, switch
from spectral_tv.refusal import Refusal

# A gain by the place of a band, from 0, the finest, to 1.
Curve = Callable[[float], float]
FILTERS = (
    *(preset for preset in PRESETS if preset[0] != "RESET"),
    ("GAINS", "Gains", "A gain for every band: 0 removes it, 1 keeps it, 2 doubles it"),
    ("CURVE", "Filter Curve", "The curve of the panel Filter Curve: left is the finest band"),
)


# What the user is told of gains that are all 1.
KEEPS_ALL = "the filter changes nothing: it keeps every band"
UNDER = Only("preset", [name for name, *_ in FILTERS if name not in ("GAINS", "CURVE")])
FILTERED = Only("result", ["FILTER"])
IN_BANDS = Only("result", ["FILTER", "BANDS"])


@dataclass(frozen=True)
class FilterSettings:
    """The number of bands, of steps, and what happens to the bands.

    A subclass has a ``result``, and the sizes ``finest`` and ``largest``.
    """

    bands: int = integer(
        "Bands", "Number of bands, finest first", 5, 1, 32, applies=IN_BANDS, place="bands"
    )
    steps: int = integer(
        "Steps",
        "Number of time steps of the flow. More steps are more accurate and separate scales more "
        "sharply", 32, 2, 1000, soft_most=128, place="steps"
    )  # fmt: skip
    preset: str = choice(
        "Filter", "What happens to the bands", FILTERS, "LOW_PASS", applies=FILTERED,
        place="filter", argument=""
    )  # fmt: skip
    gains: str = name_of(
        "Gains",
        "A number for every band, finest first, with spaces or commas between: 0 removes it, 1 "
        "keeps it, 2 doubles it", "0 0 1 1 1", applies=(FILTERED, Only("preset", ["GAINS"])),
        place="filter", argument=""
    )  # fmt: skip
    first: int = integer(
        "From",
        "First of the chosen bands; 1 is the finest", 3, 1, None, applies=(FILTERED, UNDER),
        place="filter", argument=""
    )  # fmt: skip
    last: int = integer(
        "To",
        "Last of the chosen bands; 1 is the finest", 3, 1, None, applies=(FILTERED, UNDER),
        place="filter", argument=""
    )  # fmt: skip
    amount: float = number(
        "Exaggerate by",
        "How much is added to the chosen bands: 1 doubles them", 1, None, None, soft_least=-1,
        soft_most=4, applies=(FILTERED, Only("preset", ["EXAGGERATE"])), place="filter",
        argument=""
    )  # fmt: skip
    keep_rest: bool = switch(
        "Keep the Rest",
        "Keep what no band holds: the values' largest spots and their mean", True, applies=FILTERED,
        place="filter", argument=""
    )  # fmt: skip

    def check(self, curve: Curve | None = None) -> None:
        """Raise Refusal if numbers, sizes or gains of bands make no sense."""
        if not IN_BANDS.holds(self):
            return
        if (reason := too_few_steps(self.bands, self.steps)) is not None:
            raise Refusal(reason)
        finest, largest = (getattr(self, name) for name in ("finest", "largest"))
        if finest >= largest:
            raise Refusal("the finest size is not below the largest")
        if FILTERED.holds(self):
            filter_values(self, curve)


def filter_values(choice: FilterSettings, curve: Curve | None = None) -> list[float]:
    """The multiple of each band that the filter adds: −1 removes the band.

    A filter that changes nothing is noted. Raises Refusal if the gains are not one number per band,
    or a curve is chosen and there is none.
    """
    which = choice.preset, choice.bands, choice.first, choice.last, choice.amount
    values = preset_values(*which) if UNDER.holds(choice) else _values(choice, curve)
    if choice.keep_rest and not any(values):
        note((UNDER.holds(choice) and idle_reason(*which)) or KEEPS_ALL)
    return values


def _values(choice: FilterSettings, curve: Curve | None) -> list[float]:
    """Those of single gains, or of the curve."""
    if choice.preset == "GAINS":
        try:
            gains = [float(word) for word in choice.gains.replace(",", " ").split()]
        except ValueError as error:
            raise Refusal(f"the gains are not numbers: {choice.gains!r}") from error
        if len(gains) != choice.bands or not np.isfinite(gains).all():
            raise Refusal(f"{choice.bands} bands need as many gains, not {choice.gains!r}")
        return [gain - 1 for gain in gains]
    if curve is None:
        raise Refusal("there is no filter curve")
    return curve_values(curve, choice.bands)
