"""Filters as values of the bands' shape keys: −1 removes a band, 0 keeps it, 1 doubles it."""

from collections.abc import Callable

PRESETS = (
    ("LOW_PASS", "Low-Pass", "Remove the bands finer than the chosen ones"),
    ("HIGH_PASS", "High-Pass", "Remove the bands coarser than the chosen ones"),
    ("BAND_PASS", "Band-Pass", "Remove all bands but the chosen ones"),
    ("BAND_STOP", "Band-Stop", "Remove the chosen bands"),
    ("EXAGGERATE", "Exaggerate", "Amplify the chosen bands by the amount"),
    ("RESET", "Reset", "Set every band back to its original strength"),
)


def preset_values(preset: str, count: int, first: int, last: int, amount: float) -> list[float]:
    """Values of ``count`` bands, the chosen ones being ``first`` to ``last``, counted from 1."""
    first, last = sorted((min(first, count), min(last, count)))
    rules: dict[str, Callable[[int], float]] = {
        "LOW_PASS": lambda band: -1.0 if band < first else 0.0,
        "HIGH_PASS": lambda band: -1.0 if band > last else 0.0,
        "BAND_PASS": lambda band: 0.0 if first <= band <= last else -1.0,
        "BAND_STOP": lambda band: -1.0 if first <= band <= last else 0.0,
        "EXAGGERATE": lambda band: amount if first <= band <= last else 0.0,
        "RESET": lambda _band: 0.0,
    }
    return [rules[preset](band) for band in range(1, count + 1)]


def caricature_values(count: int, first: int, last: int, amount: float, smooth: int) -> list[float]:
    """Values that amplify the chosen bands and remove the ``smooth`` finest of the others."""
    values = preset_values("EXAGGERATE", count, first, last, amount)
    first, last = sorted((min(first, count), min(last, count)))
    for band in range(1, min(smooth, count) + 1):
        if not first <= band <= last:
            values[band - 1] = -1.0
    return values


def curve_values(curve: Callable[[float], float], count: int) -> list[float]:
    """Values of ``count`` bands from a filter H over [0, 1], finest to largest."""
    return [curve((band + 0.5) / count) - 1.0 for band in range(count)]
