"""What the figures of poses pull and hold, how their tables are filled, and how films are shot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.distance import pdist

from tools.bench.meshes import bumpy_sphere
from tools.gallery.limb_turns import FEET, LimbTurn, Part
from tools.gallery.page import Shape
from tools.gallery.tables import write_row

ROOT = Path(__file__).resolve().parents[2]
PART = Part("crown", lambda _x, _y, z: z > 0.9, (0.5, 0.5, 0.5), (0, -1, 0), 60)


@pytest.fixture(scope="module")
def shape() -> Shape:
    return Shape(*bumpy_sphere(12))


@pytest.mark.parametrize("is_turned", [False, True])
def test_what_is_held_stays_and_the_middle_of_the_part_goes_along_the_arc(shape, is_turned):
    turn = LimbTurn("ball", shape, PART, is_turned=is_turned)
    rest, goal = shape.vertices[turn.indices], turn.targets()
    pulled = turn.is_pulled
    height = np.ptp(shape.vertices[:, 2])
    assert (rest[~pulled, 2] < shape.vertices[:, 2].min() + FEET * height).all()
    np.testing.assert_array_equal(goal[~pulled], rest[~pulled])
    np.testing.assert_allclose(pdist(goal[pulled]), pdist(rest[pulled]))
    before, after = (points[pulled].mean(axis=0) - turn.centre for points in (rest, goal))
    angle = np.degrees(np.arctan2(before[2], before[0]) - np.arctan2(after[2], after[0]))
    assert angle % 360 == pytest.approx(300)  # counterclockwise from the front, x to z
    assert after[1] == pytest.approx(before[1])


def test_by_position_the_part_is_a_free_body_and_turned_it_is_none(shape):
    by_position, turned = (LimbTurn("ball", shape, PART, is_turned=t) for t in (False, True))
    np.testing.assert_array_equal(by_position.bodies, np.where(by_position.is_pulled, 0, -1))
    assert (turned.bodies == -1).all()
    offsets = by_position.targets() - shape.vertices[by_position.indices]
    assert np.ptp(offsets[by_position.is_pulled], axis=0) == pytest.approx(0, abs=1e-12)


def test_poses_meet_their_targets(shape):
    turn = LimbTurn("ball", shape, PART, is_turned=True)
    np.testing.assert_allclose(turn.posed(0.3).vertices[turn.indices], turn.targets(0.3), atol=1e-9)


def test_a_row_takes_the_place_of_the_one_with_its_name(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- one -->\n| a | b |\n<!-- /one -->\nafter\n", encoding="utf-8")
    for row in ("| x, 1 | 1 |", "| y | 2 |", "| x, 1 | 3 |"):
        write_row(page, "one", row)
    body = "| a | b |\n| x, 1 | 3 |\n| y | 2 |\n"
    text = page.read_text(encoding="utf-8")
    assert text == f"before\n<!-- one -->\n{body}<!-- /one -->\nafter\n"
    with pytest.raises(SystemExit, match="lacks the markers <!-- two -->"):
        write_row(page, "two", "| x |")


@pytest.mark.parametrize(("page", "tables"), [
    ("looks.md", ("m1", "m3")), ("poses.md", ("poses", "further")),
])  # fmt: skip
def test_the_pages_of_the_docs_have_a_place_for_every_table(page, tables, tmp_path):
    copy = tmp_path / page
    copy.write_bytes((ROOT / "docs" / "gallery" / page).read_bytes())
    for table in tables:
        write_row(copy, table, "| a row that is new | 1 |")
    assert copy.read_text(encoding="utf-8").count("| a row that is new | 1 |") == len(tables)


def test_a_camera_that_is_still_sees_the_shape_move(shape):
    shots = [(shape.vertices + offset, None) for offset in ([0, 0, 0], [0, 0, 1.0])]
    for is_still in (True, False):
        first, second = shape.photograph(shots, cell=48, is_still=is_still)
        tops = [picture.getchannel("A").getbbox()[1] for picture in (first, second)]
        assert (tops[0] - tops[1] > 5) == is_still
