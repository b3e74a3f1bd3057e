"""What a recipe is."""

from spectral_tv.bands.settings import Settings
from spectral_tv.dataclass import dataclass


@dataclass(frozen=True)
class Recipe:
    """A decomposition and a filter: the values of its bands at strength 1, finest first.

    One that ``cleans`` has no values of its own: it finds the noise of a shape, and which bands
    hold that.
    """

    name: str
    text: str
    settings: Settings
    values: tuple[float, ...] = ()
    cleans: bool = False
    icon: str = "NONE"

    def scaled(self, strength: float) -> list[float]:
        """The values at a strength. A band that is gone at −1 is not turned over beyond."""
        return [max(strength * value, min(value, -1.0)) for value in self.values]
