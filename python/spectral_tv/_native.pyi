from collections.abc import Callable, Sequence
from typing import Any, Literal, Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Accuracy",
    "Cancelled",
    "Decomposition",
    "Deformation",
    "Deformer",
    "EigensetTest",
    "Estimate",
    "Findings",
    "Flow",
    "Job",
    "Mesh",
    "MeshError",
    "MeshWarning",
    "__version__",
    "_restore",
    "_use_threads",
    "accuracy",
    "caricature",
    "conformal_flow",
    "cosegment",
    "decompose",
    "decompose_image",
    "default_base_time",
    "default_scales",
    "deform",
    "eigenpairs",
    "eigenset_test",
    "estimate",
    "flow",
    "graded_times",
    "set_threads",
    "start_accuracy",
    "start_caricature",
    "start_cosegment",
    "start_decompose",
    "start_decompose_image",
    "start_deform",
    "start_eigenset_test",
    "start_flow",
    "threads",
    "total_variation",
]
__version__: str

_Stepped = Literal["m1", "m2", "m3", "naive", "heat"]
_Method = Literal["m1", "m2", "m3", "naive", "heat", "lb", "displacement"]
_Scheme = Literal["extrapolated", "lagged", "exact"]
_Algorithm = Literal["convex", "paper", "harmonic", "biharmonic", "arap"]
_Solver = Literal["auto", "cholesky", "multigrid"]
_Progress = Callable[[float], object]

class MeshError(ValueError):
    vertices: NDArray[np.int64]
    faces: NDArray[np.int64]

class MeshWarning(UserWarning): ...
class Cancelled(Exception): ...

@final
class Mesh:
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any) -> Self: ...
    def __new__(
        cls,
        vertices: ArrayLike,
        triangles: ArrayLike,
        weld: float | None = None,
        broken: Literal["refuse", "drop"] = "refuse",
    ) -> Mesh: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def triangles(self) -> NDArray[np.int64]: ...
    @property
    def area(self) -> float: ...
    @property
    def face_areas(self) -> NDArray[np.float64]: ...
    @property
    def vertex_areas(self) -> NDArray[np.float64]: ...
    @property
    def weld_map(self) -> NDArray[np.int64]: ...
    @property
    def findings(self) -> Findings: ...

@final
class Findings:
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any) -> Self: ...
    @property
    def border_corners(self) -> int: ...
    @property
    def joined_corners(self) -> int: ...
    @property
    def closed_junctions(self) -> int: ...
    @property
    def dropped_vertices(self) -> int: ...
    @property
    def dropped_triangles(self) -> int: ...
    @property
    def open_edges_before(self) -> int: ...
    @property
    def open_edges(self) -> int: ...
    @property
    def components(self) -> int: ...
    def as_dict(self) -> dict[str, int]: ...
    def __bool__(self) -> bool: ...

@final
class Flow:
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any) -> Self: ...
    @property
    def times(self) -> NDArray[np.float64]: ...
    @property
    def states(self) -> NDArray[np.float64]: ...
    @property
    def total_variation(self) -> NDArray[np.float64]: ...
    @property
    def gap(self) -> NDArray[np.float64]: ...
    @property
    def spectrum(self) -> NDArray[np.float64]: ...
    @property
    def residual(self) -> NDArray[np.float64]: ...
    def band_edges(self, count: int) -> NDArray[np.float64]: ...
    def bands(self, edges: ArrayLike) -> NDArray[np.float64]: ...
    def filter(self, gains: ArrayLike | Callable[[float], float]) -> NDArray[np.float64]: ...
    def mean(self, weights: ArrayLike) -> NDArray[np.float64]: ...

@final
class Decomposition:
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any) -> Self: ...
    @property
    def times(self) -> NDArray[np.float64]: ...
    @property
    def spectrum(self) -> NDArray[np.float64]: ...
    @property
    def residual(self) -> NDArray[np.float64]: ...
    @property
    def flow(self) -> Flow: ...
    def band_edges(self, count: int) -> NDArray[np.float64]: ...
    def bands(self, edges: ArrayLike) -> NDArray[np.float64]: ...
    def filter(self, gains: ArrayLike | Callable[[float], float]) -> NDArray[np.float64]: ...

@final
class Accuracy:
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any) -> Self: ...
    @property
    def steps(self) -> NDArray[np.int64]: ...
    @property
    def edges(self) -> NDArray[np.float64]: ...
    @property
    def all_pass(self) -> NDArray[np.float64]: ...
    @property
    def paper_all_pass(self) -> NDArray[np.float64]: ...
    @property
    def bands(self) -> NDArray[np.float64]: ...
    @property
    def paper_bands(self) -> NDArray[np.float64]: ...
    @property
    def relative(self) -> NDArray[np.float64]: ...
    @property
    def paper_relative(self) -> NDArray[np.float64]: ...

