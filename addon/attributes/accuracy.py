"""The accuracy of a decomposition as a text, attributes and colors."""

from __future__ import annotations

import bpy
import spectral_tv
from spectral_tv.attributes.accuracy import ERRORS, table
from spectral_tv.later import np

from ..scene import results
from ..scene.documents import keep_text
from ..scene.results import Piece
from ..scene.surface import Surface
from ..scene.whole import whole

# Of the heat map, from no error to the largest.
RAMP = ((0.05, 0.08, 0.35), (0.1, 0.5, 0.55), (0.95, 0.9, 0.3))


def write(
    obj: bpy.types.Object, method: str, surface: Surface, result: spectral_tv.Accuracy, shown: str
) -> list[str]:
    """Write the errors of the most steps as attributes, in the unit of the scene; name them.

    The one that is ``shown`` is the active color attribute too. The table is kept as a text, in
    place of that of the last time.
    """
    most = int(np.argmax(result.steps))
    errors = {label: surface.to_vertices(getattr(result, name)[most]) for label, name, _ in ERRORS}
    pieces = {label: Piece("ATTRIBUTE", values, "FLOAT") for label, values in errors.items()}
    label = next(label for label, _, short in ERRORS if short == shown)
    colors = np.column_stack([heat_map(errors[label]), np.ones(len(surface.place))])
    pieces["Error Color"] = Piece("ATTRIBUTE", colors, "FLOAT_COLOR")
    told = table(surface.mesh, result)
    with whole(obj):
        keep_text(obj.data, "accuracy", f"{obj.name} Accuracy.csv", told)
        names = results.write(obj, "ACCURACY", method, pieces)
    obj.data.color_attributes.active_color = obj.data.color_attributes[names[-1]]
    return names


def heat_map(values: np.ndarray) -> np.ndarray:
    """Colors (V, 3) of values (V,) from 0 to their largest."""
    shares = values / max(values.max(), np.finfo(float).tiny)
    stops = np.linspace(0, 1, len(RAMP))
    return np.column_stack(
        [np.interp(shares, stops, channel) for channel in zip(*RAMP, strict=True)]
    )
