"""Sums of F-curves."""

from collections.abc import Callable, Iterator, Sequence
from itertools import chain, pairwise

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from .fcurves import TOGETHER, Point
from .temporary import Temporary

# A jump between two keyframes takes so long, in frames.
JUMP = 0.02
# How far a sum may be off between its keyframes, relative to its range, and how often an interval
# is halved for that.
TOLERANCE, HALVINGS = 1e-4, 6


@dataclass(frozen=True)
class Term:
    """A weighted part of a sum: a curve, or a value that stays."""

    weight: float
    value: float
    curve: bpy.types.FCurve | None = None


def total(terms: Sequence[Term]) -> list[Point]:
    """The keyframes of a sum of which at least one term is a curve.

    It is exact where a single curve takes part, or all have keyframes of one kind on the same
    frames; else there are as many keyframes as it takes to be off by a ten-thousandth of the range.
    """
    moving = [term for term in terms if term.curve is not None]
    offset = sum(term.weight * term.value for term in terms if term.curve is None)
    columns = [[Point.of(point) for point in term.curve.keyframe_points] for term in moving]
    kinds = {tuple(point.kinds for point in column) for column in columns}
    if len(kinds) > 1:
        return _sampled(moving, offset)
    points = [point.mapped(moving[0].weight, offset) for point in columns[0]]
    for term, column in zip(moving[1:], columns[1:], strict=True):
        parts = (point.mapped(term.weight, 0.0) for point in column)
        points = [one.plus(two) for one, two in zip(points, parts, strict=True)]
    return points


def _sampled(moving: Sequence[Term], offset: float) -> list[Point]:
    """The sum of curves of any kind: on all their frames, and between them as often as needed."""
    with Temporary() as now:
        for modifier in chain.from_iterable(term.curve.modifiers for term in moving):
            now.put(modifier, "mute", True)  # the sum gets them
        return list(_Sum(moving, offset).points())


class _Sum:
    """A sum of curves, by what it is at any time."""

    def __init__(self, moving: Sequence[Term], offset: float) -> None:
        self.moving, self.offset = moving, offset
        frames = sorted(point.co[0] for term in moving for point in term.curve.keyframe_points)
        self.frames = [frames[0]]
        self.frames += [two for one, two in pairwise(frames) if two - one > TOGETHER]
        values = [self(frame) for frame in self.frames]
        self.tolerance = TOLERANCE * max(np.ptp(values), 1e-3 * np.abs(values).max(), 1e-9)

    def __call__(self, frame: float) -> float:
        terms = (term.weight * term.curve.evaluate(frame) for term in self.moving)
        return self.offset + sum(terms)

    def points(self) -> Iterator[Point]:
        """Keyframes, in order."""
        arriving = _level(self.frames[0], self(self.frames[0]))
        for start, end in pairwise(self.frames):
            value, before_end = self(start), self(end - JUMP / 2)
            kinds = {_kind(term.curve, start) for term in self.moving}
            if kinds == {"CONSTANT"}:
                yield _leaving(arriving, start, value, "CONSTANT")
                arriving = _level(end, self(end))
                continue
            slope = abs(self(end - JUMP) - before_end)
            has_jump = (
                end - start > 4 * JUMP and abs(self(end) - before_end) > slope + 10 * self.tolerance
            )
            stop = end - JUMP if has_jump else end
            if kinds <= {"LINEAR", "CONSTANT"}:
                yield _leaving(arriving, start, value, "LINEAR")
                arriving = _level(stop, self(stop))
            else:
                for piece in self._pieces(start, stop, HALVINGS):
                    yield _leaving(arriving, piece.start, piece.first, "BEZIER", piece.leaving)
                    arriving = (piece.end, piece.last), piece.arriving
            if has_jump:
                yield _leaving(arriving, stop, self(stop), "LINEAR")
                arriving = _level(end, self(end))
        yield _leaving(arriving, self.frames[-1], self(self.frames[-1]), "BEZIER")

    def _pieces(self, start: float, end: float, halvings: int) -> Iterator["_Cubic"]:
        """Cubics that follow the sum."""
        piece = _Cubic.through(self, start, end)
        inside = np.linspace(start, end, 9)[1:-1]
        apart = max(abs(piece(frame) - self(frame)) for frame in inside)
        if apart <= self.tolerance or not halvings:
            yield piece
            return
        middle = (start + end) / 2
        yield from self._pieces(start, middle, halvings - 1)
        yield from self._pieces(middle, end, halvings - 1)


@dataclass(frozen=True)
class _Cubic:
    """A cubic from ``first`` at ``start`` to ``last`` at ``end``, and its slopes there."""

    start: float
    end: float
    first: float
    last: float
    slopes: tuple[float, float]

    @classmethod
    def through(cls, values: Callable[[float], float], start: float, end: float) -> "_Cubic":
        """The one that touches ``values`` at both ends."""
        step = (end - start) / 64
        first, last = values(start), values(end)
        one, two = values(start + step), values(start + 2 * step)
        leaving = (4 * one - 3 * first - two) / (2 * step)
        one, two = values(end - step), values(end - 2 * step)
        arriving = (3 * last - 4 * one + two) / (2 * step)
        return cls(start, end, first, last, (leaving, arriving))

    def __call__(self, frame: float) -> float:
        length = self.end - self.start
        t = (frame - self.start) / length
        h00, h10 = (1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2
        h01, h11 = t**2 * (3 - 2 * t), t**2 * (t - 1)
        slopes = h10 * self.slopes[0] + h11 * self.slopes[1]
        return h00 * self.first + h01 * self.last + length * slopes

    @property
    def leaving(self) -> tuple[float, float]:
        """The handle at its start: with thirds in time, a Bézier curve is this cubic."""
        third = (self.end - self.start) / 3
        return self.start + third, self.first + third * self.slopes[0]

    @property
    def arriving(self) -> tuple[float, float]:
        """The handle at its end."""
        third = (self.end - self.start) / 3
        return self.end - third, self.last - third * self.slopes[1]


# Where a piece ends, and the handle there.
Arriving = tuple[tuple[float, float], tuple[float, float]]


def _level(frame: float, value: float) -> Arriving:
    return (frame, value), (frame - 1 / 3, value)


def _leaving(
    arriving: Arriving,
    frame: float,
    value: float,
    interpolation: str,
    handle: tuple[float, float] | None = None,
) -> Point:
    """The keyframe between the piece that arrives there and the one that begins."""
    _, left = arriving
    right = handle or (frame + 1 / 3, value)
    return Point((frame, value), left, right, interpolation=interpolation)


def _kind(curve: bpy.types.FCurve, frame: float) -> str:
    """How a curve goes on from a frame: "CONSTANT" where it stays, "LINEAR", or anything else."""
    before = [point for point in curve.keyframe_points if point.co[0] <= frame + TOGETHER]
    if not before or len(before) == len(curve.keyframe_points):
        return "CONSTANT" if curve.extrapolation == "CONSTANT" else "LINEAR"
    return before[-1].interpolation
