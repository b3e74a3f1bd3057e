"""spectral_tv.transfer: the bands of one surface on another one in about the same place."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from nearby import body, distances
from scipy.spatial.transform import Rotation
from shapes import icosphere


def angles(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    lengths = np.linalg.norm(one, axis=1) * np.linalg.norm(other, axis=1)
    return np.arccos(((one * other).sum(axis=1) / lengths).clip(-1, 1))


@pytest.fixture(scope="module")
def scan():
    """A scan, its bands, and what of them is found on its retopology."""
    vertices, triangles = body(220, 110)
    target = body(50, 26, twist=0.1)
    mesh = spectral_tv.Mesh(vertices, triangles)
    split = spectral_tv.decompose(mesh, steps=16)
    taken = spectral_tv.transfer(mesh, spectral_tv.Mesh(*target))
    return vertices, triangles, split.bands(split.band_edges(5)), target[0], taken


@pytest.mark.parametrize("gains", [[1, 1, 1, 1, 1], [-1, -1, -1, -1, -1], [0, 0, 0, 0, 1]])
def test_the_look_of_a_scan_goes_onto_its_retopology(scan, gains):
    vertices, triangles, bands, points, taken = scan
    assert not taken.missed.any()
    moved = np.tensordot(gains, bands, 1)
    look = points + np.tensordot(gains, taken.vectors(bands), 1)
    away = distances(look, vertices + moved, triangles).mean()
    assert away < 0.02 * np.sqrt((moved**2).sum(axis=1).mean())


def test_it_does_so_where_the_retopology_has_none_of_the_bumps():
    (vertices, triangles), smooth = body(160, 80), body(160, 80, bumps=0.0)
    target = body(50, 26, twist=0.1, bumps=0.0)
    taken = spectral_tv.transfer(spectral_tv.Mesh(vertices, triangles), spectral_tv.Mesh(*target))
    bumps = vertices - smooth[0]
    look = target[0] + taken.vectors(bumps)
    error = distances(look, vertices, triangles).mean()
    assert error < 0.06 * np.sqrt((bumps**2).sum(axis=1).mean())


def test_displacements_are_turned_as_the_target_is():
    """A tube that is straight for the one and bent for the other, with bumps outwards."""
    u, v = np.meshgrid(np.linspace(-2, 2, 81), 2 * np.pi * np.arange(24) / 24, indexing="ij")
    straight = np.stack([u, np.cos(v), np.sin(v)], axis=-1).reshape(-1, 3)
    rows, columns = np.arange(80)[:, np.newaxis] * 24, np.arange(24)
    after = (columns + 1) % 24
    quads = np.stack(
        [rows + columns, rows + after, rows + 24 + after, rows + 24 + columns], axis=-1
    )
    triangles = np.concatenate([quads[..., :3], quads[..., [0, 2, 3]]]).reshape(-1, 3)[:, ::-1]
    angle = 0.12 * u
    bend = Rotation.from_rotvec(angle.reshape(-1, 1) * [0, 0, 1])
    middle = np.stack([np.sin(angle), 1 - np.cos(angle), 0 * u], -1).reshape(-1, 3) / 0.12
    bent = middle + bend.apply(straight * [0, 1, 1])
    source, target = (spectral_tv.Mesh(points, triangles) for points in (straight, bent))
    outwards = straight * [0, 1, 1]
    taken = spectral_tv.transfer(source, target, farthest=0.6)
    assert not taken.missed.any()
    wanted, found = bend.apply(outwards), taken.vectors(outwards)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, atol=0.02)
    inside = np.abs(u.ravel()) < 1.6
    assert np.degrees(angles(found, wanted)[inside]).max() < 2.5
    assert np.degrees(angles(outwards, wanted)[inside]).max() > 10


def test_what_is_missed_fades_along_the_surface():
    (vertices, triangles) = body(60, 40)
    half = triangles[(vertices[triangles][:, :, 0] < 0.2).all(axis=1)]
    target = body(60, 30, twist=0.1)
    taken = spectral_tv.transfer(spectral_tv.Mesh(vertices, half), spectral_tv.Mesh(*target))
    far = target[0][:, 0] > 0.2 + 0.2
    assert taken.missed[far].all() and not taken.missed[target[0][:, 0] < 0.1].any()
    found = taken.values(np.ones(len(vertices)))
    np.testing.assert_allclose(found[~taken.missed], 1)
    assert (found >= 0).all() and (found[taken.missed] < 1).all()
    assert found[target[0][:, 0] > 1.2].max() < 0.1
    edges = np.concatenate([target[1][:, [0, 1]], target[1][:, [1, 2]]])
    assert np.abs(found[edges[:, 0]] - found[edges[:, 1]]).max() < 0.5


def test_the_other_side_of_a_sheet_is_passed_over():
    """Two shells about the same place: each vertex takes from the one that faces as it does."""
    outer, triangles = icosphere(4)
    vertices = np.concatenate([outer, 0.97 * outer])
    faces = np.concatenate([triangles, triangles[:, ::-1] + len(outer)])
    points, corners = icosphere(3, 0.98)
    source = spectral_tv.Mesh(vertices, faces)
    is_outer = np.repeat([1.0, 0.0], len(outer))
    for flip, wanted in ((corners, 1), (corners[:, ::-1], 0)):
        taken = spectral_tv.transfer(source, spectral_tv.Mesh(points, flip))
        np.testing.assert_allclose(taken.values(is_outer), wanted)
    alone = spectral_tv.Mesh(outer, triangles)
    assert spectral_tv.transfer(alone, spectral_tv.Mesh(points, corners[:, ::-1])).missed.all()


@pytest.mark.parametrize(("fit", "scale"), [("rigid", 1.0), ("similar", 1.7)])
def test_a_fit_takes_the_source_to_where_the_target_is(fit, scale):
    vertices, triangles = body(80, 40)
    turn = Rotation.from_euler("xyz", [0.4, -0.7, 2.0])
    points, corners = body(60, 30, twist=0.1)
    target = spectral_tv.Mesh(scale * turn.apply(points) + [3, -1, 2], corners)
    source = spectral_tv.Mesh(vertices, triangles)
    taken = spectral_tv.transfer(source, target, fit=fit)
    assert not taken.missed.any()
    assert taken.scale == pytest.approx(scale, rel=0.005)
    np.testing.assert_allclose(taken.fit[:3, :3], scale * turn.as_matrix(), atol=0.01 * scale)
    assert taken.deviation < 0.003 * scale
    field = np.tile([1.0, 2.0, 3.0], (len(vertices), 1))
    wanted = scale * turn.apply(field[0])
    np.testing.assert_allclose(
        taken.vectors(field), np.tile(wanted, (len(points), 1)), atol=0.2 * scale
    )


def test_what_makes_no_sense_is_refused():
    mesh = spectral_tv.Mesh(*icosphere(2))
    for options, message in (
        ({"farthest": -1.0}, "farthest must be a length"),
        ({"farthest": np.nan}, "farthest must be a length"),
        ({"fit": "best"}, 'fit must be "none"'),
    ):
        with pytest.raises(spectral_tv.MeshError, match=message):
            spectral_tv.transfer(mesh, mesh, **options)
    taken = spectral_tv.transfer(mesh, mesh)
    with pytest.raises(spectral_tv.MeshError, match="values must have 162 rows"):
        taken.values(np.zeros(5))
    with pytest.raises(spectral_tv.MeshError, match=r"vectors must have the shape \(162, 3\)"):
        taken.vectors(np.zeros((5, 3)))
