"""A scene in a file, and the facts of its objects that tools keep."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import bpy
from production import Facts, assert_kept


def clear() -> None:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)


@dataclass(frozen=True)
class Saved:
    """A scene in a file, so that its edges are in the same order each time, and its facts.

    The first object is the active one; of it there are exports, too.
    """

    path: Path
    facts: dict[str, Facts]

    @classmethod
    def of(cls, scene: Callable[[], Iterable[bpy.types.Object]], folder: Path) -> Saved:
        clear()
        names = [obj.name for obj in scene()]
        path = folder / "scene.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        saved = cls(path, dict.fromkeys(names))
        saved.opened()
        saved.facts.update({name: saved._now(name) for name in names})
        clear()
        return saved

    def opened(self) -> bpy.types.Object:
        bpy.ops.wm.open_mainfile(filepath=str(self.path))
        return self.found()

    def found(self, name: str = "") -> bpy.types.Object:
        return bpy.data.objects[name or next(iter(self.facts))]

    def now(self, **how: bool) -> Facts:
        """Those of the first object."""
        return self._now(next(iter(self.facts)), **how)

    def assert_kept(self) -> None:
        """All of all objects is as before, with what was added at 0."""
        for name, before in self.facts.items():
            assert_kept(before, self._now(name))

    def _now(self, name: str, **how: bool) -> Facts:
        folder = self.path.parent if self.found(name) == self.found() else None
        return Facts.of(self.found(name), folder, self.facts[name], **how)
