from collections.abc import Callable, Mapping, Sequence
from types import GenericAlias
from typing import Any, Generic, Literal, Self, TypeVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_tv._options import Progress
from spectral_tv._results import (
    Accuracy,
    Deformation,
    EigensetTest,
    Estimate,
    Findings,
    Folds,
    Pose,
    Rig,
    SafeDisplacement,
)

__version__: str
_POSING: dict[str, float]
_STRETCH: float

class MeshError(ValueError):
    vertices: NDArray[np.int64]
    faces: NDArray[np.int64]

class MeshWarning(UserWarning): ...
class Cancelled(Exception): ...

@final
class Mesh:
    def __copy__(self, *_: object) -> Self: ...
    def __deepcopy__(self, *_: object) -> Self: ...
    def __new__(
        cls,
        vertices: ArrayLike,
        triangles: ArrayLike,
        weld: float | None = None,
        broken: Literal["refuse", "drop"] = "refuse",
    ) -> Mesh: ...
    @staticmethod
    def of(
        surface: object,
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

class _Spectral:
    def __copy__(self, *_: object) -> Self: ...
    def __deepcopy__(self, *_: object) -> Self: ...
    @property
    def times(self) -> NDArray[np.float64]: ...
    @property
    def spectrum(self) -> NDArray[np.float64]: ...
    @property
    def residual(self) -> NDArray[np.float64]: ...
    def band_edges(self, count: int) -> NDArray[np.float64]: ...

@final
class Flow(_Spectral):
    def bands(self, edges: ArrayLike) -> NDArray[np.float64]: ...
    def filter(self, gains: ArrayLike | Callable[[float], float]) -> NDArray[np.float64]: ...
    @property
    def states(self) -> NDArray[np.float64]: ...
    @property
    def total_variation(self) -> NDArray[np.float64]: ...
    @property
    def gap(self) -> NDArray[np.float64]: ...
    def mean(self, weights: ArrayLike) -> NDArray[np.float64]: ...

@final
class Decomposition(_Spectral):
    def bands(self, edges: ArrayLike, keep_limbs: float = 0.0) -> NDArray[np.float64]: ...
    def filter(
        self, gains: ArrayLike | Callable[[float], float], keep_limbs: float = 0.0
    ) -> NDArray[np.float64]: ...
    @property
    def flow(self) -> Flow: ...

@final
class Deformer:
    def __new__(
        cls,
        mesh: Mesh,
        indices: ArrayLike,
        weights: ArrayLike | None = None,
        softness: float = 0.0,
    ) -> Deformer: ...
    @staticmethod
    def start(
        mesh: Mesh,
        indices: ArrayLike,
        weights: ArrayLike | None = None,
        softness: float = 0.0,
    ) -> Job[Deformer]: ...
    def drag(self, targets: ArrayLike) -> Deformation: ...
    def solve(
        self, targets: ArrayLike, tolerance: float = 1e-3, progress: Progress | None = None
    ) -> Deformation: ...
    def solve_sequence(
        self,
        targets: Sequence[ArrayLike],
        tolerance: float = 1e-3,
        progress: Progress | None = None,
    ) -> list[Deformation]: ...
    def start_drag(self, targets: ArrayLike) -> Job[Deformation]: ...
    def start_solve(self, targets: ArrayLike, tolerance: float = 1e-3) -> Job[Deformation]: ...
    def start_solve_sequence(
        self, targets: Sequence[ArrayLike], tolerance: float = 1e-3
    ) -> Job[list[Deformation]]: ...

@final
class Poser:
    def __new__(
        cls,
        mesh: Mesh,
        indices: ArrayLike,
        weights: ArrayLike | None = None,
        bodies: ArrayLike | None = None,
        joint_softness: float = 1.0,
        stiffness: float = 0.03,
        stillness: float = 0.5,
    ) -> Poser: ...
    @staticmethod
    def start(
        mesh: Mesh,
        indices: ArrayLike,
        weights: ArrayLike | None = None,
        bodies: ArrayLike | None = None,
        joint_softness: float = 1.0,
        stiffness: float = 0.03,
        stillness: float = 0.5,
    ) -> Job[Poser]: ...
    @property
    def joint_softness(self) -> float: ...
    @property
    def stiffness(self) -> float: ...
    @property
    def stillness(self) -> float: ...
    def set_parameters(
        self,
        joint_softness: float | None = None,
        stiffness: float | None = None,
        stillness: float | None = None,
    ) -> None: ...
    def drag(self, targets: ArrayLike) -> Pose: ...
    def solve(
        self, targets: ArrayLike, tolerance: float = 1e-4, progress: Progress | None = None
    ) -> Pose: ...
    def solve_sequence(
        self,
        targets: Sequence[ArrayLike],
        tolerance: float = 1e-4,
        progress: Progress | None = None,
    ) -> list[Pose]: ...
    def start_drag(self, targets: ArrayLike) -> Job[Pose]: ...
    def start_solve(self, targets: ArrayLike, tolerance: float = 1e-4) -> Job[Pose]: ...
    def start_solve_sequence(
        self, targets: Sequence[ArrayLike], tolerance: float = 1e-4
    ) -> Job[list[Pose]]: ...

_T = TypeVar("_T")

@final
class Job(Generic[_T]):
    @classmethod
    def __class_getitem__(cls, item: Any) -> GenericAlias: ...
    @property
    def progress(self) -> float: ...
    @property
    def done(self) -> bool: ...
    def cancel(self) -> None: ...
    def result(self, progress: Progress | None = None) -> _T: ...
    def _wait(self, progress: Progress | None) -> _T: ...

def start_decompose(mesh: Mesh, options: Mapping[str, Any]) -> Job[Decomposition]: ...
def estimate(mesh: Mesh | int, options: Mapping[str, Any]) -> Estimate: ...
def start_accuracy(
    mesh: Mesh,
    steps: ArrayLike,
    bands: int,
    scales: tuple[float, float] | None,
    refinement: int,
    keep_limbs: float,
    options: Mapping[str, Any],
) -> Job[Accuracy]: ...
def start_caricature(
    meshes: Sequence[Mesh],
    band: tuple[float, float],
    gain: float,
    smooth: float,
    keep_limbs: float,
    options: Mapping[str, Any],
) -> Job[list[NDArray[np.float64]]]: ...
def start_conformal_flow(
    mesh: Mesh, time: float, steps: int, solver: str
) -> Job[NDArray[np.float64]]: ...
def start_cosegment(
    decompositions: Sequence[Decomposition], segments: int, seed: int
) -> Job[list[NDArray[np.int64]]]: ...
def start_decompose_image(
    image: ArrayLike,
    metric: str,
    times: ArrayLike | None,
    steps: int,
    height: float,
    options: Mapping[str, Any],
) -> Job[Flow]: ...
def start_deform(
    mesh: Mesh,
    indices: ArrayLike,
    targets: ArrayLike,
    weights: ArrayLike | None,
    softness: float,
    tolerance: float,
    algorithm: str,
) -> Job[Deformation]: ...
def start_eigenpairs(
    mesh: Mesh, count: int
) -> Job[tuple[NDArray[np.float64], NDArray[np.float64]]]: ...
def start_eigenset_test(mesh: Mesh, members: ArrayLike, elements: str) -> Job[EigensetTest]: ...
def suiting_elements(values: ArrayLike) -> str: ...
def start_flow(
    mesh: Mesh,
    values: ArrayLike,
    times: ArrayLike,
    operator: str,
    elements: str | None,
    options: Mapping[str, Any],
) -> Job[Flow]: ...
def folds(mesh: Mesh, displacement: ArrayLike, stretch: float) -> Folds: ...
def start_pose(
    mesh: Mesh,
    indices: ArrayLike,
    targets: ArrayLike,
    weights: ArrayLike | None,
    bodies: ArrayLike | None,
    parameters: Mapping[str, Any],
    tolerance: float,
) -> Job[Pose]: ...
def start_rig(mesh: Mesh, vertices: ArrayLike, rotations: ArrayLike) -> Job[Rig]: ...
def start_safe_displacement(
    mesh: Mesh, displacement: ArrayLike, stretch: float
) -> Job[SafeDisplacement]: ...
def start_self_intersections(
    mesh: Mesh, displacement: ArrayLike | None
) -> Job[NDArray[np.int64]]: ...
def total_variation(mesh: Mesh, values: ArrayLike) -> float: ...
def start_thickness(mesh: Mesh) -> Job[NDArray[np.float64]]: ...
def default_base_time(options: Mapping[str, Any]) -> float: ...
def default_scales(options: Mapping[str, Any]) -> tuple[float, float]: ...
def graded_times(finest: float, largest: float, steps: int) -> NDArray[np.float64]: ...
def set_threads(count: int | None) -> None: ...
def threads() -> int: ...
def _facts() -> tuple[dict[str, Any], dict[str, dict[str, Any]]]: ...
def _use_threads(count: int | None) -> int | None: ...
def _reduced(object: Any) -> tuple[Callable[..., Any], tuple[Any, ...]]: ...
def _restore(class_: str, format: int, version: str, parts: dict[str, Any]) -> Any: ...
