"""From a function on a mesh to its flow, and from the flow to the functions that are written."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.attributes.settings import Settings, chosen_elements
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

if TYPE_CHECKING:
    from numpy.typing import NDArray

# What is written, beside the numbered bands.
FLOW, FILTERED, BAND, REST = "Flow", "Filtered", "Band", "Rest"
# A flow to one size starts with steps for spots so many times smaller.
FINER = 20


def ensure_finite(name: str, values: NDArray[np.float64]) -> None:
    """Raise Refusal where values (V, C) of this name are no numbers."""
    broken = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if len(broken):
        raise Refusal(f"{name!r} is not a finite number at vertex {broken[0]}", broken.tolist())


def arguments(
    name: str,
    values: NDArray[np.float64],
    area: float,
    settings: Settings,
    *,
    is_even: bool = False,
) -> dict[str, Any]:
    """The arguments of spectral_tv.flow after the mesh, for values (V, C) on one of this area.

    Steps are even, or grow with the time. Raises Refusal, with the ``name`` of the function, if
    there is nothing to flow.
    """
    contrast = float(np.linalg.norm(np.ptp(values, axis=0)))
    if contrast <= 1e-6 * np.abs(values).max():
        raise Refusal(f"{name!r} is the same everywhere; there is nothing to flow")
    finest, largest = settings.finest, settings.largest
    if settings.result == "FLOW":
        finest, largest = settings.size / FINER, settings.size
    size = math.sqrt(area) / 100
    ends = [_time(settings.law, percent * size, contrast) for percent in (finest, largest)]
    times = spectral_tv.graded_times(ends[0], ends[1], settings.steps)
    return {
        "values": values,
        "times": np.linspace(0, ends[1], settings.steps + 1) if is_even else times,
        "operator": settings.law.lower(),
        **_stepping(settings, values),
    }


def functions(
    flow: spectral_tv.Flow, settings: Settings, values: Sequence[float]
) -> dict[str, NDArray[np.float64]]:
    """What is to be written of a flow, (V, C), by its label.

    ``values`` are the multiples of the bands that a filter adds.
    """
    if settings.result == "FLOW":
        return {FLOW: flow.states[-1]}
    bands = flow.bands(flow.band_edges(settings.bands))
    if settings.result == "BANDS":
        found = {f"{BAND} {number}": band for number, band in enumerate(bands, start=1)}
        return found | {REST: flow.residual}
    filtered = np.tensordot(1 + np.array(values), bands, axes=1)
    return {FILTERED: filtered + settings.keep_rest * flow.residual}


def _stepping(settings: Settings, values: NDArray[np.float64]) -> dict[str, Any]:
    if not settings.is_exact:
        # The package would take exact steps for sets by itself.
        return {"scheme": spectral_tv.DEFAULTS["scheme"]}
    return {"scheme": "exact", "elements": chosen_elements(settings.elements, values)}


def _time(law: str, length: float, contrast: float) -> float:
    """When a round spot of this width that stands out by ``contrast`` is gone.

    In the plane, by total variation, a disc of the radius r falls at the rate 2/r; by heat
    6 % of it are left in its middle at the square of its width.
    """
    return contrast * length / 4 if law == "TV" else length**2
