"""What to decompose by, in the terms of the user: sizes are relative to the object's."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import spectral_tv

METHODS = (
    ("M1", "Shape Detail", "Surface detail of every size, the body undistorted (M1, shape TV)"),
    ("M2", "Limbs and Head", "Limbs, head, ears, tail (M2, conformalized 3-Laplace)"),
    ("M3", "Edge-Keeping Detail", "Detail with crisp edges: plates, folds (M3, directional TV)"),
    ("NAIVE", "Per Axis", "Each axis alone, which squares the shape along its axes"),
    ("HEAT", "Heat", "Linear diffusion, which blurs edges; for comparison"),
)
BASES = (
    ("FLOW", "Smoothed Shape", "The object itself, smoothed until its limbs are gone"),
    ("FLAT", "Flat", "The object flattened along its local Z axis: for reliefs and terrain"),
    ("KEY", "Shape Key", "One of the object's shape keys"),
)


@dataclass(frozen=True)
class Settings:
    """Arguments of a decomposition.

    Sizes are lengths relative to the square root of the surface area; 0 stands for what suits
    the method.
    """

    method: str = "M1"
    bands: int = 5
    steps: int = 32
    finest: float = 0.0
    largest: float = 0.0
    base: str = "FLOW"
    base_amount: float = 0.0
    base_key: str = ""
    vertex_group: str = ""

    def arguments(self, mesh: spectral_tv.Mesh, base: np.ndarray | None) -> dict[str, Any]:
        """Keyword arguments of spectral_tv.decompose; ``base`` (V, 3) for M3, if any.

        Raises spectral_tv.MeshError if the scales make no sense.
        """
        method = self.method.lower()
        scales = zip((self.finest, self.largest), spectral_tv.default_scales(method), strict=True)
        # A feature of the size l vanishes at a time of the order of l squared.
        finest, largest = (mesh.area * (size**2 or default) for size, default in scales)
        arguments: dict[str, Any] = {
            "method": method,
            "times": spectral_tv.graded_times(finest, largest, self.steps),
        }
        if self.method == "M3" and base is not None:
            arguments["base"] = base
        elif self.method == "M3" and self.base_amount:
            arguments["base_time"] = mesh.area * self.base_amount**2
        return arguments
