"""Drags in threads of their own."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest
import spectral_tv
from pulled_sphere import INDICES, TARGETS, TRIANGLES, VERTICES
from pulled_sphere import large as large_sphere

KINDS = [spectral_tv.Poser, spectral_tv.Deformer]


@pytest.mark.parametrize("kind", KINDS)
def test_a_drag_in_a_thread_is_the_same(kind):
    mesh = spectral_tv.Mesh(VERTICES, TRIANGLES)
    here, there = kind(mesh, INDICES), kind(mesh, INDICES)
    for share in (0.3, 0.6, 1.0):
        moved = VERTICES[INDICES] + share * (TARGETS - VERTICES[INDICES])
        found = there.start_drag(moved).result()
        np.testing.assert_array_equal(found.vertices, here.drag(moved).vertices)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [1, 3])
def test_drags_that_wait_for_each_other_end(kind, count):
    """They share threads, and none of these waits for a drag that needs it."""
    mesh, indices, targets = large_sphere()[:3]
    with spectral_tv.use_threads(count):
        state = kind(mesh, indices)
        jobs = [state.start_drag(targets) for _ in range(6)]
        for job in jobs:
            assert np.isfinite(job.result().vertices).all()


@pytest.mark.parametrize("kind", KINDS)
def test_a_cancelled_drag_leaves_what_goes_on(kind):
    mesh, indices, targets = large_sphere()[:3]
    state = kind(mesh, indices)
    job = state.start_drag(targets)
    job.cancel()
    with contextlib.suppress(spectral_tv.Cancelled):  # it may have ended before
        job.result()
    exact = state.solve(targets).vertices
    np.testing.assert_allclose(exact[indices], targets, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_bad_targets_are_refused_at_once(kind):
    state = kind(spectral_tv.Mesh(VERTICES, TRIANGLES), INDICES)
    with pytest.raises(spectral_tv.MeshError, match="not"):
        state.start_drag(TARGETS[1:]).result()
