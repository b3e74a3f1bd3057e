"""The mix of bands without what folds and stretches faces."""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.bands.counts import Counts
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.steps import Step, Steps, in_turn
from spectral_tv.later import np
from spectral_tv.notes import note

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Clamped:
    """What became of the surface: the share (N,) of what is added that its vertices keep, and how
    much that is of the whole; how many of its triangles cross others without bands, with the mix,
    and with the clamped one.
    """

    shares: NDArray[np.float64]
    kept: float
    crossing: tuple[int, int, int]

    def told(self, before: Counts, after: Counts, names: str, *, takes: bool) -> str:
        """What was done, by what the mix and the clamped one do, and the names of the latter.

        Notes what clamping did not mend; ``takes`` tells whether bands below 0 take something away.
        """
        without, crossing, still = self.crossing
        if after and takes:
            note(f"what bands below 0 take away is not clamped: with it {after.told()}")
        elif after:
            note(f"{after.told()} all the same, by rounding or as faces bend")
        if still > without:
            note(
                "parts meet that lie apart, which clamping does not prevent: "
                f"{still} triangles cross"
            )
        done = (
            f"{before.told()} in the mix; {after.told()} in {names}, which keeps "
            f"{_percent(self.kept)} of what the bands add"
        )
        if max(crossing, still) > without:
            done += (
                f"; {crossing} triangles cross others in the mix, {still} in {names}, {without} "
                "without the bands"
            )
        return done


def start_clamping(
    mesh: spectral_tv.Mesh,
    taken: NDArray[np.float64],
    added: NDArray[np.float64],
    stretch: float,
) -> Steps[Clamped]:
    """Clamp what is added (N, 3) to a mesh in the shape that is left when something is taken away
    (N, 3), and look for triangles that cross.
    """
    cross = partial(spectral_tv.start_self_intersections, mesh)
    safe = partial(spectral_tv.start_safe_displacement, mesh, added, stretch)

    def steps() -> Generator[Step, Any, Clamped]:
        found = yield from in_turn([safe, partial(cross, -taken), partial(cross, added)], 0.75)
        clamped = found[0]
        after = yield cross(clamped.displacement), 1.0
        without, crossing, still = (len(each) for each in (*found[1:], after))
        return Clamped(clamped.shares, clamped.kept, (without, crossing, still))

    return Steps(steps())


def _percent(share: float) -> str:
    # Never all, unless it is all.
    return "all" if share == 1 else f"{np.floor(1000 * share) / 10:g} %"
