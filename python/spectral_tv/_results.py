"""Classes of results that hold numbers and arrays alone."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]


class _Result:
    """One whose arrays are copies, the caller's to change."""

    def __getattribute__(self, name: str) -> Any:
        value = super().__getattribute__(name)
        return value.copy() if isinstance(value, np.ndarray) else value


@dataclass(frozen=True)
class Findings:
    """Counts of what was found in a mesh, and done about it; `Mesh.findings` are those of one.

    They are true if anything was done; as a string they say what, in one line.

    Attributes
    ----------
    border_corners : int
        Vertices on open edges, which belong to one triangle only, as they were handed in.
    joined_corners : int
        Those of them that were joined to another.
    closed_junctions : int
        Corners at which an open edge was split, each edge counted: T-junctions.
    dropped_vertices : int
        Vertices that are not finite and were dropped.
    dropped_triangles : int
        Triangles that were dropped with them.
    open_edges_before : int
        Edges of one triangle only, as they were handed in.
    open_edges : int
        Edges of one triangle only, in the mesh.
    components : int
        Connected components of the mesh, without vertices in no triangle.
    """

    border_corners: int
    joined_corners: int
    closed_junctions: int
    dropped_vertices: int
    dropped_triangles: int
    open_edges_before: int
    open_edges: int
    components: int
    told: str = field(repr=False, compare=False)

    def as_dict(self) -> dict[str, int]:
        """All counts by their names."""
        return {name: value for name, value in vars(self).items() if name != "told"}

    def __bool__(self) -> bool:
        return self.joined_corners + self.closed_junctions + self.dropped_vertices > 0

    def __str__(self) -> str:
        return self.told


@dataclass(frozen=True)
class Estimate:
    """What a decomposition takes, told by `estimate`.

    Attributes
    ----------
    bytes : int
        Memory at the peak, beside that of the mesh. Right to within a half.
    available : int | None
        Memory that this process could take when this was estimated: what is free, and what the
        limits of a container, a cluster's job or the process leave. None where the system does not
        tell.
    seconds : float
        Time that the work takes on an idle machine, right to within a factor of two. It is for
        the number of threads that `set_threads` and `use_threads` allow.
    """

    bytes: int
    available: int | None
    seconds: float

    @property
    def fits(self) -> bool:
        """Whether the first is not more than the second, so that `decompose` would start."""
        return self.available is None or self.bytes <= self.available


@dataclass(frozen=True, eq=False)
class Accuracy(_Result):
    """How the errors of a decomposition fall with the number of steps, measured by `accuracy`.

    Attributes without a prefix are of the package's steps and transform. Those with `paper_` are of
    the paper's: weights lagged by a step, and the residual R = T p(u(T)) + u(T) with p taken at
    u(T) (Brokman et al. 2024, Eq. 53). The all-pass filter of the paper's does not give the shape
    back.

    Attributes
    ----------
    steps : int64 array
        The numbers of steps, (n,).
    edges : array
        Where the bands begin and end, (K+1,), length².
    all_pass : array
        Distance of the all-pass filter's shape from the shape at every vertex, (n, V), length:
        rounding, by construction.
    paper_all_pass : array
        The same of the paper's transform, (n, V), length.
    bands : array
        Distance of the bands from those of the refined flow at every vertex, (n, V), length: the
        root of the sum of squares over the bands.
    paper_bands : array
        The same of the paper's steps, (n, V), length.
    relative : array
        L² error of each band over the surface, (n, K). Relative to the band's norm, but at least
        to 1e-12 of the largest norm.
    paper_relative : array
        The same of the paper's steps, (n, K).
    """

    steps: NDArray[np.int64] = field(repr=False)
    edges: Numbers = field(repr=False)
    all_pass: Numbers = field(repr=False)
    paper_all_pass: Numbers = field(repr=False)
    bands: Numbers = field(repr=False)
    paper_bands: Numbers = field(repr=False)
    relative: Numbers = field(repr=False)
    paper_relative: Numbers = field(repr=False)


@dataclass(frozen=True, eq=False)
class EigensetTest(_Result):
    """What a set C of vertices looks like as an eigenset, found by `eigenset_test`.

    Attributes
    ----------
    area : float
        |C|, length².
    perimeter : float
        per(C), length: of the shortest boundary, about, between the members and the rest. It
        does not follow the triangles. Where a set is narrower than some five edges, it cuts
        corners: by 1 to 2 % of the length.
    eigenvalue : float
        λ = per(C)/|C|, 1/length.
    rate : float
        How fast the value on C falls under the exact flow, 1/length: λ as measured.
    straightness : float
        R² of that fall as a straight line, down to extinction.
    spread : float
        The largest distance of the flow from having one value on C and one off it, relative to
        its norm, until it is down to 0.3. Some 0.15 where the boundary runs across triangles.
    times : array
        Times of the flow, (N+1,), length.
    values : array
        The median on C of ψ = 1 on C, −|C|/|M∖C| off it, at these times, (N+1,): max(1 − λt, 0)
        for an eigenset.
    perimeter_ratio : float
        The least per(D)/|M∖D| over the supersets D of C that were tried, relative to
        per(C)/|M∖C|. For an eigenset it is at least 1, up to discretization.
    superset : bool array
        The superset that has this ratio, (V,) bool.
    minimal_perimeter : bool
        Whether C is a locally minimal perimeter set as far as was tried: the ratio is at least
        0.99.
    is_eigenset : bool
        Whether C passes all tests of an eigenset: a minimal perimeter, a straightness of at least
        0.999, a rate within 15 % of the eigenvalue, a spread of at most 0.2.
    """

    area: float
    perimeter: float
    eigenvalue: float
    rate: float
    straightness: float
    spread: float
    times: Numbers = field(repr=False)
    values: Numbers = field(repr=False)
    perimeter_ratio: float
    superset: NDArray[np.bool_] = field(repr=False)
    minimal_perimeter: bool
    is_eigenset: bool


