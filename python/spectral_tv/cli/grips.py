"""The parts of a file's surface that are held and moved."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from spectral_tv.cli.reading import Read
from spectral_tv.cli.surface import Surface
from spectral_tv.dataclass import dataclass
from spectral_tv.deformation.held import Held, constraining, note_soft_pin
from spectral_tv.deformation.regions import EXAMPLES, Region
from spectral_tv.refusal import Refusal

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Grips:
    """What is constrained, and where that goes, (K, 3)."""

    held: Held
    targets: Numbers

    @classmethod
    def of(
        cls,
        read: Read,
        surface: Surface,
        pins: Sequence[str],
        moves: Sequence[tuple[str, tuple[float, ...]]],
        *,
        is_free: bool,
    ) -> "Grips":
        """Read parts by their names; those that move are free to turn if ``is_free``.

        Raises Refusal if a part is missing or empty, or two of them do not go together.
        """
        parts: list[tuple[str, tuple[float, ...], bool]]
        parts = [(where, (0.0, 0.0, 0.0), False) for where in pins]
        parts += [(where, offset, True) for where, offset in moves]
        found = []
        for number, (where, offset, is_moved) in enumerate(parts):
            indices, weights = _part(read, surface, where)
            if not is_moved:
                note_soft_pin(where, weights)
            body = number if is_moved and is_free else -1
            found.append((indices, weights, np.tile(offset, (len(indices), 1)), body))
        _ensure_apart([where for where, _, _ in parts], found)
        indices, weights, offsets = (np.concatenate([each[k] for each in found]) for k in range(3))
        bodies = np.concatenate([np.full(len(each[0]), each[3]) for each in found])
        held = Held(surface.mesh, indices, weights, lambda: bodies)
        return cls(held, surface.mesh.vertices[indices] + offsets)


Part = tuple[NDArray[np.int64], Numbers, Numbers, int]


def _part(read: Read, surface: Surface, where: str) -> tuple[NDArray[np.int64], Numbers]:
    """The vertices of the mesh in a part, and their weights."""
    name = next((each for each in (where, where.strip()) if each in read.values), None)
    region = Region.read(where)
    if name is not None:
        weights = read.weights(name)
    elif region is not None:
        weights = _weights_in(region, read, surface)
    else:
        there = ", ".join(read.values) or "none"
        raise Refusal(
            f"there are no numbers {where!r} at its vertices; there are: {there}; {EXAMPLES}"
        )
    merged = np.zeros(len(surface.mesh.vertex_areas))
    is_there = surface.place >= 0
    np.maximum.at(merged, surface.place[is_there], weights[is_there])
    is_in, found = constraining(merged)
    if not len(found):
        raise Refusal(
            f"the numbers {name!r} are 0 at every vertex"
            if name is not None or region is None
            else f"the region {region.name!r} holds no vertex"
        )
    return np.flatnonzero(is_in), found


def _weights_in(region: Region, read: Read, surface: Surface) -> Numbers:
    weights = np.zeros(len(read.vertices))
    there = np.flatnonzero(surface.place >= 0)
    weights[there[region.members(read.vertices[there, region.place])]] = 1.0
    return weights


def _ensure_apart(names: Sequence[str], parts: Sequence[Part]) -> None:
    """Raise Refusal if parts that go different ways have vertices in common."""
    for number, (indices, weights, offsets, body) in enumerate(parts):
        for other, (indices_, weights_, offsets_, body_) in enumerate(parts[:number]):
            both, one, two = np.intersect1d(indices, indices_, return_indices=True)
            if not len(both):
                continue
            is_same = np.array_equal(offsets[0], offsets_[0])
            is_exact = bool(((weights[one] == 1) & (weights_[two] == 1)).any())
            if (body >= 0 and body_ >= 0) or (is_exact and not is_same):
                raise Refusal(
                    f"{len(both)} vertices are in both {names[other]!r} and {names[number]!r}, "
                    "which go different ways; leave them out of one"
                )
