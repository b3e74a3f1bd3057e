"""Bad input is refused with a message that says what is wrong and where."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import icosphere

VERTICES, TRIANGLES = icosphere(2)


@pytest.fixture(scope="module")
def mesh():
    return spectral_tv.Mesh(VERTICES, TRIANGLES)


def changed(array, index, value):
    array = array.copy()
    array[index] = value
    return array


@pytest.mark.parametrize(
    ("vertices", "triangles", "message"),
    [
        (changed(VERTICES, (17, 1), np.nan), TRIANGLES, "vertex 17 has a coordinate"),
        (changed(VERTICES, (3, 0), np.inf), TRIANGLES, "vertex 3 has a coordinate"),
        (changed(VERTICES, (8, 2), 1e101), TRIANGLES, "vertex 8 .* beyond 1e100"),
        (VERTICES, changed(TRIANGLES, (5, 2), 162), "triangle 5 refers to vertex 162"),
        (VERTICES, changed(TRIANGLES, (9, 0), -1), "triangle 9 refers to vertex -1"),
        (VERTICES, TRIANGLES[:0], "no triangles"),
        (VERTICES[:0], TRIANGLES, "no vertices"),
        (np.zeros((162, 3)), TRIANGLES, "span no area"),
        (VERTICES[:, :2], TRIANGLES, r"vertices must have the shape \(rows, 3\), not \[162, 2\]"),
        (VERTICES.ravel(), TRIANGLES, r"vertices must have the shape \(rows, 3\)"),
        (VERTICES, TRIANGLES.ravel(), r"triangles must have the shape \(rows, 3\)"),
        (VERTICES, TRIANGLES.astype(float), "triangles must be an array of integers, not of float"),
        (VERTICES > 0, TRIANGLES, "vertices must be an array of numbers, not of bool"),
        (VERTICES * 1j, TRIANGLES, "vertices must be an array of numbers, not of complex"),
        ("mesh", TRIANGLES, "vertices must be an array of numbers"),
        ([[0, 0], [1]], TRIANGLES, "vertices must be an array of numbers"),
        (None, TRIANGLES, "vertices must be an array of numbers"),
    ],
)
def test_mesh_refuses(vertices, triangles, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.Mesh(vertices, triangles)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"method": "m4"}, 'method must be .* not "m4"'),
        ({"steps": 0}, "steps must be at least 1"),
        ({"accuracy": 0.0}, "accuracy must be above 0"),
        ({"accuracy": np.nan}, "accuracy must be above 0"),
        ({"accuracy": 1e-12}, "accuracy .* takes more than 2000 steps"),
        ({"accuracy": 0.1, "times": [0.0]}, "at least two values"),
        ({"accuracy": 0.1, "times": [0.0, 0.2, 0.2]}, r"times\[2\] is 0.2 after 0.2"),
        ({"accuracy": 0.1, "method": "lb"}, "accuracy is an option of the methods"),
        ({"scheme": "magic"}, "scheme must be"),
        ({"solver": "magic"}, "solver must be"),
        ({"times": [0.0]}, "at least two values"),
        ({"times": [0.1, 0.2]}, r"times\[0\] must be 0"),
        ({"times": [0.0, 0.2, 0.2]}, r"times\[2\] is 0.2 after 0.2"),
        ({"times": [0.0, np.nan]}, r"times\[1\] is NaN"),
        ({"times": [[0.0, 1.0]]}, "times must be a list"),
        ({"method": "m2", "p": 4}, "p must be 1, 2 or 3, not 4"),
        ({"method": "m2", "scheme": "exact"}, "exact steps exist for"),
        ({"method": "m1", "scheme": "exact", "tolerance": 0.0}, "tolerance must be between"),
        ({"method": "m1", "base": VERTICES}, "base is an option of the methods"),
        ({"method": "m2", "base_time": 0.1}, "base_time is an option of the methods"),
        ({"method": "lb", "eigenpairs": 0}, "eigenpairs must be at least 1"),
        ({"method": "lb", "base": VERTICES}, "base is an option of the methods"),
        ({"method": "lb", "times": [0.0, 0.2, 0.2]}, r"times\[2\] is 0.2 after 0.2"),
        ({"method": "lb", "scheme": "exact"}, "exact steps exist for"),
        ({"method": "displacement", "scheme": "exact"}, "exact steps exist for"),
        ({"method": "displacement", "times": [0.0, 1.0]}, "times is an option of the methods"),
        ({"method": "displacement", "base": VERTICES[1:]}, "one position per vertex"),
        ({"method": "m3", "base": VERTICES, "base_time": 0.1}, "does not go with base"),
        ({"method": "m3", "base_time": 0.0}, "time must be positive"),
        ({"method": "m3", "base": VERTICES[1:]}, r"one position per vertex \(162\), but has 161"),
        ({"method": "m3", "base": changed(VERTICES, (8, 2), np.nan)}, "base vertex 8"),
    ],
)
def test_decompose_refuses(mesh, arguments, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.decompose(mesh, **arguments)


@pytest.mark.parametrize(
    ("values", "arguments", "message"),
    [
        (VERTICES[1:], {}, r"one row per vertex \(162\)"),
        (changed(VERTICES, (40, 1), np.nan), {}, "value of vertex 40, channel 1, is not finite"),
        (VERTICES[None], {}, r"values must have the shape \(V,\) or \(V, C\)"),
        (VERTICES, {"operator": "wave"}, 'operator must be "tv" or "heat", not "wave"'),
        (VERTICES, {"operator": "heat", "exact": True}, "exact steps exist for"),
        (VERTICES[:, :0], {}, "at least one channel"),
    ],
)
def test_flow_refuses(mesh, values, arguments, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.flow(mesh, values, [0.0, 0.1], **arguments)


def test_filters_and_bands_refuse(mesh):
    split = spectral_tv.decompose(mesh, steps=6)
    for gains, message in (
        (np.ones(6), r"one value per component \(5\), but has 6"),
        (changed(np.ones(5), 3, np.nan), r"gains\[3\] is not finite"),
    ):
        with pytest.raises(spectral_tv.MeshError, match=message):
            split.filter(gains)
    for edges, message in (
        ([0.0], "at least two values"),
        ([0.0, 2.0, 1.0], r"edges\[2\] is 1 after 2"),
        ([0.0, np.nan], "edges must increase"),
    ):
        with pytest.raises(spectral_tv.MeshError, match=message):
            split.bands(edges)
    for count in (0, 6):
        with pytest.raises(spectral_tv.MeshError, match="number of bands"):
            split.band_edges(count)


@pytest.mark.parametrize(("time", "steps"), [(0.0, 5), (-1.0, 5), (np.nan, 5), (1.0, 0)])
def test_conformal_flow_refuses(mesh, time, steps):
    with pytest.raises(spectral_tv.MeshError):
        spectral_tv.conformal_flow(mesh, time, steps)


@pytest.mark.parametrize(
    "convert",
    [
        lambda a: a.tolist(),
        lambda a: a.astype(np.float32 if a.dtype.kind == "f" else np.uint16),
        np.asfortranarray,
        lambda a: np.repeat(a, 2, axis=0)[::2],
        lambda a: a.astype(a.dtype.newbyteorder()),
    ],
    ids=["lists", "narrow", "fortran", "strided", "byte-swapped"],
)
def test_any_array_of_numbers_will_do(mesh, convert):
    other = spectral_tv.Mesh(convert(VERTICES), convert(TRIANGLES))
    np.testing.assert_allclose(other.vertices, VERTICES, atol=1e-7)
    np.testing.assert_array_equal(other.triangles, TRIANGLES)
    assert other.area == pytest.approx(mesh.area, rel=1e-6)


def test_inputs_are_read_and_not_kept():
    vertices = VERTICES.copy()
    vertices.setflags(write=False)
    mesh = spectral_tv.Mesh(vertices, TRIANGLES)
    mesh.vertices[:] = 0
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    with pytest.raises(AttributeError):
        mesh.area = 1.0
