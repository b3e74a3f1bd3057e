"""Meshes with a slider for each band."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spectral_tv._native import Decomposition
from spectral_tv._optional import needed
from spectral_tv._plotting import edges_of

# Values of a slider: at −1 the band is gone, at 0 nothing changes, at 1 it is doubled.
RANGE = (-1.0, 2.0)
# In fractions of the window.
LEFT, RIGHT, LOWEST, HIGHEST = 0.03, 0.28, 0.1, 0.9


def show(split: Decomposition, edges: ArrayLike | None, keep_limbs: float, plotter: Any) -> Any:
    """Add the mesh and its sliders to a plotter of PyVista, or to a new one and show that."""
    pyvista = needed("pyvista", "show()", "pyvista")
    bands = split.bands(edges_of(split, edges), keep_limbs)
    mesh = split.mesh
    shape = mesh.vertices
    surface = pyvista.PolyData.from_regular_faces(shape, mesh.triangles)
    window = pyvista.Plotter() if plotter is None else plotter
    window.add_mesh(surface, color="lightgray", smooth_shading=False)
    values = np.zeros(len(bands))

    def setting(band: int) -> Callable[[float], None]:
        def set_value(value: float) -> None:
            values[band] = value
            surface.points = shape + np.tensordot(values, bands, 1)

        return set_value

    heights = np.linspace(HIGHEST, LOWEST, len(bands))
    for band, height in enumerate(heights):
        window.add_slider_widget(
            setting(band),
            RANGE,
            value=0.0,
            title=f"Band {band + 1}",
            pointa=(LEFT, height),
            pointb=(RIGHT, height),
            style="modern",
            title_height=0.02,
            interaction_event="always",
        )
    return window.show() if plotter is None else window
