"""The bands of the paper, and those that Blender makes where nothing is chosen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import spectral_tv

COUNT, STEPS = 5, 32


@dataclass(frozen=True)
class Bands:
    """Bands by a method, made by these options of the package."""

    method: str
    options: Mapping[str, Any] = field(default_factory=dict)
    keep_limbs: float = 0.0

    def of(self, mesh: spectral_tv.Mesh, count: int = COUNT, steps: int = STEPS) -> np.ndarray:
        """What each band of a mesh adds to its low-pass, (count, V, 3)."""
        split = spectral_tv.decompose(mesh, self.method, steps=steps, **self.options)
        return split.bands(split.band_edges(count), self.keep_limbs)


PAPER = {method: Bands(method) for method in ("m1", "m2", "m3")}
M1 = partial(Bands, "m1", {"soft_edges": 0.3})
SHIPPED = {
    "m1": M1(1.0),
    "m2": PAPER["m2"],
    "m3": Bands("m3", {"base": "limbs", "displacement": "vector"}),
}
# Exaggerate Selected: its bands, and how much of each is added.
CARICATURE, AMOUNTS = M1(0.5), (-1, 0, 1.5, 1.5, 1.5)


def mixed(mesh: spectral_tv.Mesh, bands: np.ndarray, values: object) -> np.ndarray:
    """The shape with so much of each band added, (V, 3)."""
    return mesh.vertices + np.tensordot(np.asarray(values, dtype=float), bands, 1)
