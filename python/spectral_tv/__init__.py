"""Spectral total-variation processing of shapes.

The methods of Brokman, Burger and Gilboa 2024, "Spectral Total-Variation Processing of Shapes -
Theory and Applications", on triangle meshes given as NumPy arrays. V vertices, F triangles,
N steps, C channels; lengths are in the unit of the mesh, times in length squared.

>>> mesh = spectral_tv.Mesh(vertices, triangles)
>>> split = spectral_tv.decompose(mesh, method="m1")
>>> bands = split.bands(split.band_edges(5))          # (5, V, 3), finest first
>>> smooth = split.residual + bands[2:].sum(axis=0)   # without the two finest

>>> spectral_tv.DEFAULTS["steps"], spectral_tv.METHODS["m3"].options  # what decompose takes

>>> mesh = spectral_tv.Mesh(vertices, triangles, weld=1e-6)  # joins near corners
>>> bands[:, mesh.weld_map]                            # at the vertices that were handed in

>>> mesh = spectral_tv.Mesh.of(surface)                # of trimesh, meshio, PyVista or Open3D
>>> spectral_tv.in_kind(surface, smooth)               # and a copy of it with other vertices

>>> bent = spectral_tv.deform(mesh, indices, targets)  # the others follow in rigid pieces
>>> bent.vertices, bent.gap                            # (V, 3), and how near to the optimum

>>> posed = spectral_tv.pose(mesh, indices, targets)   # the pieces turn, with joints between them
>>> posed.vertices, posed.rotations                    # (V, 3), and (V, 4) unit quaternions

>>> taken = spectral_tv.transfer(scan, retopology)     # to other vertices in about the same place
>>> taken.vectors(bands), taken.missed                 # (5, N, 3), and (N,)
"""

# ruff: noqa: F403, F405 - the names are those of __all__

from importlib import import_module
from typing import TYPE_CHECKING, Any

from spectral_tv._copies import prepare
from spectral_tv._native import (
    Cancelled,
    Decomposition,
    Deformer,
    Flow,
    Job,
    Mesh,
    MeshError,
    MeshWarning,
    Poser,
    __version__,
    set_threads,
    suiting_elements,
    threads,
    total_variation,
)
from spectral_tv._options import DEFAULTS, METHODS, MethodFacts

if TYPE_CHECKING:
    from spectral_tv._functions import *
else:

    def __getattr__(name: str) -> Any:
        """Read the functions and results when the first of them is asked for."""
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        found = getattr(import_module("spectral_tv._functions"), name)
        globals()[name] = found
        return found


prepare()


def __dir__() -> list[str]:
    return ["__all__", *__all__]


__all__ = [
    "DEFAULTS",
    "METHODS",
    "Accuracy",
    "Cancelled",
    "Carried",
    "Decomposition",
    "Deformation",
    "Deformer",
    "EigensetTest",
    "Estimate",
    "Findings",
    "Flow",
    "Folds",
    "Job",
    "Mesh",
    "MeshError",
    "MeshWarning",
    "MethodFacts",
    "Pose",
    "Poser",
    "Rig",
    "SafeDisplacement",
    "Transfer",
    "__version__",
    "accuracy",
    "caricature",
    "carry",
    "conformal_flow",
    "cosegment",
    "decompose",
    "decompose_image",
    "decompose_sequence",
    "default_base_time",
    "default_scales",
    "deform",
    "eigenpairs",
    "eigenset_test",
    "estimate",
    "flow",
    "folds",
    "graded_times",
    "in_kind",
    "pose",
    "progress_bar",
    "rig",
    "safe_displacement",
    "self_intersections",
    "set_threads",
    "start_accuracy",
    "start_caricature",
    "start_cosegment",
    "start_decompose",
    "start_decompose_image",
    "start_deform",
    "start_eigenset_test",
    "start_flow",
    "start_pose",
    "start_rig",
    "start_safe_displacement",
    "start_self_intersections",
    "start_thickness",
    "suiting_elements",
    "thickness",
    "threads",
    "total_variation",
    "transfer",
    "use_threads",
]
