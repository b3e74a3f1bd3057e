"""What a decomposition will take, in words."""

import spectral_tv

from .settings import Settings

# What is worth saying before the button is pressed: seconds, and the part of the memory.
LONG = 5.0
LARGE_PART = 0.25


def estimate(settings: Settings, vertices: int) -> spectral_tv.Estimate:
    """Estimate a decomposition of a mesh of so many vertices."""
    arguments = settings.method_arguments(None, None)
    if settings.is_adaptive:
        arguments["accuracy"] = settings.accuracy
    return spectral_tv.estimate(
        vertices, **arguments, steps=settings.steps, eigenpairs=settings.eigenpairs
    )


def told(found: spectral_tv.Estimate, is_least: bool = False) -> str | None:
    """Say what was found; None where it is not worth saying. ``is_least`` if it may take more."""
    about = "At least" if is_least else "About"
    if not found.fits:
        return (
            f"{about} {_memory(found.bytes)} of memory, but {_memory(found.available)} are free: "
            "take fewer steps or eigenfunctions, or a mesh of fewer vertices"
        )
    is_large = found.available is not None and found.bytes > LARGE_PART * found.available
    if found.seconds < LONG and not is_large:
        return None
    return f"{about} {_time(found.seconds)}, {_memory(found.bytes)} of memory"


def _memory(size: int) -> str:
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{size / 1e6:.0f} MB"


def _time(seconds: float) -> str:
    # One digit says all that is known of it.
    if seconds < 90:
        return f"{float(f'{seconds:.1g}'):.0f} s"
    if seconds < 5400:
        return f"{float(f'{seconds / 60:.1g}'):.0f} min"
    return f"{float(f'{seconds / 3600:.1g}'):.0f} h"