@dataclass(frozen=True, eq=False)
class Deformation(_Result):
    """A deformed shape, made by `deform` or a `Deformer`.

    Attributes
    ----------
    vertices : array
        Positions of the deformed shape, (V, 3).
    total_variation : float
        TV of the displacement, length².
    gap : float
        A bound on how far the energy is above the least, relative to itself: a duality gap, so a
        proof. For algorithms that do not minimise TV it tells how far from the optimum they
        ended.
    iterations : int
        Number of iterations.
    unconstrained : int64 array
        Vertices of connected components without any constraint, (U,): each such piece moves
        rigidly with the surface nearest to it.
    """

    vertices: Numbers = field(repr=False)
    total_variation: float
    gap: float
    iterations: int
    unconstrained: NDArray[np.int64] = field(repr=False)


@dataclass(frozen=True, eq=False)
class Pose(_Result):
    """A posed shape, made by `pose` or a `Poser`.

    Attributes
    ----------
    vertices : array
        Positions of the posed shape, (V, 3).
    rotations : array
        How the surface is turned at every vertex, (V, 4): unit quaternions w, x, y, z. A quaternion
        and its negative are the same rotation.
    energy : float
        What the pose costs, length²: 0 if all is at rest, or moves rigidly with its handles.
    decrement : float | None
        By how much a quadratic model of the energy, at the pose before the last step, predicts
        that the energy could be less, relative to itself. A small one certifies that the pose is
        nearly stationary: no small change lowers the energy. As the energy is not convex, it does
        not prove that no other pose costs less. It is above the tolerance where the iterations did
        not suffice, and None after `Poser.drag`, which does not compute it.
    movement : float
        The largest movement of a vertex in the last iteration, length.
    iterations : int
        Number of iterations.
    unconstrained : int64 array
        Vertices of connected components without any constraint, (U,): each such piece moves
        rigidly with the surface nearest to it.
    """

    vertices: Numbers = field(repr=False)
    rotations: Numbers = field(repr=False)
    energy: float
    decrement: float | None
    movement: float
    iterations: int
    unconstrained: NDArray[np.int64] = field(repr=False)


@dataclass(frozen=True, eq=False)
class Rig(_Result):
    """The pieces of a pose that move rigidly, the largest first, and the joints between them, found
    by `rig`.

    Attributes
    ----------
    labels : int64 array
        The piece of every vertex, (V,); −1 in joints.
    weights : array
        How much each piece moves each vertex, (V, P): 1 within, smooth in joints. Rows sum to 1.
    parents : int64 array
        The piece that each hangs on, (P,); −1 for one that hangs on none.
    heads : array
        The joint of each with its parent at rest, or the middle of one that hangs on none, (P, 3).
    tails : array
        The far end of each piece, seen from its head, (P, 3). Where one hangs on none, it is the
        joint of the largest that hangs on it.
    rotations : array
        How each piece is turned, (P, 4): unit quaternions w, x, y, z.
    translations : array
        Where its points go after that, (P, 3), length.
    """

    labels: NDArray[np.int64] = field(repr=False)
    weights: Numbers = field(repr=False)
    parents: NDArray[np.int64]
    heads: Numbers = field(repr=False)
    tails: Numbers = field(repr=False)
    rotations: Numbers = field(repr=False)
    translations: Numbers = field(repr=False)


@dataclass(frozen=True, eq=False)
class Folds(_Result):
    """What a displacement does to the faces of a mesh, found by `folds`.

    Attributes
    ----------
    flipped : int64 array
        Faces whose normals turn by over 90° against the mesh as it is, in order.
    stretched : int64 array
        Faces with an edge that becomes longer than the limit allows, in order.
    largest_stretch : float
        The largest length of an edge relative to what it was; 0 if no face has a size.
    safe_gain : float
        The least positive gain of the displacement at which a face folds but for a margin (a fifth
        of its area is left, as seen along its normal), or an edge reaches the limit. Below it
        nothing folds or stretches. Infinity if there is none.
    """

    flipped: NDArray[np.int64] = field(repr=False)
    stretched: NDArray[np.int64] = field(repr=False)
    largest_stretch: float
    safe_gain: float


@dataclass(frozen=True, eq=False)
class SafeDisplacement(_Result):
    """A displacement that folds and stretches nothing, made by `safe_displacement`.

    Attributes
    ----------
    displacement : array
        The displacement, clamped, (V, 3).
    shares : array
        The share of its displacement that each vertex keeps, (V,), in [0, 1].
    kept : float
        How long the clamped displacement is, relative to the one asked for; both as means over the
        area. 1 if nothing had to be clamped.
    rounds : int
        How many times shares were lowered.
    """

    displacement: Numbers = field(repr=False)
    shares: Numbers = field(repr=False)
    kept: float
    rounds: int
