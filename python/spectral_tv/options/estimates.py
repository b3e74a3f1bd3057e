"""Estimates of the memory and the time of work, in words."""

from __future__ import annotations

from typing import Any

import spectral_tv
from spectral_tv.dataclass import dataclass

# What is worth saying before the button is pressed: seconds, and the part of the memory.
LONG = 5.0
LARGE_PART = 0.25


@dataclass(frozen=True)
class Needs:
    """What several decompositions take that are kept together: bytes and seconds."""

    bytes: int
    available: int | None
    seconds: float
    is_least: bool = False
    smaller: str = "a mesh of fewer vertices"

    @property
    def fits(self) -> bool:
        """Whether there is as much memory, as far as the system tells."""
        return self.available is None or self.bytes <= self.available

    def told(self) -> str | None:
        """Say it; None where it is not worth saying."""
        about = "At least" if self.is_least else "About"
        if self.available is not None and not self.fits:
            return (
                f"{about} {_memory(self.bytes)} of memory, but {_memory(self.available)} are free: "
                f"take fewer steps or eigenfunctions, or {self.smaller}"
            )
        is_large = self.available is not None and self.bytes > LARGE_PART * self.available
        if self.seconds < LONG and not is_large:
            return None
        return f"{about} {_time(self.seconds)}, {_memory(self.bytes)} of memory"


def of_values(count: int, steps: int, exact: bool, **more: Any) -> Needs:
    """What a flow of values at so many vertices or pixels takes; that of three functions."""
    scheme: Any = "exact" if exact else "extrapolated"
    return total([spectral_tv.estimate(count, "m1", steps=steps, scheme=scheme)], **more)


def total(found: list[spectral_tv.Estimate], **more: Any) -> Needs:
    """What several take together."""
    bytes_, seconds = sum(each.bytes for each in found), sum(each.seconds for each in found)
    return Needs(bytes_, found[0].available, seconds, **more)


def _memory(size: int) -> str:
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{size / 1e6:.0f} MB"


def _time(seconds: float) -> str:
    # One digit says all that is known of it.
    if seconds < 90:
        return f"{float(f'{seconds:.1g}'):.0f} s"
    if seconds < 5400:
        return f"{float(f'{seconds / 60:.1g}'):.0f} min"
    return f"{float(f'{seconds / 3600:.1g}'):.0f} h"
