"""Splitting the frames of a moving shape into bands by one filter."""

from collections.abc import Iterable, Iterator
from typing import Unpack

from numpy.typing import ArrayLike

from spectral_tv._native import Decomposition, Mesh
from spectral_tv._options import STEPS, DecomposeOptions, Method, Progress
from spectral_tv._work import spelled
from spectral_tv.bands.fixed_scales import FixedScales


@spelled
def decompose_sequence(
    meshes: Iterable[Mesh],
    method: Method = "m1",
    times: ArrayLike | None = None,
    steps: int = STEPS,
    area: float | None = None,
    keeps_limbs: bool = False,
    progress: Progress | None = None,
    **options: Unpack[DecomposeOptions],
) -> Iterator[Decomposition]:
    """Split the frames of a moving shape into scales, by one filter that does not flicker.

    Each frame is decomposed by itself. The times of the flow, and so the edges of bands, are the
    same in all: defaults that depend on the area do so in the first frame, and steps that an
    `accuracy` asks for are those of the first. Limbs are kept by a thickness that goes on from
    frame to frame, see `thickness`. Frames may have other vertices and triangles than those before.

    Parameters
    ----------
    meshes : iterable of Mesh
        The frames, taken one by one.
    {method}
    times : (N+1,) array, optional
        As `decompose` takes them, the same for all frames.
    steps : int
        The number of steps N, if no times are given.
    area : float, optional
        The area that defaults go by, length², in place of that of the first frame: such as the
        median over the frames, where the first is no typical one.
    keeps_limbs : bool
        Whether bands will be cut with `keep_limbs`. Only then, and for a base that keeps limbs, is
        the thickness measured.
    {progress}
        It begins anew for each frame.
    {options}

    Yields
    ------
    Decomposition
        Of each frame, as it is asked for. `bands` and `filter` take the same edges and gains in
        all.

    Raises
    ------
    MeshError, MemoryError
        As `decompose`.
    """
    given = {"method": method, "times": times, "steps": steps, **options}
    fixed = FixedScales(given, area, keeps_limbs=keeps_limbs)
    for mesh in meshes:
        job = fixed.start_thickness(mesh)
        frame = fixed.taken(mesh, None if job is None else job._wait(None))
        split = fixed.start(frame)._wait(progress)
        fixed.learn(split)
        yield split
