"""What one filter for all frames of a moving shape takes once."""

from __future__ import annotations

from collections.abc import Callable
from numbers import Real
from typing import TYPE_CHECKING, Any, Literal

import spectral_tv
from spectral_tv import _native
from spectral_tv._native import Decomposition, Job, Mesh, MeshError
from spectral_tv._options import DEFAULTS, FEWEST_STEPS, METHODS, STEPS
from spectral_tv.later import np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# The largest area that is worked with, length².
LARGEST = 1e100
# Of the work on a frame, what measuring the thickness takes.
THICKNESS = 0.3


class FixedScales:
    """What the frames of a moving shape have in common where one filter is for all of them.

    That is the times of the flow, how far the base is smoothed, and the thickness by which limbs
    are kept. `decompose` does `start_thickness`, `taken`, `start` and `learn` for a frame.
    """

    def __init__(
        self, arguments: dict[str, Any], area: float | None = None, *, keeps_limbs: bool = False
    ) -> None:
        """Take arguments of `decompose`, and the area that defaults go by, if it is not that of the
        first frame. ``keeps_limbs`` says that bands will be cut by the thickness.
        """
        self._arguments = dict(arguments)
        self._area = None if area is None else _checked(area)
        self._has_thickness = keeps_limbs or _named(arguments.get("base")) is not None
        self._before: Mesh | None = None

    def decompose(
        self, mesh: Mesh, base: Any = None, show: Callable[[float], object] = lambda _done: None
    ) -> tuple[Mesh, Decomposition]:
        """Decompose the next frame; returns it with its thickness too. ``show`` takes the fraction
        done."""
        job, before = self.start_thickness(mesh), 0.0
        if job is not None:
            mesh = self.taken(mesh, job.result(lambda done: show(THICKNESS * done)))
            before = THICKNESS
        work = self.start(mesh, base)
        split = work.result(lambda done: show(before + (1 - before) * done))
        self.learn(split)
        return mesh, split

    def start_thickness(self, mesh: Mesh) -> Job[NDArray[np.float64]] | None:
        """Start to measure the thickness of the next frame; None if nothing depends on it."""
        return _native.start_thickness(mesh, self._before) if self._has_thickness else None

    def taken(self, mesh: Mesh, thickness: NDArray[np.float64] | None) -> Mesh:
        """The next frame with its thickness."""
        if thickness is None:
            return mesh
        self._before = mesh.with_thickness(thickness)
        return self._before

    def start(self, mesh: Mesh, base: Any = None) -> Job[Decomposition]:
        """Start to decompose a frame; ``base`` (V, 3) is one of its own, if any."""
        if self._area is None:
            self._area = mesh.area
        elif self._arguments.get("times") is None and self._has_times:
            self._arguments["times"] = self._default_times(self._area)
        self._fix_base(self._area)
        own = {} if base is None else {"base": base}
        return _native.start_decompose(mesh, {**self._arguments, **own})

    def learn(self, split: Decomposition) -> None:
        """Have further frames take the times of this one, and not look for an accuracy again."""
        if self._has_times:
            self._arguments["times"] = split.times
            self._arguments.pop("accuracy", None)

    @property
    def _has_times(self) -> bool:
        """Whether the method has a time axis with more than one component."""
        method = self._arguments["method"]
        return method in METHODS and method != "displacement"

    def _default_times(self, area: float) -> NDArray[np.float64]:
        found = self._arguments
        pairs = found.get("eigenpairs", DEFAULTS["eigenpairs"])
        finest, largest = spectral_tv.default_scales(
            found["method"], pairs, _named(found.get("base"))
        )
        steps = found.get("steps", STEPS) if found.get("accuracy") is None else FEWEST_STEPS
        return spectral_tv.graded_times(area * finest, area * largest, steps)

    def _fix_base(self, area: float) -> None:
        """Smooth the base as far in every frame, where it is the shape itself smoothed."""
        found = self._arguments
        facts = METHODS.get(found["method"])
        base = found.get("base")
        is_own = base is None or isinstance(base, str)
        is_smoothed = facts is not None and facts.takes_base and is_own
        if is_smoothed and found.get("base_time") is None:
            found["base_time"] = area * spectral_tv.default_base_time(_named(base))


def _checked(area: float) -> float:
    """An area that sizes can be relative to; raises TypeError or MeshError."""
    if not isinstance(area, Real):
        raise TypeError(f"area must be a number, not {type(area).__name__}")
    if not 0 < area <= LARGEST:
        raise MeshError(f"area must be above 0 and at most {LARGEST:g}, not {area!s:.20}")
    return float(area)


def _named(base: Any) -> Literal["limbs"] | None:
    """The base, if it is one that `decompose` knows by its name."""
    return "limbs" if isinstance(base, str) and base == "limbs" else None
