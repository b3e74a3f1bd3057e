"""What all kinds of algorithms have in common."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.deformation.contact import Contact
from spectral_tv.deformation.held import Held
from spectral_tv.deformation.settings import Settings
from spectral_tv.jobs.steps import Step, Steps
from spectral_tv.later import np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# The part of the work on a sequence that preparing is.
PREPARING = 0.05


@dataclass(frozen=True)
class Solved:
    """A result, spectral_tv.Deformation or Pose, and what was found wrong with its faces."""

    result: Any
    contact: Contact = field(default_factory=Contact)


Solving = Generator[Step, Any, list[Solved]]


class Solver:
    """Solves for the positions of a surface, once."""

    def __init__(self, held: Held, settings: Settings) -> None:
        """Take what is held, and how the rest follows; raises Refusal or spectral_tv.MeshError."""
        self.held, self.settings = held, settings
        self.mesh = held.mesh

    def start(self, targets: NDArray[np.float64]) -> Steps[Solved]:
        """Solve for ``targets`` (K, 3) of the grips, in a thread."""
        raise NotImplementedError

    def message(self, solved: Solved) -> str:
        """What a result says about itself, for the user; notes what is wrong with it."""
        return f"deformed{came_along(solved.result)}"


class Follower(Solver):
    """Solves again and again, each time from where it was, once what that takes is prepared."""

    # What solves: spectral_tv.Deformer or Poser, once it is there.
    _state: Any = None

    @property
    def is_ready(self) -> bool:
        """Whether `start_drag` and `start_settling` can be called."""
        return self._state is not None

    def prepare(self) -> Steps[None]:
        """Prepare, in a thread."""

        def steps() -> Generator[Step, Any, None]:
            self._state = yield self._start_preparing(), 1.0

        return Steps(steps())

    def _start_preparing(self) -> spectral_tv.Job[Any]:
        """Make what solves, in a thread."""
        raise NotImplementedError

    def start_drag(self, targets: NDArray[np.float64]) -> spectral_tv.Job[Any]:
        """Work a quick and rough result out, in a thread, for targets near the last ones."""
        return self._state.start_drag(targets)

    def is_rough(self, result: Any) -> bool:
        """Whether another `start_drag` should precede `start_settling`, as that takes longer."""
        raise NotImplementedError

    def start_settling(self, targets: NDArray[np.float64]) -> spectral_tv.Job[Any]:
        """Work the exact result out, in a thread."""
        raise NotImplementedError

    def start_check(self, _result: Any) -> Steps[Contact] | None:
        """Look, in a thread, for what is wrong with a settled result; None if nothing can be."""
        return None

    def start_sequence(self, targets: Sequence[NDArray[np.float64]]) -> Steps[list[Solved]]:
        """Prepare, and solve for one after the other, in a thread."""

        def steps() -> Solving:
            yield self.prepare(), PREPARING
            return (yield from self._solve_in_turn(targets, PREPARING))

        return Steps(steps())

    def _solve_in_turn(self, targets: Sequence[NDArray[np.float64]], began: float) -> Solving:
        """Solve for one after the other; ``began`` is the part of the work that is done by then."""
        raise NotImplementedError

    def note_sequence(self, frames: Sequence[int], solutions: Sequence[Solved]) -> None:
        """Note what is wrong with some of several frames."""

    def take(self, _settings: Settings) -> bool:
        """Go on with other settings of the same algorithm, if that needs nothing to be read."""
        return False


def came_along(result: Any) -> str:
    """Tell of parts without constraints."""
    count = len(result.unconstrained)
    return f"; {count} vertices of parts without a constraint came along" if count else ""
