"""What poses are measured by: the turn, Blender's modifier, and Live in a process of its own."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from tools.bench import live, sliders
from tools.bench.laplacian_deform import LaplacianDeform
from tools.bench.meshes import bumpy_sphere, pinched_sphere
from tools.bench.turn import DEGREES, Turn

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(params=["free", "turned"])
def turn(request) -> Turn:
    return Turn("pinched sphere", *pinched_sphere(8), is_free=request.param == "free")


def angle(motion: np.ndarray) -> float:
    return float(np.degrees(np.arccos((np.trace(motion[:3, :3]) - 1) / 2)))


def moved(turn: Turn, motion: np.ndarray) -> np.ndarray:
    return np.where(
        turn.is_handle[:, None], turn.rest @ motion[:3, :3].T + motion[:3, 3], turn.rest
    )


@pytest.mark.parametrize("part", [0.25, 1])
def test_the_handle_is_turned_rigidly_about_the_middle(turn, part):
    targets = turn.targets(part)
    motion = turn.motion(targets)
    assert angle(motion) == pytest.approx(part * DEGREES)
    np.testing.assert_allclose(moved(turn, motion), targets, atol=1e-12)
    middle = turn.middle @ motion[:3, :3].T + motion[:3, 3]
    np.testing.assert_allclose(middle, turn.middle, atol=1e-12)
    np.testing.assert_array_equal(targets[~turn.is_handle], turn.rest[~turn.is_handle])


def test_a_free_handle_keeps_its_shape_and_its_middle_goes_the_way(turn):
    posed = turn.poser().solve(turn.targets()).vertices[turn.indices]
    motion = turn.motion(posed)
    np.testing.assert_allclose(moved(turn, motion), posed, atol=1e-9)
    centres = [p[turn.is_handle].mean(axis=0) for p in (posed, turn.targets())]
    np.testing.assert_allclose(*centres, atol=1e-9)
    assert (abs(angle(motion) - DEGREES) < 1e-6) != turn.is_free


@pytest.mark.parametrize("shape", [pinched_sphere(8), bumpy_sphere(8)])
@pytest.mark.parametrize("iterations", [1, 20])
def test_the_modifier_follows_the_handle(shape, iterations):
    turn = Turn("sphere", *shape, is_free=False)
    modifier = LaplacianDeform(turn, iterations)
    for _ in range(2):  # anew the second time
        assert modifier.prepare() > 0
        np.testing.assert_allclose(modifier.shape, turn.vertices, atol=1e-5)
        for part in (0.5, 1):
            modifier.step(turn.targets(part))
            off = modifier.shape[turn.indices] - turn.targets(part)
            assert np.abs(off).max() < 0.03 * turn.diagonal
        between = np.delete(modifier.shape - turn.vertices, turn.indices, axis=0)
        assert np.linalg.norm(between, axis=1).max() > 0.1 * turn.diagonal
    modifier.remove()


@pytest.mark.skipif(not any((ROOT / "dist").glob("*.zip")), reason="the extension is not built")
@pytest.mark.parametrize("algorithm", live.ALGORITHMS)
def test_live_is_measured_until_it_has_settled(algorithm):
    found = live.measured(pinched_sphere(8), algorithm)
    assert 0 < found["mean"] <= found["slowest"]
    assert found["reading"] > 0 and found["settling"] > 0
    assert 0 < found["before"] <= found["most"]
    assert 0 <= found["lag"] < 0.1


@pytest.mark.skipif(not any((ROOT / "dist").glob("*.zip")), reason="the extension is not built")
@pytest.mark.parametrize("kind", sliders.KINDS)
def test_sliders_are_measured_alone_and_with_the_extension(kind):
    found = sliders.measured(pinched_sphere(8), [sys.executable], kind)
    assert [each["acting"] for each in found] == [1, sliders.BANDS]
    assert all(each[name] > 0 for each in found for name in ("alone", "with", "faces", "vertices"))
