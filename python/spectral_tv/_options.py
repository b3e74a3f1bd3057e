"""The options that functions share: their types, texts and defaults, and which method takes which.

The documentation of each function that takes them is made of the texts. A choice is a union of its
names, each with its text.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, TypedDict

from spectral_tv import _native

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
else:  # the documentation says it in words, and NumPy is not read for it
    ArrayLike = Any

Stepped: TypeAlias = (
    Annotated[
        Literal["m1"], "shape spectral TV, for surface detail (Brokman et al. 2024, Sec. 7.3)."
    ]
    | Annotated[Literal["m2"], "conformalized P-Laplace, for limbs and head (Sec. 7.4)."]
    | Annotated[Literal["m3"], "directional TV on a smooth base, keeps edges (Sec. 7.5)."]
    | Annotated[Literal["naive"], "TV of each coordinate alone (Sec. 7.2)."]
    | Annotated[Literal["heat"], "linear diffusion, for comparison."]
)
Method: TypeAlias = (
    Stepped
    | Annotated[
        Literal["lb"],
        "eigenfunctions of the Laplace–Beltrami operator (Vallet and Lévy 2008), each at the time "
        "1/λ, for comparison; the first component is what the `eigenpairs` do not hold.",
    ]
    | Annotated[
        Literal["displacement"],
        "the difference to a smooth base as the only component (Cignoni, Scopigno and Tarini "
        "2005), for comparison.",
    ]
)
Scheme: TypeAlias = (
    Annotated[Literal["extrapolated"], "at the extrapolated state, with BDF2."]
    | Annotated[Literal["lagged"], "at the last state, with backward Euler (the paper's step)."]
    | Annotated[
        Literal["exact"],
        "every step is a proximal step to the gap `tolerance`, so that eigenfunctions decay in a "
        "straight line down to extinction; of total variation only (see `METHODS`).",
    ]
)
Solver: TypeAlias = (
    Annotated[Literal["auto"], "by the fastest for the mesh."]
    | Annotated[Literal["cholesky"], "by factorization, exact to rounding."]
    | Annotated[
        Literal["single"], "by factorization in single precision, to some 1e-6 of each increment."
    ]
    | Annotated[
        Literal["multigrid"], "by conjugate gradients with multigrid, to 1e-4 of each increment."
    ]
)
Progress: TypeAlias = Annotated[
    Callable[[float], object],
    "Called with the fraction done; an exception it raises ends the work.",
    "callable",
]


class StepOptions(TypedDict, total=False):
    """How the steps of a flow are taken."""

    scheme: Annotated[Scheme, "Where a step takes its weights."]
    tolerance: Annotated[float, "Relative duality gap of exact steps, in (0, 1)."]
    solver: Annotated[
        Solver,
        "How the linear systems of steps are solved. Exact steps are always solved by "
        "factorization.",
    ]


class ShapeOptions(StepOptions, total=False):
    """What is flowed of a shape."""

    p: Annotated[int, 'The P of "m2": 3, 2 or 1. Only 3 is zero-homogeneous.']
    soft_edges: Annotated[
        float,
        'How soft the edges of "m1" are, from 0 to 1. 0: the paper\'s TV, which lets a feature '
        "vanish at once. 0.3: a bounded weight, by which it fades along its rim, so that bands "
        "have no hems. Only 0 is zero-homogeneous.",
    ]
    base: Annotated[
        ArrayLike | Literal["limbs"] | None,
        'The smooth base of "m3" and "displacement". Default: the mesh under ten steps of '
        '`conformal_flow`, which takes limbs from it. "limbs": the low-pass of "m1" with soft '
        "edges and limbs kept, so that only folds and plates lie on it.",
        '(V, 3) array or "limbs"',
    ]
    base_time: Annotated[
        float | None,
        "How far the flow to the base goes, length². Default: 5e-3 of the area, and 3e-3 where "
        "limbs are kept.",
    ]
    displacement: Annotated[
        Annotated[Literal["scalar"], "its signed length, in fixed directions (the paper's way)."]
        | Annotated[
            Literal["vector"],
            'the displacement itself, its coordinates coupled. With base="limbs" that leaves no '
            "scratches and turns nothing over.",
        ],
        'What "m3" flows of the displacement from its base.',
    ]
    metric: Annotated[
        Annotated[Literal["surface"], "that of the mesh."]
        | Annotated[Literal["base"], "that of its base."],
        'The metric in which "m3" flows. With a flat base a height field is an image. Then '
        '"surface" gives its spectral ATV, "base" its spectral TV (Brokman et al. 2024, Sec. 9.3).',
    ]


class DecomposeOptions(ShapeOptions, total=False):
    """What a decomposition takes besides."""

    accuracy: Annotated[
        float | None,
        "Take as many steps as are needed for this error of the bands: the mean over five bands, "
        "relative to their size. `steps` is then ignored, and given times are subdivided. 0.1 is "
        "hardly visible, 0.02 is fine. To find the number takes at least two flows, of 12 and 24 "
        "steps. Each further flow has up to four times the steps of the one before.",
    ]
    eigenpairs: Annotated[
        int,
        'How many of the lowest eigenpairs "lb" uses; all, if the mesh has fewer. See '
        "`eigenpairs`.",
    ]


@dataclass(frozen=True)
class MethodFacts:
    """What is known of a method.

    Attributes
    ----------
    takes_steps : bool
        Whether it flows in time steps.
    takes_base : bool
        Whether it measures from a smooth base.
    has_exact_steps : bool
        Whether it descends total variation, so that its steps can be exact.
    options : frozenset of str
        The options that it takes; others are refused unless they are as by default.
    """

    takes_steps: bool
    takes_base: bool
    has_exact_steps: bool
    options: frozenset[str]


_defaults, _methods = _native._facts()
#: The default of each option of `decompose`, by its name.
DEFAULTS: Mapping[str, Any] = MappingProxyType(_defaults)
STEPS: int = DEFAULTS["steps"]
# Where an accuracy is asked for: steps of the first flow. The next has twice as many.
FEWEST_STEPS = 12
#: The facts of each method, by its name.
METHODS: Mapping[str, MethodFacts] = MappingProxyType(
    {
        name: MethodFacts(**{**facts, "options": frozenset(facts["options"])})
        for name, facts in _methods.items()
    }
)
