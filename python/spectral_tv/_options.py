"""The options that functions share: their types, their defaults, and which method takes which."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal, TypedDict

from numpy.typing import ArrayLike

from spectral_tv import _native

Stepped = Literal["m1", "m2", "m3", "naive", "heat"]
Method = Literal["m1", "m2", "m3", "naive", "heat", "lb", "displacement"]
Scheme = Literal["extrapolated", "lagged", "exact"]
Solver = Literal["auto", "cholesky", "multigrid"]
Progress = Callable[[float], object]


class StepOptions(TypedDict, total=False):
    """How the steps of a flow are taken; `decompose` says what each is."""

    scheme: Scheme
    tolerance: float
    solver: Solver


class ShapeOptions(StepOptions, total=False):
    """What is flowed of a shape; `decompose` says what each is."""

    p: int
    base: ArrayLike | None
    base_time: float | None
    metric: Literal["surface", "base"]


class DecomposeOptions(ShapeOptions, total=False):
    """What a decomposition takes besides; `decompose` says what each is."""

    accuracy: float | None
    eigenpairs: int


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
#: The facts of each method, by its name.
METHODS: Mapping[str, MethodFacts] = MappingProxyType(
    {
        name: MethodFacts(**{**facts, "options": frozenset(facts["options"])})
        for name, facts in _methods.items()
    }
)
