"""A limit on how far bands move any vertex."""

from collections.abc import Callable, Sequence
from typing import Any

from spectral_tv.dataclass import dataclass
from spectral_tv.options.declaring import number


def limit_option(**more: Any) -> Any:
    """The option that limits."""
    return number(
        "Limit Movement", "No vertex is moved further than this by the bands, in the scene's unit; "
        "0 is no limit", 0, 0, None, unit="DISTANCE", digits=4, **more
    )  # fmt: skip


@dataclass(frozen=True)
class LimitSettings:
    """How far bands may move a vertex."""

    limit: float = limit_option(place="limit")


@dataclass(frozen=True)
class Limited:
    """How many vertices of all are held back at a limit, and by which masks; how far the farthest
    would be moved without that."""

    limit: float
    held: int
    count: int
    farthest: float
    masks: Sequence[str]

    def told(self, length: Callable[[float], str]) -> str:
        """Say it, with lengths as they are said."""
        limit, farthest = length(self.limit), length(self.farthest)
        if not self.held:
            return f"no vertex is moved by more than {limit}: the farthest by {farthest}"
        verb = "is" if self.held == 1 else "are"
        masks = f", by {', '.join(map(repr, self.masks))}" if self.masks else ""
        return (
            f"{self.held} of {self.count} vertices {verb} held back at {limit}{masks}; the "
            f"farthest would be moved by {farthest}"
        )
