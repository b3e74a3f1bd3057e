"""Filters as values of the bands' shape keys: −1 removes a band, 0 keeps it, 1 doubles it."""

from collections.abc import Callable

# The least and the most value of a band: Blender's for shape keys.
VALUES = (-10.0, 10.0)
PRESETS = (
    ("LOW_PASS", "Low-Pass", "Remove the bands finer than the chosen ones"),
    ("HIGH_PASS", "High-Pass", "Remove the bands coarser than the chosen ones"),
    ("BAND_PASS", "Band-Pass", "Remove all bands but the chosen ones"),
    ("BAND_STOP", "Band-Stop", "Remove the chosen bands"),
    ("EXAGGERATE", "Exaggerate", "Amplify the chosen bands by the amount"),
    ("RESET", "Reset", "Set every band of every decomposition back to its original strength"),
)


def too_few_steps(bands: int, steps: int) -> str | None:
    """Why there can be no such number of bands, for the user; None if there can."""
    return f"{bands} bands need more than {steps} steps" if bands >= steps else None


def preset_values(preset: str, count: int, first: int, last: int, amount: float) -> list[float]:
    """Values of ``count`` bands, the chosen ones being ``first`` to ``last``, counted from 1."""
    first, last = _ends(count, first, last)
    rules: dict[str, Callable[[int], float]] = {
        "LOW_PASS": lambda band: -1.0 if band < first else 0.0,
        "HIGH_PASS": lambda band: -1.0 if band > last else 0.0,
        "BAND_PASS": lambda band: 0.0 if first <= band <= last else -1.0,
        "BAND_STOP": lambda band: -1.0 if first <= band <= last else 0.0,
        "EXAGGERATE": lambda band: amount if first <= band <= last else 0.0,
        "RESET": lambda _band: 0.0,
    }
    return [rules[preset](band) for band in range(1, count + 1)]


def usual_band(preset: str, count: int) -> int:
    """The band that a filter chooses by default: the third, if there is another band beyond it.

    With fewer bands it is the last but one. For a low-pass it is at least the second, as otherwise
    there would be nothing to remove.
    """
    return max(2 if preset == "LOW_PASS" and count > 1 else 1, min(3, count - 1))


def idle_reason(preset: str, count: int, first: int, last: int, amount: float) -> str | None:
    """Why a preset leaves all of ``count`` bands as they are; None if it does not."""
    if preset == "RESET" or any(preset_values(preset, count, first, last, amount)):
        return None
    label = next(label for name, label, _ in PRESETS if name == preset)
    first, last = _ends(count, first, last)
    reasons = {
        "LOW_PASS": f"no band is finer than band {first}",
        "HIGH_PASS": f"no band is coarser than band {last}",
        "BAND_PASS": "all bands are chosen",
        "EXAGGERATE": "the amount is 0",
    }
    return f"{label} changes nothing: {reasons[preset]}"


def caricature_values(count: int, first: int, last: int, amount: float, smooth: int) -> list[float]:
    """Values that amplify the chosen bands and remove the ``smooth`` finest of the others."""
    values = preset_values("EXAGGERATE", count, first, last, amount)
    first, last = _ends(count, first, last)
    for band in range(1, min(smooth, count) + 1):
        if not first <= band <= last:
            values[band - 1] = -1.0
    return values


def curve_values(curve: Callable[[float], float], count: int) -> list[float]:
    """Values of ``count`` bands from a filter H over [0, 1], finest to largest."""
    return [curve((band + 0.5) / count) - 1.0 for band in range(count)]


def _ends(count: int, first: int, last: int) -> list[int]:
    return sorted((min(first, count), min(last, count)))
