"""Bands taken from a surface that has other vertices: what the user chooses, and what is told."""

from __future__ import annotations

import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.options.declaring import choice, number

FITS = (
    ("none", "None", "Both are in the same place and pose already"),
    (
        "rigid",
        "Rigid",
        "The other object is first turned and moved to where it fits best, as a whole",
    ),
    (
        "similar",
        "Similar",
        "The other object is first turned, moved and scaled to where it fits best",
    ),
)


@dataclass(frozen=True)
class TakeSettings:
    """How the other surface is looked for."""

    within: float = number(
        "Within",
        "How far the other surface may be where it has other vertices. What is farther, or faces "
        "away, is missed", 5, 0, 100, soft_most=20, digits=2, is_size=True, place="take"
    )  # fmt: skip
    fit: str = choice(
        "Fit First", "What is done first to a surface of other vertices", FITS, place="take"
    )


def told_fit(taken: spectral_tv.Transfer) -> str:
    """What a fit did, but for lengths: ``turned by 23° and scaled by 1.02``."""
    cosine = (np.trace(taken.fit[:3, :3]) / taken.scale - 1) / 2
    angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    return f"turned by {angle:.3g}° and scaled by {taken.scale:.4g}"
