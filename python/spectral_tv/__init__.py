"""Spectral total-variation processing of shapes.

The methods of Brokman, Burger and Gilboa 2024, "Spectral Total-Variation Processing of Shapes -
Theory and Applications", on triangle meshes given as NumPy arrays. V vertices, F triangles,
N steps, C channels; lengths are in the unit of the mesh, times in length squared.

>>> mesh = spectral_tv.Mesh(vertices, triangles)
>>> split = spectral_tv.decompose(mesh, method="m1")
>>> bands = split.bands(split.band_edges(5))          # (5, V, 3), finest first
>>> smooth = split.residual + bands[2:].sum(axis=0)   # without the two finest
"""

from spectral_tv._native import (
    Cancelled,
    Decomposition,
    Flow,
    Job,
    Mesh,
    MeshError,
    __version__,
    conformal_flow,
    decompose,
    default_scales,
    flow,
    graded_times,
    start_decompose,
    total_variation,
)

__all__ = [
    "Cancelled",
    "Decomposition",
    "Flow",
    "Job",
    "Mesh",
    "MeshError",
    "__version__",
    "conformal_flow",
    "decompose",
    "default_scales",
    "flow",
    "graded_times",
    "start_decompose",
    "total_variation",
]
