"""Labels that mean the same part in every pose."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import dumbbell

SEGMENTS = 3


def bent(vertices: np.ndarray, angle: float) -> np.ndarray:
    """Turn the upper ball about the x axis, the neck bending smoothly."""
    turn = angle * np.clip(vertices[:, 2] + 0.5, 0, 1)
    y, z = vertices[:, 1], vertices[:, 2]
    return np.column_stack(
        [vertices[:, 0], np.cos(turn) * y - np.sin(turn) * z, np.sin(turn) * y + np.cos(turn) * z]
    )


@pytest.fixture(scope="module")
def shape():
    return dumbbell(ball_radius=1, neck_radius=0.3, neck_length=1.5, n_around=32, n_along=72)


def split(vertices, triangles) -> spectral_tv.Decomposition:
    return spectral_tv.decompose(spectral_tv.Mesh(vertices, triangles), "m2", steps=48)


@pytest.fixture(scope="module")
def straight(shape):
    return split(*shape)


def test_poses_have_the_same_parts(shape, straight):
    vertices, triangles = shape
    labels, turned = spectral_tv.cosegment(
        [straight, split(bent(vertices, 0.7), triangles)], SEGMENTS
    )
    assert (labels == turned).mean() > 0.9
    middle = np.abs(vertices[:, 2]) < 0.3
    far = np.abs(vertices[:, 2]) > 1.7
    assert len(set(labels[middle]) & set(labels[far])) == 0


def test_size_place_and_order_of_vertices_do_not_matter(shape, straight):
    vertices, triangles = shape
    order = np.random.default_rng(0).permutation(len(vertices))
    place = np.argsort(order)
    moved = split(7 * vertices[order] + [1, 2, 3], place[triangles])
    labels, same = spectral_tv.cosegment([straight, moved], SEGMENTS)
    assert (labels[order] == same).mean() > 0.999


def test_meshes_need_no_common_triangles(shape, straight):
    other, faces = dumbbell(
        ball_radius=1, neck_radius=0.3, neck_length=1.5, n_around=40, n_along=90
    )
    labels, others = spectral_tv.cosegment([straight, split(other, faces)], SEGMENTS)
    vertices, _ = shape
    nearest = [int(np.argmin(np.linalg.norm(vertices - point, axis=1))) for point in other]
    assert (labels[nearest] == others).mean() > 0.9


def test_segments_are_numbered_by_area_and_seeds_repeat(shape, straight):
    mesh = spectral_tv.Mesh(*shape)
    (labels,) = spectral_tv.cosegment([straight], 4, seed=5)
    areas = np.bincount(labels, mesh.vertex_areas, minlength=4)
    assert np.all(np.diff(areas) <= 0) and areas.min() > 0
    np.testing.assert_array_equal(labels, spectral_tv.cosegment([straight], 4, seed=5)[0])
    assert not spectral_tv.cosegment([straight], 1)[0].any()


def test_bad_input_is_refused(straight):
    with pytest.raises(spectral_tv.MeshError, match="nothing to segment"):
        spectral_tv.cosegment([])
    for segments in (0, 10**6):
        with pytest.raises(spectral_tv.MeshError, match="segments must be between 1"):
            spectral_tv.cosegment([straight], segments)
    with pytest.raises(TypeError):
        spectral_tv.cosegment([None])


def test_a_job_gives_the_same(straight):
    job = spectral_tv.start_cosegment([straight], SEGMENTS)
    np.testing.assert_array_equal(job.result()[0], spectral_tv.cosegment([straight], SEGMENTS)[0])
    assert job.progress == 1