@final
class Deformation:
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any) -> Self: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def total_variation(self) -> float: ...
    @property
    def gap(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def unconstrained(self) -> NDArray[np.int64]: ...

@final
class Deformer:
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any) -> Self: ...
    def __new__(
        cls,
        mesh: Mesh,
        indices: ArrayLike,
        weights: ArrayLike | None = None,
        softness: float = 0.0,
    ) -> Deformer: ...
    def drag(self, targets: ArrayLike) -> Deformation: ...
    def solve(
        self, targets: ArrayLike, tolerance: float = 1e-3, progress: _Progress | None = None
    ) -> Deformation: ...
    def solve_sequence(
        self,
        targets: Sequence[ArrayLike],
        tolerance: float = 1e-3,
        progress: _Progress | None = None,
    ) -> list[Deformation]: ...
    def start_solve(self, targets: ArrayLike, tolerance: float = 1e-3) -> Job: ...
    def start_solve_sequence(
        self, targets: Sequence[ArrayLike], tolerance: float = 1e-3
    ) -> Job: ...

@final
class EigensetTest:
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any) -> Self: ...
    @property
    def area(self) -> float: ...
    @property
    def perimeter(self) -> float: ...
    @property
    def eigenvalue(self) -> float: ...
    @property
    def rate(self) -> float: ...
    @property
    def straightness(self) -> float: ...
    @property
    def spread(self) -> float: ...
    @property
    def times(self) -> NDArray[np.float64]: ...
    @property
    def values(self) -> NDArray[np.float64]: ...
    @property
    def perimeter_ratio(self) -> float: ...
    @property
    def superset(self) -> NDArray[np.bool_]: ...
    @property
    def minimal_perimeter(self) -> bool: ...
    @property
    def is_eigenset(self) -> bool: ...

@final
class Estimate:
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any) -> Self: ...
    @property
    def bytes(self) -> int: ...
    @property
    def available(self) -> int | None: ...
    @property
    def fits(self) -> bool: ...
    @property
    def seconds(self) -> float: ...

@final
class Job:
    @property
    def progress(self) -> float: ...
    @property
    def done(self) -> bool: ...
    def cancel(self) -> None: ...
    def result(self, progress: _Progress | None = None) -> Any: ...

