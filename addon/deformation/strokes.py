"""Patches that are picked one after the other, the last of which may still grow."""

from __future__ import annotations

from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from .geodesics import Spread
from .held import Picked
from .picking import Patches


@dataclass
class _Stroke:
    """A patch: what is around its middle, and the part of that which can be taken."""

    name: str
    spread: Spread
    is_pulled: bool
    radius: float
    free: np.ndarray
    left_out: int


class Strokes:
    """What is picked of an object: several patches that are held or pulled."""

    def __init__(self, patches: Patches) -> None:
        """Nothing is picked yet."""
        self.patches = patches
        self._done: list[_Stroke] = []
        self._last: _Stroke | None = None

    @property
    def left_out(self) -> int:
        """How many vertices of the surface were picked that cannot be taken."""
        return sum(each.left_out for each in self._done)

    @property
    def last(self) -> _Stroke | None:
        """The one that still grows."""
        return self._last

    def begin(self, spread: Spread, is_pulled: bool, radius: float = 0.0, name: str = "") -> None:
        """Pick a patch; a radius of 0 is the usual one. Those held of one name are one group.

        Raises Refusal if its middle cannot be taken.
        """
        self._last = _Stroke(name, spread, is_pulled, 0.0, np.zeros(0, dtype=bool), 0)
        self.grow(0.0)
        if not self._last.free.any():
            self._last = None
            raise Refusal("what is pulled cannot be held, or pulled twice" if not is_pulled
                          else "this is held or pulled already; pick another place")  # fmt: skip
        self.grow(radius or self.patches.usual_radius)

    def grow(self, radius: float) -> None:
        """Give the last one another radius."""
        stroke = self._last
        patch = stroke.spread.within(radius)
        # What is held can be held twice.
        others = [each.free for each in self._done if stroke.is_pulled or each.is_pulled]
        stroke.free = self.patches.free(patch, stroke.is_pulled, others)
        stroke.radius = radius
        stroke.left_out = np.count_nonzero(patch) - np.count_nonzero(stroke.free)

    def end(self) -> None:
        """Take the last one as it is."""
        self._done.append(self._last)
        self._last = None

    def take_back(self) -> bool:
        """Forget the one that grows, or else the last; tells whether that had been taken."""
        was_taken = self._last is None and len(self._done) > 0
        if was_taken:
            self._done.pop()
        self._last = None
        return was_taken

    def groups(self) -> list[tuple[str, str, np.ndarray]]:
        """Kinds of constraints, the names that were given, and vertices."""
        held: dict[str, np.ndarray] = {}
        for each in self._done:
            if not each.is_pulled:
                held[each.name] = held.get(each.name, False) | each.free
        found = [("PIN", name, mask) for name, mask in held.items()]
        found += [("OBJECT", each.name, each.free) for each in self._done if each.is_pulled]
        return [(kind, name, self.patches.vertices(mask)) for kind, name, mask in found]

    def picked(self, count: int) -> Picked:
        """The same to be drawn, with the last one; ``count`` is the number of all vertices."""
        every = [*self._done, *([] if self._last is None else [self._last])]
        found = []
        for is_pulled in (False, True):
            masks = [each.free for each in every if each.is_pulled == is_pulled]
            none = np.zeros(0, dtype=np.int64)
            found.append(self.patches.vertices(np.logical_or.reduce(masks)) if masks else none)
        return Picked(*found, count)
