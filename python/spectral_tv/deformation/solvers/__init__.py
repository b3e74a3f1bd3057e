"""How the unconstrained vertices follow: a class for each kind of algorithm.

`ALGORITHMS` in settings.py says what they are called, and SOLVERS here which class each one is.
"""

from spectral_tv.deformation.held import Held
from spectral_tv.deformation.settings import ALGORITHMS, Settings, label_of
from spectral_tv.deformation.solvers.comparison import Comparison, Reweighted
from spectral_tv.deformation.solvers.pose import Posing
from spectral_tv.deformation.solvers.solver import Follower, Solved, Solver
from spectral_tv.deformation.solvers.total_variation import TotalVariation
from spectral_tv.refusal import Refusal

SOLVERS: dict[str, type[Solver]] = {
    "POSE": Posing,
    "CONVEX": TotalVariation,
    "PAPER": Reweighted,
    "HARMONIC": Comparison,
    "BIHARMONIC": Comparison,
    "ARAP": Comparison,
}

__all__ = ["Follower", "Solved", "Solver", "follow_complaint", "follower_of", "solver_of"]


def solver_of(held: Held, settings: Settings) -> Solver:
    """What solves as ``settings`` say; raises Refusal if constraints do not go together."""
    return SOLVERS[settings.algorithm](held, settings)


def follow_complaint(algorithm: str) -> str | None:
    """Why an algorithm does not follow handles, in a sentence for the user; None if it does."""
    if issubclass(SOLVERS[algorithm], Follower):
        return None
    followers = [name for name, *_ in ALGORITHMS if name and issubclass(SOLVERS[name], Follower)]
    labels = " or ".join(label_of(name) for name in followers)
    return f"Live and Bake Animation need the algorithm {labels}"


def follower_of(held: Held, settings: Settings) -> Follower:
    """The same for handles that move; raises Refusal too if the algorithm does not follow them."""
    solver = solver_of(held, settings)
    if not isinstance(solver, Follower):
        raise Refusal(str(follow_complaint(settings.algorithm)))
    return solver