def decompose(
    mesh: Mesh,
    method: _Method = "m1",
    times: ArrayLike | None = None,
    steps: int = 32,
    progress: _Progress | None = None,
    *,
    accuracy: float | None = None,
    scheme: _Scheme = "extrapolated",
    tolerance: float = 1e-3,
    solver: _Solver = "auto",
    p: int = 3,
    base: ArrayLike | None = None,
    base_time: float | None = None,
    eigenpairs: int = 300,
    metric: Literal["surface", "base"] = "surface",
) -> Decomposition: ...
def start_decompose(
    mesh: Mesh,
    method: _Method = "m1",
    times: ArrayLike | None = None,
    steps: int = 32,
    *,
    accuracy: float | None = None,
    scheme: _Scheme = "extrapolated",
    tolerance: float = 1e-3,
    solver: _Solver = "auto",
    p: int = 3,
    base: ArrayLike | None = None,
    base_time: float | None = None,
    eigenpairs: int = 300,
    metric: Literal["surface", "base"] = "surface",
) -> Job: ...
def estimate(
    mesh: Mesh | int,
    method: _Method = "m1",
    times: ArrayLike | None = None,
    steps: int = 32,
    *,
    accuracy: float | None = None,
    scheme: _Scheme = "extrapolated",
    tolerance: float = 1e-3,
    solver: _Solver = "auto",
    p: int = 3,
    base: ArrayLike | None = None,
    base_time: float | None = None,
    eigenpairs: int = 300,
    metric: Literal["surface", "base"] = "surface",
) -> Estimate: ...
def decompose_image(
    image: ArrayLike,
    metric: Literal["flat", "surface"] = "flat",
    times: ArrayLike | None = None,
    steps: int = 32,
    progress: _Progress | None = None,
    *,
    height: float = 32.0,
    scheme: _Scheme = "extrapolated",
    tolerance: float = 1e-3,
    solver: _Solver = "auto",
) -> Flow: ...
def start_decompose_image(
    image: ArrayLike,
    metric: Literal["flat", "surface"] = "flat",
    times: ArrayLike | None = None,
    steps: int = 32,
    *,
    height: float = 32.0,
    scheme: _Scheme = "extrapolated",
    tolerance: float = 1e-3,
    solver: _Solver = "auto",
) -> Job: ...
def accuracy(
    mesh: Mesh,
    method: _Stepped = "m1",
    steps: ArrayLike | None = None,
    bands: int = 5,
    progress: _Progress | None = None,
    *,
    scales: tuple[float, float] | None = None,
    refinement: int = 8,
    scheme: _Scheme = "extrapolated",
    tolerance: float = 1e-3,
    solver: _Solver = "auto",
    p: int = 3,
    base: ArrayLike | None = None,
    base_time: float | None = None,
    metric: Literal["surface", "base"] = "surface",
) -> Accuracy: ...
def start_accuracy(
    mesh: Mesh,
    method: _Stepped = "m1",
    steps: ArrayLike | None = None,
    bands: int = 5,
    *,
    scales: tuple[float, float] | None = None,
    refinement: int = 8,
    scheme: _Scheme = "extrapolated",
    tolerance: float = 1e-3,
    solver: _Solver = "auto",
    p: int = 3,
    base: ArrayLike | None = None,
    base_time: float | None = None,
    metric: Literal["surface", "base"] = "surface",
) -> Job: ...
def eigenpairs(
    mesh: Mesh, count: int, progress: _Progress | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
def caricature(
    meshes: Sequence[Mesh],
    band: tuple[float, float],
    gain: float = 2.0,
    smooth: float = 0.0,
    method: _Method = "m3",
    steps: int = 32,
    progress: _Progress | None = None,
) -> list[NDArray[np.float64]]: ...
def start_caricature(
    meshes: Sequence[Mesh],
    band: tuple[float, float],
    gain: float = 2.0,
    smooth: float = 0.0,
    method: _Method = "m3",
    steps: int = 32,
) -> Job: ...
def cosegment(
    decompositions: Sequence[Decomposition],
    segments: int = 6,
    seed: int = 0,
    progress: _Progress | None = None,
) -> list[NDArray[np.int64]]: ...
def start_cosegment(
    decompositions: Sequence[Decomposition], segments: int = 6, seed: int = 0
) -> Job: ...
def deform(
    mesh: Mesh,
    indices: ArrayLike,
    targets: ArrayLike,
    weights: ArrayLike | None = None,
    softness: float = 0.0,
    tolerance: float = 1e-3,
    algorithm: _Algorithm = "convex",
    progress: _Progress | None = None,
) -> Deformation: ...
def start_deform(
    mesh: Mesh,
    indices: ArrayLike,
    targets: ArrayLike,
    weights: ArrayLike | None = None,
    softness: float = 0.0,
    tolerance: float = 1e-3,
    algorithm: _Algorithm = "convex",
) -> Job: ...
def eigenset_test(
    mesh: Mesh, members: ArrayLike, progress: _Progress | None = None
) -> EigensetTest: ...
def start_eigenset_test(mesh: Mesh, members: ArrayLike) -> Job: ...
def flow(
    mesh: Mesh,
    values: ArrayLike,
    times: ArrayLike,
    operator: Literal["tv", "heat"] = "tv",
    exact: bool = False,
    progress: _Progress | None = None,
    *,
    scheme: _Scheme = "extrapolated",
    tolerance: float = 1e-3,
    solver: _Solver = "auto",
) -> Flow: ...
def start_flow(
    mesh: Mesh,
    values: ArrayLike,
    times: ArrayLike,
    operator: Literal["tv", "heat"] = "tv",
    exact: bool = False,
    *,
    scheme: _Scheme = "extrapolated",
    tolerance: float = 1e-3,
    solver: _Solver = "auto",
) -> Job: ...
def conformal_flow(
    mesh: Mesh,
    time: float,
    steps: int = 10,
    progress: _Progress | None = None,
    *,
    solver: _Solver = "auto",
) -> NDArray[np.float64]: ...
def total_variation(mesh: Mesh, values: ArrayLike) -> float: ...
def default_base_time() -> float: ...
def default_scales(method: _Method, eigenpairs: int = 300) -> tuple[float, float]: ...
def graded_times(finest: float, largest: float, steps: int = 32) -> NDArray[np.float64]: ...
def set_threads(count: int | None) -> None: ...
def threads() -> int: ...
def _use_threads(count: int | None) -> int | None: ...
def _restore(class_: str, format: int, version: str, parts: dict[str, Any]) -> Any: ...
