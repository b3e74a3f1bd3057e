"""The settings of a deformation."""

from collections.abc import Collection

from spectral_tv.dataclass import dataclass
from spectral_tv.options.declaring import Only, choice, number, options_of

# With numbers, as files keep those of old.
ALGORITHMS = (
    ("POSE", "Pose", "Rigid pieces that turn, with joints at narrow places: pull a hand, and the "
     "arm bends at the elbow", "", 5),
    ("CONVEX", "Total Variation", "Rigid pieces that shift and do not turn; narrow places take all "
     "of the stretch (the paper's deformation)", "", 0),
    ("", "For Comparison", ""),
    ("PAPER", "Reweighted", "The paper's Algorithm 1. Slower, and it may end with the stretch in "
     "another, wider place, or far off where handles turn; for comparison", "", 1),
    ("HARMONIC", "Harmonic", "Stretches everything a little; for comparison", "", 2),
    ("BIHARMONIC", "Biharmonic", "Stretches everything smoothly; for comparison", "", 3),
    ("ARAP", "As Rigid as Possible", "Bends and turns everything a little; for comparison", "", 4),
)  # fmt: skip
# Those by which pieces turn with their handles.
TURNING = ("POSE", "ARAP")


def label_of(algorithm: str) -> str:
    """What an algorithm is called."""
    return next(label for name, label, *_ in ALGORITHMS if name == algorithm)


POSING = Only("algorithm", ["POSE"])


@dataclass(frozen=True)
class Settings:
    """How the unconstrained vertices follow."""

    algorithm: str = choice("Algorithm", "How the others follow", ALGORITHMS, place="follow")
    softness: float = number(
        "Softness",
        "Width of the stretched zone, relative to the object's size. At 0 a narrow place "
        "stretches within a ring of faces", 5, 0, 100, soft_most=30, unit="PERCENTAGE", digits=1,
        applies=Only("algorithm", ["CONVEX"]), place="follow", refused=True
    )  # fmt: skip
    joint_softness: float = number(
        "Joint Softness",
        "How softly joints bend: 3 is soft and wide as of rubber, 0.3 sharp as of a puppet", 1, 0,
        100, soft_most=10, digits=2, applies=POSING, place="follow", keyword="joint_softness",
        refused=True
    )  # fmt: skip
    stiffness: float = number(
        "Stiffness",
        "How reluctantly pieces turn, relative to the object's size: with 0.1 and more they shift "
        "and stretch where they would turn", 0.03, 0, 100, soft_most=0.3, digits=3, applies=POSING,
        place="follow", keyword="stiffness", refused=True
    )  # fmt: skip
    stillness: float = number(
        "Stillness",
        "How strongly all that is not pulled stays where it is: at 0 the body leans after its "
        "limbs", 0.5, 0, 100, soft_most=2, digits=2, applies=POSING, place="follow",
        keyword="stillness", refused=True
    )  # fmt: skip


def algorithm_for(options: Collection[str]) -> str | None:
    """The algorithm that the first of several options is for that is for one alone."""
    for name, option in options_of(Settings).items():
        if option.applies and name in options:
            return str(option.applies[0].values[0])
    return None
