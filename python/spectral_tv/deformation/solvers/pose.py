"""Total variation of rigid motions: pieces that turn, with joints at narrow places."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.deformation.contact import Contact, Rest
from spectral_tv.deformation.held import Held
from spectral_tv.deformation.settings import Settings
from spectral_tv.deformation.solvers.solver import Follower, Solved, Solving, came_along
from spectral_tv.jobs.steps import Step, Steps
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.options.declaring import keywords

if TYPE_CHECKING:
    from numpy.typing import NDArray

# A step that moves a vertex by more than this, relative to the size, is followed by another one
# before the exact pose is worked out.
ROUGH = 2e-3
# What a settled pose has still to gain, relative to its energy, and what is worth a word.
TOLERANCE, UNSETTLED = 1e-4, 1e-3
# The part of the work that is solving; looking at the result is the rest.
SOLVING = 0.9
# The part of it that is done when a rig is looked for.
POSED = 0.9


class Posing(Follower):
    """The energy of rigid motions, by spectral_tv.Poser."""

    def __init__(self, held: Held, settings: Settings) -> None:
        """Take the same; raises Refusal if two free bodies share a vertex."""
        super().__init__(held, settings)
        self._bodies = held.bodies()
        self._rest = Rest(self.mesh)
        self._size = float(np.linalg.norm(np.ptp(self.mesh.vertices, axis=0)))

    def start(self, targets: NDArray[np.float64]) -> Steps[Solved]:
        """Solve for ``targets`` (K, 3) of the grips, in a thread."""
        return Steps(self._solve(targets, 1.0))

    def start_rig(self, targets: NDArray[np.float64]) -> Steps[tuple[Solved, spectral_tv.Rig]]:
        """Pose for ``targets`` (K, 3), and find the rig of that pose, in a thread."""

        def steps() -> Generator[Step, Any, tuple[Solved, spectral_tv.Rig]]:
            solved = yield from self._solve(targets, POSED)
            rig = yield spectral_tv.start_rig(self.mesh, solved.result), 1.0
            return solved, rig

        return Steps(steps())

    def _solve(self, targets: NDArray[np.float64], end: float) -> Generator[Step, Any, Solved]:
        """Pose and look at the pose; progress goes to ``end``."""
        pose = yield (
            spectral_tv.start_pose(
                self.mesh,
                self.held.indices,
                targets,
                self.held.weights,
                self._bodies,
                **keywords(self.settings),
            ),
            SOLVING * end,
        )
        contact = yield from self._rest.look(pose, SOLVING * end, end)
        return Solved(pose, contact)

    def message(self, solved: Solved) -> str:
        """What a result says about itself, for the user; notes what is wrong with it."""
        pose, how = solved.result, ""
        solved.contact.note()
        if pose.decrement > UNSETTLED:
            self._note_unsettled(pose.decrement)
        else:
            how = f", settled to within {max(pose.decrement, TOLERANCE):.2%}"
        return f"posed{how}{came_along(pose)}"

    def is_rough(self, result: Any) -> bool:
        """Whether another drag should precede settling."""
        return result.movement > ROUGH * self._size

    def start_settling(self, targets: NDArray[np.float64]) -> spectral_tv.Job[Any]:
        """Work the exact result out, in a thread."""
        return self._state.start_solve(targets, TOLERANCE)

    def start_check(self, result: Any) -> Steps[Contact]:
        """Look for what is wrong with a settled result, in a thread."""
        return Steps(self._rest.look(result, 0.0, 1.0))

    def _start_preparing(self) -> spectral_tv.Job[Any]:
        held = self.held
        return spectral_tv.Poser.start(
            self.mesh, held.indices, held.weights, self._bodies, **keywords(self.settings)
        )

    def _solve_in_turn(self, targets: Sequence[NDArray[np.float64]], began: float) -> Solving:
        solved, share = [], (1.0 - began) / len(targets)
        for number, each in enumerate(targets):
            before = began + number * share
            solving = before + SOLVING * share
            pose = yield self._state.start_solve(each, TOLERANCE), solving
            contact = yield from self._rest.look(pose, solving, before + share)
            solved.append(Solved(pose, contact))
        return solved

    def note_sequence(self, frames: Sequence[int], solutions: Sequence[Solved]) -> None:
        """Note what is wrong with some of several frames."""
        worst = max(solutions, key=lambda each: each.contact.crossing)
        folded = max(solutions, key=lambda each: each.contact.turned_over)
        for one, contact in (
            (worst, Contact(crossing=worst.contact.crossing)),
            (folded, Contact(turned_over=folded.contact.turned_over)),
        ):
            contact.note(f" on frame {frames[solutions.index(one)]}")
        unsettled = max(each.result.decrement for each in solutions)
        if unsettled > UNSETTLED:
            self._note_unsettled(unsettled)

    def take(self, settings: Settings) -> bool:
        """Go on with other settings, as nothing has to be read for them."""
        self._state.set_parameters(**keywords(settings))
        self.settings = settings
        return True

    @staticmethod
    def _note_unsettled(decrement: float) -> None:
        note(
            f"it has not settled: a better pose may cost {decrement:.1%} less. Move the handles in "
            "smaller steps"
        )
