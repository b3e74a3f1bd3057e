"""The filter of a function's bands in a sidebar."""

from typing import Any

from bpy.props import IntProperty
from spectral_tv.bands.filtering import FilterSettings
from spectral_tv.bands.gains import usual_band
from spectral_tv.options.declaring import options_of


def sidebar_band(end: str) -> Any:
    """A sidebar's property "first" or "last": the usual band until the user chooses one.

    The choice is kept in ``own_first`` and ``own_last``, which are 0 until then.
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

    option = options_of(FilterSettings)[end]
    return IntProperty(get=get, set=choose, min=1, name=option.label, description=option.text)


class SidebarFilter:
    """The chosen bands of a filter in a sidebar. Ahead of the other bases of a class, so that these
    properties take the place of the operator's."""

    own_first: IntProperty(options={"HIDDEN"})
    own_last: IntProperty(options={"HIDDEN"})
    first: sidebar_band("first")
    last: sidebar_band("last")

    def band_count(self) -> int:
        """How many bands there are."""
        return self.bands
