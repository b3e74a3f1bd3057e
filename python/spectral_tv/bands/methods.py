"""The methods that split off bands: what they are called, and what each of them takes."""

from typing import Any

import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.options.declaring import Only


@dataclass(frozen=True)
class Method:
    """A method, by the name of its property and what menus say."""

    name: str
    label: str
    text: str
    # How much of limbs its bands leave where nothing else is asked for.
    keep_limbs: float = 0.0

    @property
    def package(self) -> Any:
        """What the package calls it."""
        return self.name.lower().partition("_p")[0]

    @property
    def p(self) -> int | None:
        """The exponent, where there are several of the same name."""
        exponent = self.name.partition("_P")[2]
        return int(exponent) if exponent else None

    def takes(self, option: str) -> bool:
        """Whether an option of the package is for it."""
        return option in spectral_tv.METHODS[self.package].options

    @property
    def takes_steps(self) -> bool:
        """Whether it flows in steps."""
        return spectral_tv.METHODS[self.package].takes_steps

    @property
    def has_bands(self) -> bool:
        """Whether it has bands between times, or one that holds all detail."""
        return self.takes("times")

    @property
    def item(self) -> tuple[str, str, str]:
        """As one of a menu."""
        return self.name, self.label, self.text


OF_THE_PAPER = (
    Method("M1", "Shape Detail",
           "Surface detail of every size, the body undistorted (M1, shape TV)", keep_limbs=1.0),
    Method("M2", "Limbs and Head", "Limbs, head, ears, tail (M2, conformalized 3-Laplace)"),
    Method("M3", "Edge-Keeping Detail",
           "Detail with crisp edges: plates, folds (M3, directional TV)"),
)  # fmt: skip
COMPARISONS = (
    Method("NAIVE", "Per Axis", "Each axis alone, which squares the shape along its axes"),
    Method("HEAT", "Heat", "Linear diffusion, which blurs edges"),
    Method("LB", "Eigenfunctions",
           "Waves on the surface, from fine to coarse (Laplace–Beltrami eigenfunctions). The first "
           "band is what they do not hold"),
    Method("DISPLACEMENT", "Displacement",
           "All detail as one band: the displacement from the smoothed shape (Cignoni et al. "
           "2005)"),
    Method("M2_P2", "M2 with P = 2", "Conformalized mean curvature flow, of which M2 is made"),
    Method("M2_P1", "M2 with P = 1", "The conformalized 1-Laplace"),
)  # fmt: skip
METHODS = {each.name: each for each in (*OF_THE_PAPER, *COMPARISONS)}
# As the items of a menu, comparison methods apart.
ITEMS = (
    ("", "Methods", ""),
    *(each.item for each in OF_THE_PAPER),
    ("", "For Comparison", ""),
    *(each.item for each in COMPARISONS),
)


def taking(option: str, otherwise: str = "") -> Only:
    """The condition that the method takes an option of the package."""
    names = [name for name, each in METHODS.items() if each.takes(option)]
    return Only("method", names, otherwise=otherwise)


WITH_BANDS, WITH_BASE = taking("times"), taking("base")
