"""Ways to deform that are there for comparison."""

import numpy as np
import spectral_tv
from spectral_tv.notes import note

from ...job.steps import Steps
from ..constraints import label_of
from .solver import Solved, Solver, came_along
from .total_variation import of_optimum

# The part of its total variation that the paper's algorithm may waste without a word.
WASTE = 0.03


class Comparison(Solver):
    """An algorithm of spectral_tv.deform, by its name."""

    def start(self, targets: np.ndarray) -> Steps[Solved]:
        def steps():
            result = yield (
                spectral_tv.start_deform(
                    self.mesh,
                    self.grips.indices,
                    targets,
                    self.grips.weights,
                    algorithm=self.settings.algorithm.lower(),
                ),
                1.0,
            )
            return Solved(result)

        return Steps(steps())


class Reweighted(Comparison):
    """The paper's Algorithm 1, which may end away from the optimum."""

    def message(self, solved: Solved) -> str:
        result, how = solved.result, ""
        if result.gap > WASTE:
            note(
                f"up to {result.gap:.0%} of the total variation could be spared: "
                f"{label_of('PAPER')} ended away from the optimum, which {label_of('CONVEX')} finds"
            )
        else:
            how = of_optimum(result)
        return f"deformed{how}{came_along(result)}"
