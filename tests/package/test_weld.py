"""What `Mesh` does with `weld` and `broken`, and what it tells of it."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import spectral_tv
from shapes import bumpy_sphere, grid, icosphere
from torn import beside, canonical, cube_of_sides, half_grids, noisy_soup, open_edges, soup

VERTICES, TRIANGLES = icosphere(2)


@pytest.fixture(autouse=True)
def _without_warnings():
    """None but where a test asks for one."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def test_without_weld_all_stays():
    mesh = spectral_tv.Mesh(VERTICES, TRIANGLES)
    np.testing.assert_array_equal(mesh.weld_map, np.arange(162))
    assert mesh.weld_map.dtype == np.int64
    assert not mesh.findings
    assert str(mesh.findings) == "nothing joined, closed or dropped"
    assert mesh.findings.as_dict() == {
        "border_corners": 0,
        "joined_corners": 0,
        "closed_junctions": 0,
        "dropped_vertices": 0,
        "dropped_triangles": 0,
        "open_edges_before": 0,
        "open_edges": 0,
        "components": 1,
    }


def test_open_edges_and_components_are_counted():
    mesh = spectral_tv.Mesh(*beside(grid(4, 5), (VERTICES + 9, TRIANGLES)))
    found = mesh.findings
    assert (found.open_edges_before, found.open_edges, found.border_corners) == (14, 14, 14)
    assert found.components == 2
    loose = spectral_tv.Mesh(np.vstack([VERTICES, [[9, 9, 9]]]), [*TRIANGLES, [162, 162, 0]])
    assert (loose.findings.open_edges, loose.findings.components) == (0, 1)


def test_a_place_is_that_of_the_first_vertex_there():
    vertices, triangles = soup((VERTICES, TRIANGLES))
    mesh = spectral_tv.Mesh(vertices, triangles, weld=0.0)
    _, first = np.unique(TRIANGLES.ravel(), return_index=True)
    np.testing.assert_array_equal(mesh.vertices, vertices[np.sort(first)])
    np.testing.assert_array_equal(mesh.vertices[mesh.weld_map], vertices)
    np.testing.assert_array_equal(mesh.triangles, mesh.weld_map[triangles])
    np.testing.assert_array_equal(canonical(mesh.weld_map), canonical(TRIANGLES.ravel()))
    assert mesh.findings
    assert str(mesh.findings) == "joined 960 of 960 corners at open edges"
    assert (mesh.findings.open_edges_before, mesh.findings.open_edges) == (960, 0)


def test_a_place_is_the_mean_of_those_near_one_another():
    vertices, triangles = noisy_soup((VERTICES, TRIANGLES), 1e-6)
    mesh = spectral_tv.Mesh(vertices, triangles, weld=1e-5)
    np.testing.assert_array_equal(canonical(mesh.weld_map), canonical(TRIANGLES.ravel()))
    count = np.bincount(mesh.weld_map)
    means = [np.bincount(mesh.weld_map, axis) / count for axis in vertices.T]
    np.testing.assert_allclose(mesh.vertices, np.transpose(means), atol=1e-15)


def test_zero_and_minus_zero_are_one_place():
    (one, faces), (other, more) = grid(2, 3), grid(2, 3)
    one[:, 0] *= -1.0
    assert np.signbit(one[0, 0])
    assert spectral_tv.Mesh(*beside((one, faces), (other, more)), weld=0).findings.components == 1


def test_triangles_that_are_split_come_first_and_their_parts_last():
    vertices, triangles = half_grids(3, 5, 0.0)
    mesh = spectral_tv.Mesh(vertices, triangles, weld=1e-6)
    assert str(mesh.findings) == "joined 6 of 44 corners at open edges; closed 2 T-junctions"
    assert len(mesh.triangles) == len(triangles) + 2
    same = mesh.triangles[: len(triangles)] == mesh.weld_map[triangles]
    assert same.sum(axis=1).tolist().count(3) == len(triangles) - 2
    assert (same.sum(axis=1) >= 2).all()
    with pytest.warns(spectral_tv.MeshWarning, match="14 % of 44 open edges nearly touch"):
        touching = spectral_tv.Mesh(vertices, triangles, weld=0)
    assert touching.findings.closed_junctions == 0
    assert mesh.area == pytest.approx(touching.area)


