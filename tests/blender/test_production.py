"""Each item of the tool leaves a production's scene as it was, but for what it is to change.

Face keys, drivers, poses, UV maps, weights and what is exported are compared with before, with the
bands at 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import bpy
import pytest
from production import Facts, assert_kept, character, head
from production_items import HEAD_ITEMS, ITEMS, OPS, masked


@dataclass(frozen=True)
class Saved:
    """A scene in a file, so that its edges are in the same order each time, and its facts."""

    path: Path
    name: str
    facts: Facts

    @classmethod
    def of(cls, scene: Callable[[], bpy.types.Object], folder: Path) -> Saved:
        clear()
        path, name = folder / f"{scene.__name__}.blend", scene().name
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        bpy.ops.wm.open_mainfile(filepath=str(path))
        saved = cls(path, name, Facts.of(bpy.data.objects[name], folder))
        clear()
        return saved

    def opened(self) -> bpy.types.Object:
        bpy.ops.wm.open_mainfile(filepath=str(self.path))
        return self.found()

    def found(self) -> bpy.types.Object:
        return bpy.data.objects[self.name]

    def now(self, **how: bool) -> Facts:
        return Facts.of(self.found(), self.path.parent, self.facts, **how)


@pytest.fixture(scope="module")
def saved_character(tmp_path_factory) -> Saved:
    return Saved.of(character, tmp_path_factory.mktemp("character"))


@pytest.fixture(scope="module")
def saved_head(tmp_path_factory) -> Saved:
    return Saved.of(head, tmp_path_factory.mktemp("head"))


def clear() -> None:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)


@pytest.fixture(autouse=True)
def _leave_nothing():
    yield
    clear()


@pytest.mark.parametrize("item", ITEMS)
def test_of_a_character_all_stays(item, saved_character):
    ITEMS[item](saved_character.opened())
    assert_kept(saved_character.facts, saved_character.now())


@pytest.mark.parametrize("item", HEAD_ITEMS)
def test_of_a_sculpted_head_all_stays(item, saved_head):
    HEAD_ITEMS[item](saved_head.opened())
    assert_kept(saved_head.facts, saved_head.now())


# Multiresolution enlarges what is rounded where the base mesh has hardly a tangent.
@pytest.mark.parametrize(("scene", "within"), [("saved_character", 2e-6), ("saved_head", 1e-4)])
def test_an_applied_look_is_what_was_seen_and_leaves_all_else(scene, within, request):
    saved = request.getfixturevalue(scene)
    masked(saved.opened())
    before = saved.now(neutral=False)
    assert OPS.apply_look() == {"FINISHED"}
    assert_kept(before, saved.now(neutral=False), moved=within)
