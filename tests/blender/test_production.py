"""Each item of the tool leaves a production's scene as it was, but for what it is to change.

Face keys, drivers, poses, UV maps, weights and what is exported are compared with before, with the
bands at 0.
"""

from __future__ import annotations

import pytest
from production import assert_kept, character, head
from production_items import HEAD_ITEMS, ITEMS, OPS, masked
from saved_scene import Saved, clear


@pytest.fixture(scope="module")
def saved_character(tmp_path_factory) -> Saved:
    return Saved.of(lambda: [character()], tmp_path_factory.mktemp("character"))


@pytest.fixture(scope="module")
def saved_head(tmp_path_factory) -> Saved:
    return Saved.of(lambda: [head()], tmp_path_factory.mktemp("head"))


@pytest.fixture(autouse=True)
def _leave_nothing():
    yield
    clear()


@pytest.mark.parametrize("item", ITEMS)
def test_of_a_character_all_stays(item, saved_character):
    ITEMS[item](saved_character.opened())
    saved_character.assert_kept()


@pytest.mark.parametrize("item", HEAD_ITEMS)
def test_of_a_sculpted_head_all_stays(item, saved_head):
    HEAD_ITEMS[item](saved_head.opened())
    saved_head.assert_kept()


# Multiresolution enlarges what is rounded where the base mesh has hardly a tangent.
@pytest.mark.parametrize(("scene", "within"), [("saved_character", 2e-6), ("saved_head", 1e-4)])
def test_an_applied_look_is_what_was_seen_and_leaves_all_else(scene, within, request):
    saved = request.getfixturevalue(scene)
    masked(saved.opened())
    before = saved.now(neutral=False)
    assert OPS.apply_look() == {"FINISHED"}
    assert_kept(before, saved.now(neutral=False), moved=within)