def test_a_corner_between_two_edges_of_a_triangle_splits_one():
    """A needle lies in the tip of a wide triangle, near both of its sides."""
    wide = [[0, 0, 0], [1, 1e-7, 0], [1, -1e-7, 0]]
    narrow = [[0.5, 0, 0], [0.7, 0, 0], [0.6, 0, 0.5]]
    mesh = spectral_tv.Mesh([*wide, *narrow], [[0, 1, 2], [3, 4, 5]], weld=1e-6)
    assert all(len(set(triangle)) == 3 for triangle in mesh.triangles.tolist())


@pytest.mark.parametrize("weld", [1e-4, 1e-2, 1.0, 1e6, 1e300])
def test_a_tolerance_beyond_the_edges_destroys_nothing(weld):
    for vertices, triangles in (grid(9, 9), (VERTICES, TRIANGLES), grid(2, 40, 1e-3, 1.0)):
        mesh = spectral_tv.Mesh(vertices, triangles, weld=weld)
        np.testing.assert_array_equal(mesh.vertices, vertices)
        np.testing.assert_array_equal(mesh.triangles, triangles)


@pytest.mark.parametrize("weld", [1e-2, 1.0, 1e6])
def test_a_soup_is_joined_whatever_the_tolerance_beyond_its_noise(weld):
    mesh = spectral_tv.Mesh(*noisy_soup((VERTICES, TRIANGLES), 1e-3), weld=weld)
    assert len(mesh.vertices) == len(VERTICES)
    assert mesh.findings.open_edges == 0


def test_triangles_without_area_do_not_keep_a_soup_apart():
    triangles = np.vstack([TRIANGLES, [[3, 3, 4], [5, 5, 5]]])
    mesh = spectral_tv.Mesh(*soup((VERTICES, triangles)), weld=0)
    assert (len(mesh.vertices), mesh.findings.open_edges) == (162, 0)
    np.testing.assert_array_equal(canonical(mesh.weld_map), canonical(triangles.ravel()))


def test_inner_vertices_at_one_place_stay_apart():
    """They may be the layers of a cloth, or surfaces that touch."""
    vertices, triangles = beside((VERTICES, TRIANGLES), (VERTICES, TRIANGLES))
    assert not spectral_tv.Mesh(vertices, triangles, weld=0.1).findings


@pytest.mark.parametrize(
    ("weld", "error", "message"),
    [
        (-1.0, spectral_tv.MeshError, "weld must be a length of 0 or more, not -1"),
        (np.nan, spectral_tv.MeshError, "weld must be a length of 0 or more, not NaN"),
        (np.inf, spectral_tv.MeshError, "weld must be a length of 0 or more, not inf"),
        (True, TypeError, "weld must be a length, not True: 0.0 joins"),
        (False, TypeError, "weld must be a length, not False"),
        ("1", TypeError, "weld must be a number"),
        (10**400, spectral_tv.MeshError, "weld must be a number, at most 1e308"),
    ],
)
def test_what_is_no_length_is_refused(weld, error, message):
    with pytest.raises(error, match=message):
        spectral_tv.Mesh(VERTICES, TRIANGLES, weld=weld)


def broken(*indices):
    vertices = VERTICES.copy()
    vertices[list(indices), 1] = np.nan
    return vertices


def test_broken_vertices_are_dropped_with_their_triangles():
    with pytest.warns(spectral_tv.MeshWarning) as caught:
        mesh = spectral_tv.Mesh(broken(5, 40), TRIANGLES, broken="drop")
    lost = np.isin(TRIANGLES, [5, 40]).any(axis=1)
    text = f"dropped 2 vertices that are not finite, and {lost.sum()} triangles there"
    assert [str(warning.message) for warning in caught] == [text]
    assert caught[0].filename == __file__
    assert str(mesh.findings) == text
    assert (mesh.findings.dropped_vertices, mesh.findings.dropped_triangles) == (2, lost.sum())
    left = np.setdiff1d(np.arange(162), [5, 40])
    np.testing.assert_array_equal(mesh.weld_map[left], np.arange(160))
    assert mesh.weld_map[[5, 40]].tolist() == [-1, -1]
    np.testing.assert_array_equal(mesh.vertices, VERTICES[left])
    np.testing.assert_array_equal(mesh.triangles, mesh.weld_map[TRIANGLES[~lost]])


