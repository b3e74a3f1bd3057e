"""Ways to deform that are there for comparison."""

from __future__ import annotations

from collections.abc import Generator
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.deformation.settings import label_of
from spectral_tv.deformation.solvers.solver import Solved, Solver, came_along
from spectral_tv.deformation.solvers.total_variation import of_optimum
from spectral_tv.jobs.steps import Step, Steps
from spectral_tv.later import np
from spectral_tv.notes import note

if TYPE_CHECKING:
    from numpy.typing import NDArray

# The part of its total variation that the paper's algorithm may waste without a word.
WASTE = 0.03


class Comparison(Solver):
    """An algorithm of spectral_tv.deform, by its name."""

    def start(self, targets: NDArray[np.float64]) -> Steps[Solved]:
        """Solve for ``targets`` (K, 3) of the grips, in a thread."""
        algorithm: Any = self.settings.algorithm.lower()

        def steps() -> Generator[Step, Any, Solved]:
            result = yield (
                spectral_tv.start_deform(
                    self.mesh,
                    self.held.indices,
                    targets,
                    self.held.weights,
                    algorithm=algorithm,
                ),
                1.0,
            )
            return Solved(result)

        return Steps(steps())


class Reweighted(Comparison):
    """The paper's Algorithm 1, which may end away from the optimum."""

    def message(self, solved: Solved) -> str:
        """What a result says about itself, for the user; notes what is wrong with it."""
        result, how = solved.result, ""
        if result.gap > WASTE:
            note(
                f"up to {result.gap:.0%} of the total variation could be spared: "
                f"{label_of('PAPER')} ended away from the optimum, which {label_of('CONVEX')} finds"
            )
        else:
            how = of_optimum(result)
        return f"deformed{how}{came_along(result)}"
