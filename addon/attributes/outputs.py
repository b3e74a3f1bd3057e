"""Writing functions on a mesh, each beside the function it was made from."""

from __future__ import annotations

import bpy
from spectral_tv.attributes.flows import BAND, REST
from spectral_tv.later import np

from ..scene import results
from ..scene.results import Piece
from .sources import Source

SCALARS = {1: "FLOAT", 2: "FLOAT2", 3: "FLOAT_VECTOR"}


def write(obj: bpy.types.Object, source: Source, functions: dict[str, np.ndarray]) -> list[str]:
    """Write functions (V, C), by their labels, beside their source; returns their names.

    Bands of vertex groups become attributes, as weights cannot be negative; what else leaves
    [0, 1] there is cut off. Bands of an earlier run that are not written again are removed.
    """
    is_bands = REST in functions
    pieces = {
        label: _piece(source, values, is_bands=is_bands) for label, values in functions.items()
    }

    def is_stale(label: str) -> bool:
        return is_bands and label.startswith(BAND)

    return results.write(obj, source.kind, source.name, pieces, is_stale)


def _piece(source: Source, values: np.ndarray, *, is_bands: bool) -> Piece:
    if source.kind == "KEY":
        return Piece("KEY", values)
    if source.kind == "GROUP" and not is_bands:
        return Piece("GROUP", values[:, 0])
    if source.alpha is None:
        return Piece("ATTRIBUTE", values, SCALARS[values.shape[1]])
    alpha = np.ones(len(values)) if is_bands else source.alpha
    return Piece("ATTRIBUTE", np.column_stack([values, alpha]), "FLOAT_COLOR")
