"""What is chosen of a recipe: which one, and how strong."""

from spectral_tv.bands.limits import limit_option
from spectral_tv.dataclass import dataclass
from spectral_tv.options.declaring import name_of, number

from . import own


def _names(_choices, _context, _text: str) -> list[str]:
    return own.names()


@dataclass(frozen=True)
class RecipeSettings:
    """A recipe by its name, or the path of its file; its strength; how far it may move vertices."""

    recipe: str = name_of(
        "Recipe", "The name of a recipe, or the path of its file", "Exaggerate Skin",
        search=_names
    )  # fmt: skip
    strength: float = number(
        "Strength", "0 changes nothing, 1 is usual, 2 is twice as much", 1, 0, 5,
        soft_most=2, digits=2, place="strength"
    )  # fmt: skip
    limit: float = limit_option(place="strength")
