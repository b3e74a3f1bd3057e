"""Whenever a job is cancelled: it ends, and what it worked on is as before."""

from __future__ import annotations

import time

import numpy as np
import pytest
import spectral_tv
from hypothesis import given
from hypothesis import strategies as st
from patience import result
from shapes import bumpy_sphere

MESH = spectral_tv.Mesh(*bumpy_sphere(3))
FUNCTION = MESH.vertices[:, 0]
WILD = np.random.default_rng(0).normal(size=MESH.vertices.shape)
JOBS = {
    "m1": lambda: spectral_tv.start_decompose(MESH, steps=2000),
    "m2": lambda: spectral_tv.start_decompose(MESH, "m2", steps=2000, solver="multigrid"),
    "m3": lambda: spectral_tv.start_decompose(MESH, "m3", steps=2000),
    "lb": lambda: spectral_tv.start_decompose(MESH, "lb", eigenpairs=600),
    "flow": lambda: spectral_tv.start_flow(MESH, FUNCTION, np.linspace(0, 1, 999), exact=True),
    "eigenset": lambda: spectral_tv.start_eigenset_test(MESH, FUNCTION > 0.5),
    "deform": lambda: spectral_tv.start_deform(
        MESH, [0, 1, 9], 2 * MESH.vertices[[0, 5, 9]], tolerance=1e-12
    ),
    "pose": lambda: spectral_tv.start_pose(
        MESH, [0, 1, 9], 2 * MESH.vertices[[0, 5, 9]], tolerance=1e-12
    ),
    "deformer": lambda: spectral_tv.Deformer.start(MESH, [0, 1, 9]),
    "poser": lambda: spectral_tv.Poser.start(MESH, [0, 1, 9]),
    "safe displacement": lambda: spectral_tv.start_safe_displacement(MESH, WILD),
    "self-intersections": lambda: spectral_tv.start_self_intersections(MESH, WILD),
    "accuracy": lambda: spectral_tv.start_accuracy(MESH, steps=[64, 128]),
}


@given(st.sampled_from([*JOBS]), st.floats(0, 0.05))
def test_a_job_cancelled_at_any_moment_ends(name, delay):
    before = MESH.vertices
    job = JOBS[name]()
    time.sleep(delay)
    job.cancel()
    try:
        result(job)
    except spectral_tv.Cancelled:
        with pytest.raises(spectral_tv.Cancelled):
            job.result()
    np.testing.assert_array_equal(MESH.vertices, before)
