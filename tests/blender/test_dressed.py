"""Maps, bound clothes, refitted armatures and bands of both kinds leave a production as it was.

What was not to change is compared with before, on all objects and frames, with the bands at 0.
"""

from __future__ import annotations

import pytest
from dressed_body import dressed
from dressed_items import DRESSED_ITEMS, applied
from production_items import as_attributes
from saved_scene import Saved, clear


@pytest.fixture(scope="module")
def saved(tmp_path_factory) -> Saved:
    return Saved.of(dressed, tmp_path_factory.mktemp("dressed"))


@pytest.fixture(autouse=True)
def _leave_nothing():
    yield
    clear()


@pytest.mark.parametrize("kind", ["KEYS", "ATTRIBUTES"])
def test_clothes_stay_as_an_applied_look_has_them(kind, saved):
    (applied if kind == "KEYS" else as_attributes(applied))(saved.opened())


@pytest.mark.parametrize("item", DRESSED_ITEMS)
def test_of_a_dressed_body_all_stays(item, saved):
    DRESSED_ITEMS[item](saved.opened())
    saved.assert_kept()
