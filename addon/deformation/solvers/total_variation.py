"""Total variation of displacements: rigid pieces that shift, the paper's deformation."""

from collections.abc import Sequence

import numpy as np
import spectral_tv

from ...job.steps import Steps
from .solver import Follower, Solved, Solving, came_along

# A rough answer this far from the optimum is drawn once more before the exact one is worked out.
ROUGH = 0.05


class TotalVariation(Follower):
    """The convex problem, by primal-dual Newton."""

    def start(self, targets: np.ndarray) -> Steps[Solved]:
        def steps():
            result = yield (
                spectral_tv.start_deform(
                    self.mesh, self.grips.indices, targets, self.grips.weights, self._softness
                ),
                1.0,
            )
            return Solved(result)

        return Steps(steps())

    def message(self, solved: Solved) -> str:
        return f"deformed{of_optimum(solved.result)}{came_along(solved.result)}"

    def is_rough(self, result: spectral_tv.Deformation) -> bool:
        return result.gap > ROUGH

    def start_settling(self, targets: np.ndarray) -> spectral_tv.Job:
        return self._state.start_solve(targets)

    def _solve_in_turn(self, targets: Sequence[np.ndarray], _began: float) -> Solving:
        results = yield self._state.start_solve_sequence(list(targets)), 1.0
        return [Solved(each) for each in results]

    def _start_preparing(self) -> spectral_tv.Job:
        return spectral_tv.Deformer.start(
            self.mesh, self.grips.indices, self.grips.weights, self._softness
        )

    @property
    def _softness(self) -> float:
        """The width of the stretched zone as a length."""
        return self.settings.softness / 100 * float(np.sqrt(self.mesh.area))


def of_optimum(result: spectral_tv.Deformation) -> str:
    """Tell how near a result is to the least total variation."""
    return f" to within {max(result.gap, 1e-4):.2%} of the optimum"
