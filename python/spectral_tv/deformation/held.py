"""What holds and moves a surface."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import note

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Painted weights reach 1 and 0 but for rounding.
EXACT, NOTHING = 0.999, 1e-3


@dataclass(frozen=True)
class Held:
    """The constrained vertices of a mesh: ``indices`` (K,) and ``weights`` (K,) in (0, 1].

    ``bodies`` gives the numbers of the bodies that turn freely, (K,), −1 for vertices that go to
    their targets; it may raise Refusal.
    """

    mesh: spectral_tv.Mesh
    indices: NDArray[np.int64]
    weights: NDArray[np.float64]
    bodies: Callable[[], NDArray[np.int64]]


def constraining(
    weights: NDArray[np.floating[Any]],
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Which of several vertices their weights (V,) constrain, (V,), and the weights of those in
    (0, 1]."""
    is_in = weights > NOTHING
    rounded = np.where(weights >= EXACT, 1.0, weights.astype(np.float64))
    return is_in, rounded[is_in]


def note_soft_pin(name: str, weights: NDArray[np.float64]) -> None:
    """Note if nothing holds a part by its whole weight."""
    if weights.max() < 1:
        note(
            f"no vertex of the pin {name!r} has the weight 1, it gives way: the largest is "
            f"{weights.max():.2g}"
        )
