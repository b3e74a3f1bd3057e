"""Total variation of displacements: rigid pieces that shift, the paper's deformation."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.deformation.solvers.solver import Follower, Solved, Solving, came_along
from spectral_tv.jobs.steps import Step, Steps
from spectral_tv.later import np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# A rough answer this far from the optimum is drawn once more before the exact one is worked out.
ROUGH = 0.05


class TotalVariation(Follower):
    """The convex problem, by primal-dual Newton."""

    def start(self, targets: NDArray[np.float64]) -> Steps[Solved]:
        """Solve for ``targets`` (K, 3) of the grips, in a thread."""

        def steps() -> Generator[Step, Any, Solved]:
            result = yield (
                spectral_tv.start_deform(
                    self.mesh, self.held.indices, targets, self.held.weights, self._softness
                ),
                1.0,
            )
            return Solved(result)

        return Steps(steps())

    def message(self, solved: Solved) -> str:
        """What a result says about itself, for the user; notes what is wrong with it."""
        return f"deformed{of_optimum(solved.result)}{came_along(solved.result)}"

    def is_rough(self, result: Any) -> bool:
        """Whether another drag should precede settling."""
        return result.gap > ROUGH

    def start_settling(self, targets: NDArray[np.float64]) -> spectral_tv.Job[Any]:
        """Work the exact result out, in a thread."""
        return self._state.start_solve(targets)

    def _solve_in_turn(self, targets: Sequence[NDArray[np.float64]], _began: float) -> Solving:
        results = yield self._state.start_solve_sequence(list(targets)), 1.0
        return [Solved(each) for each in results]

    def _start_preparing(self) -> spectral_tv.Job[Any]:
        return spectral_tv.Deformer.start(
            self.mesh, self.held.indices, self.held.weights, self._softness
        )

    @property
    def _softness(self) -> float:
        """The width of the stretched zone as a length."""
        return self.settings.softness / 100 * float(np.sqrt(self.mesh.area))


def of_optimum(result: spectral_tv.Deformation) -> str:
    """Tell how near a result is to the least total variation."""
    return f" to within {max(result.gap, 1e-4):.2%} of the optimum"