def test_broken_vertices_in_no_triangle_are_dropped_too():
    vertices = np.vstack([VERTICES, [[np.inf, 0, 0], [1e101, 0, 0], [3, 3, 3]]])
    with pytest.warns(spectral_tv.MeshWarning, match="2 vertices .* and 0 triangles"):
        mesh = spectral_tv.Mesh(vertices, TRIANGLES, broken="drop")
    assert mesh.weld_map[-3:].tolist() == [-1, -1, 162]
    np.testing.assert_array_equal(mesh.vertices[162], [3, 3, 3])


def test_soups_lose_their_broken_triangles_alone():
    vertices, triangles = soup((VERTICES, TRIANGLES))
    vertices[[0, 30], 2] = np.nan
    with pytest.warns(spectral_tv.MeshWarning, match="dropped 2 vertices"):
        mesh = spectral_tv.Mesh(vertices, triangles, weld=0, broken="drop")
    assert len(mesh.triangles) == len(triangles) - 2
    # The other corners of the two are in no triangle any more.
    assert len(mesh.vertices) == 162 + 4
    assert mesh.weld_map[[0, 30]].tolist() == [-1, -1]
    left = np.isfinite(vertices).all(axis=1)
    np.testing.assert_array_equal(mesh.vertices[mesh.weld_map[left]], vertices[left])
    assert mesh.findings.open_edges == 6
    assert str(mesh.findings).startswith("joined ")
    assert str(mesh.findings).endswith(
        "; dropped 2 vertices that are not finite, and 2 triangles there"
    )


def test_what_is_not_broken_is_kept_without_a_word():
    mesh = spectral_tv.Mesh(VERTICES, TRIANGLES, broken="drop")
    assert not mesh.findings
    np.testing.assert_array_equal(mesh.weld_map, np.arange(162))


def test_broken_meshes_are_refused():
    with pytest.raises(spectral_tv.MeshError, match="vertex 5 has a coordinate"):
        spectral_tv.Mesh(broken(5), TRIANGLES, weld=0)
    with pytest.raises(spectral_tv.MeshError, match="vertex 162 has a coordinate"):
        spectral_tv.Mesh(np.vstack([VERTICES, [[np.nan] * 3]]), TRIANGLES)
    with pytest.raises(spectral_tv.MeshError, match=r"all 320 triangles .* not finite"):
        spectral_tv.Mesh(broken(*range(162)), TRIANGLES, broken="drop")
    with pytest.raises(spectral_tv.MeshError, match="triangle 0 refers to vertex"):
        spectral_tv.Mesh(broken(5), TRIANGLES + 162, broken="drop")
    with pytest.raises(spectral_tv.MeshError, match='"refuse" or "drop", not "mend"'):
        spectral_tv.Mesh(VERTICES, TRIANGLES, broken="mend")


@pytest.mark.parametrize("weld", [None, 0])
@pytest.mark.parametrize(
    "mesh",
    [
        (VERTICES, TRIANGLES),
        grid(12, 12),
        grid(2, 12),
        bumpy_sphere(3),
        beside((VERTICES, TRIANGLES), (VERTICES, TRIANGLES)),
        beside(grid(5, 5), (grid(5, 5)[0] + [0.0, 0.0, 0.01], grid(5, 5)[1])),
        beside(grid(5, 5), (grid(5, 5)[0] + 1.0 - 1e-9, grid(5, 5)[1])),
    ],
    ids=["closed", "open", "strip", "bumpy", "two at one place", "two layers", "corners touch"],
)
def test_ordinary_meshes_are_taken_without_a_warning(mesh, weld):
    spectral_tv.Mesh(*mesh, weld=weld)


