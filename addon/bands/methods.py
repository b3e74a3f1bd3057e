"""The methods that split off bands: what they are called, and what each of them takes."""

from dataclasses import dataclass

from ..options.declaring import Only


@dataclass(frozen=True)
class Method:
    """A method, by the name of its property and what menus say."""

    name: str
    label: str
    text: str
    takes_steps: bool = True
    takes_base: bool = False
    # Or one band that holds all detail.
    has_bands: bool = True

    @property
    def package(self) -> str:
        """What the package calls it."""
        return self.name.lower().partition("_p")[0]

    @property
    def p(self) -> int | None:
        """The exponent, where there are several of the same name."""
        exponent = self.name.partition("_P")[2]
        return int(exponent) if exponent else None

    @property
    def item(self) -> tuple[str, str, str]:
        """As one of a menu."""
        return self.name, self.label, self.text

    @property
    def key_label(self) -> str:
        """What the names of its shape keys begin with."""
        return self.name if len(self.name) == 2 else self.name.replace("_", " ").title()


OF_THE_PAPER = (
    Method("M1", "Shape Detail",
           "Surface detail of every size, the body undistorted (M1, shape TV)"),
    Method("M2", "Limbs and Head", "Limbs, head, ears, tail (M2, conformalized 3-Laplace)"),
    Method("M3", "Edge-Keeping Detail",
           "Detail with crisp edges: plates, folds (M3, directional TV)", takes_base=True),
)  # fmt: skip
COMPARISONS = (
    Method("NAIVE", "Per Axis", "Each axis alone, which squares the shape along its axes"),
    Method("HEAT", "Heat", "Linear diffusion, which blurs edges"),
    Method("LB", "Eigenfunctions",
           "Waves on the surface, from fine to coarse (Laplace–Beltrami eigenfunctions). The first "
           "band is what they do not hold", takes_steps=False),
    Method("DISPLACEMENT", "Displacement",
           "All detail as one band: the displacement from the smoothed shape (Cignoni et al. 2005)",
           takes_steps=False, takes_base=True, has_bands=False),
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


def _only(attribute: str, otherwise: str = "") -> Only:
    names = [name for name, each in METHODS.items() if getattr(each, attribute)]
    return Only("method", names, otherwise=otherwise)


# Of what methods options are.
IN_STEPS = _only("takes_steps", "takes no time steps")
WITH_BASE = _only("takes_base")
WITH_BANDS = _only("has_bands")
EIGENFUNCTIONS, DIRECTIONAL = Only("method", ["LB"]), Only("method", ["M3"])
