"""How the unconstrained vertices follow: a class for each kind of algorithm.

`ALGORITHMS` in constraints.py says what they are called, and SOLVERS here which class each one is.
"""

import bpy
from spectral_tv.refusal import Refusal

from ..constraints import ALGORITHMS, Settings, label_of
from ..grips import Grips
from .comparison import Comparison, Reweighted
from .pose import Posing
from .solver import Follower, Solved, Solver
from .total_variation import TotalVariation

SOLVERS: dict[str, type[Solver]] = {
    "POSE": Posing,
    "CONVEX": TotalVariation,
    "PAPER": Reweighted,
    "HARMONIC": Comparison,
    "BIHARMONIC": Comparison,
    "ARAP": Comparison,
}

__all__ = ["Follower", "Solved", "Solver", "follow_complaint", "follower_of", "solver_of"]


def solver_of(obj: bpy.types.Object, grips: Grips, settings: Settings) -> Solver:
    """What solves as ``settings`` say; raises Refusal if constraints do not go together."""
    return SOLVERS[settings.algorithm](obj, grips, settings)


def follow_complaint(algorithm: str) -> str | None:
    """Why an algorithm does not follow handles, in a sentence for the user; None if it does."""
    if issubclass(SOLVERS[algorithm], Follower):
        return None
    followers = [name for name, *_ in ALGORITHMS if name and issubclass(SOLVERS[name], Follower)]
    labels = " or ".join(label_of(name) for name in followers)
    return f"Live and Bake Animation need the algorithm {labels}"


def follower_of(obj: bpy.types.Object, grips: Grips, settings: Settings) -> Follower:
    """The same for handles that move; raises Refusal too if the algorithm does not follow them."""
    solver = solver_of(obj, grips, settings)
    if not isinstance(solver, Follower):
        raise Refusal(follow_complaint(settings.algorithm))
    return solver
