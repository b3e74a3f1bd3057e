"""Meshes of corners that are joined where they belong together, with messages in percent."""

from __future__ import annotations

import re
import warnings
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.later import np
from spectral_tv.notes import note

if TYPE_CHECKING:
    from numpy.typing import NDArray

# How the package says what would join corners, which is a length there.
ADVICE = re.compile(r"pass weld=(?:(?P<length>[\d.e+-]+)|, a length beyond)")


def joined(
    positions: NDArray[np.float64], corners: NDArray[Any], weld: float, leaves_out: bool
) -> spectral_tv.Mesh:
    """The mesh of vertices (V, 3) and triangles (F, 3); notes what was found and done.

    Corners of open edges are joined within ``weld`` percent of its size. Faces whose vertices have
    no finite place are left out if ``leaves_out``. Raises spectral_tv.MeshError.
    """
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", spectral_tv.MeshWarning)
        size = _size(positions, corners)
        mesh = spectral_tv.Mesh(
            positions, corners, weld=weld / 100 * size, broken="drop" if leaves_out else "refuse"
        )
    done = [str(mesh.findings)] if mesh.findings else []
    for text in (*done, *(_in_percent(str(each.message), size) for each in told)):
        note(text)
    return mesh


def _in_percent(text: str, size: float) -> str:
    """Advice of the package as one about *Join Within*, in percent of the size."""
    found = ADVICE.search(text)
    if found is None or size == 0:
        return text
    if found["length"] is None:
        return text.replace(found[0], "raise Join Within beyond")
    share = 100 * float(found["length"]) / size
    if share > 0:  # rounded up, so that it is enough
        unit = 10.0 ** (np.floor(np.log10(share)) - 1)
        share = float(np.ceil(share / unit) * unit)
    return text.replace(found[0], f"set Join Within to {share:.3g} %")


def _size(vertices: NDArray[np.float64], corners: NDArray[Any]) -> float:
    """√ of the area, or 0 where it cannot be told."""
    one, two, three = (vertices[corner] for corner in corners.T)
    with np.errstate(all="ignore"):
        area = np.linalg.norm(np.cross(two - one, three - one), axis=1).sum() / 2
    return float(np.sqrt(area)) if np.isfinite(area) else 0.0