@pytest.mark.parametrize(
    ("mesh", "weld", "message"),
    [
        (
            soup(bumpy_sphere(4)),
            None,
            "15 360 of 15 360 edges are open and 15 360 corners coincide with others: the "
            "triangles are not joined, so they will drift apart; pass weld=0",
        ),
        (
            cube_of_sides(),
            None,
            "24 of 30 edges are open and 24 corners coincide with others: the triangles are not "
            "joined, so they will drift apart; pass weld=0",
        ),
        (
            half_grids(9, 9, 0.0),
            None,
            "25 % of 64 open edges lie on one another: the surface is torn there and will come "
            "apart; pass weld=0",
        ),
        (
            half_grids(9, 9, 1.5e-6),
            0,
            "25 % of 64 open edges nearly touch one another: the surface is torn there and will "
            "come apart; pass weld=2e-6",
        ),
        (
            half_grids(9, 33, 1.5e-6),
            None,
            "36 % of 112 open edges nearly touch one another: the surface is torn there and will "
            "come apart; pass weld=2e-6",
        ),
        (
            noisy_soup(icosphere(2), 1e-6),
            0,
            "960 of 960 edges are open and 100 % of these nearly touch others: the triangles are "
            "not joined, so they will drift apart; pass weld=3e-6",
        ),
        (
            noisy_soup(icosphere(2), 1e-3),
            None,
            "960 of 960 edges are open and 100 % of these nearly touch others: the triangles are "
            "not joined, so they will drift apart; pass weld=3e-3",
        ),
        (
            (VERTICES, np.vstack([TRIANGLES, TRIANGLES[:32, [1, 2, 0]]])),
            0.1,
            "9.1 % of the triangles have the same corners as others: their area counts twice",
        ),
        (
            (np.vstack([VERTICES, np.zeros((1200, 3))]), TRIANGLES),
            None,
            "1 200 of 1 362 vertices are in no triangle: they will stay where they are",
        ),
    ],
    ids=[
        "soup", "cube of sides", "halves", "near halves", "coarse and fine", "rounded soup",
        "noisy soup", "repeated", "unused",
    ],
)  # fmt: skip
def test_probable_mistakes_are_told(mesh, weld, message):
    with pytest.warns(spectral_tv.MeshWarning) as caught:
        spectral_tv.Mesh(*mesh, weld=weld)
    assert [str(warning.message) for warning in caught] == [message]
    assert caught[0].filename == __file__
    if "pass weld=" in message:
        advice = float(message.split("pass weld=")[1])
        joined = spectral_tv.Mesh(*mesh, weld=advice)
        share = len(open_edges(joined.triangles)) / joined.findings.open_edges_before
        assert share <= 0.75


def test_a_seam_of_two_borders_with_other_vertices_is_told():
    """Every second corner of a curved border is at the same place as one of the other."""

    def curved(count: int, shift: float):
        x, y = (axis.ravel() for axis in np.meshgrid([0, 1], np.linspace(0, 1, count)))
        corner = np.arange(2 * count - 2).reshape(-1, 2)[:, 0]
        halves = [[corner, corner + 1, corner + 3], [corner, corner + 3, corner + 2]]
        heights = 0.1 * np.cos(4 * y)
        return np.column_stack([x + shift, y, heights]), np.hstack(halves).T

    (one, first), (other, second) = curved(21, 0), curved(11, 1)
    torn = np.vstack([one, other]), np.vstack([first, second + len(one)])
    with pytest.warns(spectral_tv.MeshWarning, match="pass weld=2e-3"):
        spectral_tv.Mesh(*torn)
    joined = spectral_tv.Mesh(*torn, weld=2e-3)
    assert joined.findings.closed_junctions == 10


def test_one_triangle_that_is_there_twice_is_told():
    with pytest.warns(spectral_tv.MeshWarning, match="0.3 % of the triangles have the same"):
        spectral_tv.Mesh(VERTICES, np.vstack([TRIANGLES, TRIANGLES[:1]]))


def test_scattered_triangles_are_told_though_nothing_would_join_them():
    rng = np.random.default_rng(0)
    corners = rng.normal(size=(60, 3))
    with pytest.warns(spectral_tv.MeshWarning, match="60 of 60 edges are open: hardly any"):
        spectral_tv.Mesh(corners, np.arange(60).reshape(-1, 3))
    spectral_tv.Mesh(corners[:9], np.arange(9).reshape(-1, 3))


def test_findings_show_themselves():
    found = spectral_tv.Mesh(*grid(3, 3)).findings
    assert found == spectral_tv.Mesh(*grid(3, 3)).findings
    assert found != spectral_tv.Mesh(*grid(3, 4)).findings
    assert repr(found).startswith("Findings(border_corners=8, joined_corners=0, ")
