"""What faces may do under bands, and clamping what they add."""

import argparse

from spectral_tv import _native
from spectral_tv.dataclass import dataclass
from spectral_tv.options.declaring import number

# How many times its length an edge may become, where nothing else is asked for.
STRETCH: float = _native._STRETCH


@dataclass(frozen=True)
class GuardSettings:
    """What counts as too much."""

    stretch: float = number(
        "Stretch", "How many times its length an edge may become", STRETCH, 1.01, 100,
        soft_most=10, digits=2, place="guard"
    )  # fmt: skip


def add_safe(parser: argparse.ArgumentParser, result: str) -> None:
    """Declare that gains are clamped; ``result`` says what the clamped shape becomes."""
    parser.add_argument(
        "--safe",
        action="store_true",
        help="add less of what gains above 1 add where it would fold faces or stretch them beyond "
        f"{GuardSettings.stretch:g} times their length; {result}. What gains below 1 take away is "
        "not clamped",
    )


def advice_of(is_added: bool) -> str:
    """What to do about faces that fold, where bands add something."""
    return "; --safe clamps what they add" if is_added else ""
