"""Masked arrays, and whatever else is an array or is not: read as meant, or refused by name."""

from __future__ import annotations

import array
from fractions import Fraction

import numpy as np
import pytest
import spectral_tv
from scipy import sparse
from shapes import icosphere

VERTICES, TRIANGLES = icosphere(1)
MESH = spectral_tv.Mesh(VERTICES, TRIANGLES)
SPLIT = spectral_tv.decompose(MESH, steps=6)
FLOW = spectral_tv.flow(MESH, VERTICES[:, 2], [0, 0.1, 0.2])
ENDS = np.array([0, 7, 9])
TARGETS = VERTICES[ENDS] + [[0, 0, 0], [0.1, 0, 0], [0, 0.2, 0]]
IMAGE = VERTICES[:36, 2].reshape(6, 6)
TIMES = np.linspace(0, 0.1, 5)
WEIGHTS = np.full(3, 0.5)
DEFORMER = spectral_tv.Deformer(MESH, ENDS)
POSER = spectral_tv.Poser(MESH, ENDS)

# Every array that is read: its name, a value that is fine, and a call with another.
ARRAYS = {
    "vertices": (VERTICES, lambda a: spectral_tv.Mesh(a, TRIANGLES)),
    "triangles": (TRIANGLES, lambda a: spectral_tv.Mesh(VERTICES, a)),
    "times": (TIMES, lambda a: spectral_tv.decompose(MESH, times=a)),
    "base": (VERTICES * 0.9, lambda a: spectral_tv.decompose(MESH, "m3", steps=3, base=a)),
    "values": (VERTICES[:, 2], lambda a: spectral_tv.flow(MESH, a, TIMES)),
    "values of several channels": (VERTICES, lambda a: spectral_tv.flow(MESH, a, TIMES)),
    "image": (IMAGE, lambda a: spectral_tv.decompose_image(a, steps=3)),
    "image times": (TIMES, lambda a: spectral_tv.decompose_image(IMAGE, times=a)),
    "edges": (TIMES, SPLIT.bands),
    "edges of a flow": (TIMES, FLOW.bands),
    "gains": (np.ones(5), SPLIT.filter),
    "weights of a mean": (VERTICES[:, 2] > 0, FLOW.mean),
    "members": (VERTICES[:, 2] > 0, lambda a: spectral_tv.eigenset_test(MESH, a)),
    "members by index": (np.arange(9), lambda a: spectral_tv.eigenset_test(MESH, a)),
    "indices": (ENDS, lambda a: spectral_tv.deform(MESH, a, TARGETS)),
    "targets": (TARGETS, lambda a: spectral_tv.deform(MESH, ENDS, a)),
    "weights": (WEIGHTS, lambda a: spectral_tv.deform(MESH, ENDS, TARGETS, a)),
    "targets of a drag": (TARGETS, DEFORMER.drag),
    "targets of a sequence": (TARGETS, lambda a: DEFORMER.solve_sequence([a, TARGETS])),
    "bodies": (np.array([0, 1, 2]), lambda a: spectral_tv.Poser(MESH, ENDS, bodies=a)),
    "targets of a pose": (TARGETS, POSER.drag),
    "steps": (np.array([4, 5]), lambda a: spectral_tv.accuracy(MESH, steps=a, bands=2)),
    "displacement": (VERTICES, lambda a: spectral_tv.folds(MESH, a)),
    "displacement to clamp": (VERTICES, lambda a: spectral_tv.safe_displacement(MESH, a)),
    "displacement by which faces cross": (
        VERTICES,
        lambda a: spectral_tv.self_intersections(MESH, a),
    ),
    "values of a variation": (VERTICES, lambda a: spectral_tv.total_variation(MESH, a)),
}
# What the error calls them.
NAMES = {
    "image times": "times",
    "edges of a flow": "edges",
    "displacement to clamp": "displacement",
}


def name_of(case):
    return NAMES.get(case, case.split(" of ")[0].split(" by ")[0])


@pytest.mark.parametrize("case", ARRAYS)
def test_arrays_that_hide_values_are_refused_and_told_how_many(case):
    value, call = ARRAYS[case]
    mask = np.zeros(value.shape, bool)
    mask.flat[1] = True
    with pytest.raises(spectral_tv.MeshError) as caught:
        call(np.ma.array(value, mask=mask))
    name = name_of(case)
    expected = f"{name} must be an array of numbers, but 1 value is masked; {name}.filled("
    assert str(caught.value).startswith(expected)
    mask.flat[0] = True
    with pytest.raises(spectral_tv.MeshError, match=f"{name} .* 2 values are masked"):
        call(np.ma.array(value, mask=mask))


@pytest.mark.parametrize("case", ARRAYS)
def test_masked_arrays_that_hide_nothing_are_read(case):
    value, call = ARRAYS[case]
    for mask in (np.ma.nomask, np.zeros(value.shape, bool)):
        call(np.ma.array(value, mask=mask))


def test_masked_rows_in_a_list_are_found():
    rows = [np.ma.array(row, mask=[0, 0, place == 4]) for place, row in enumerate(VERTICES)]
    for kind in (list, tuple):
        with pytest.raises(spectral_tv.MeshError, match=r"vertices .* 1 value is masked"):
            spectral_tv.Mesh(kind(rows), TRIANGLES)
    with pytest.raises(spectral_tv.MeshError, match=r"gains .* 1 value is masked"):
        SPLIT.filter([1.0, np.ma.masked, 1.0, 1.0, 1.0])


class Wrapped:
    """As of pandas, xarray and others: no array, but one can be had."""

    def __init__(self, value):
        self.value = value

    def __array__(self, dtype=None, copy=None):
        """Give one."""
        return np.array(self.value, dtype)


class Tracked:
    """As a tensor of PyTorch that requires a gradient."""

    def __array__(self, dtype=None, copy=None):
        """Refuse to."""
        raise RuntimeError("Use tensor.detach().numpy() instead.")


class Matrix(np.ndarray):
    """An array of a class of its own."""


@pytest.mark.parametrize(
    "like",
    [
        Wrapped,
        np.ndarray.tolist,
        lambda a: [*a],
        lambda a: a.view(Matrix),
        lambda a: a.astype(np.longdouble),
        np.asfortranarray,
        lambda a: a[::-1][::-1],
        lambda a: a.astype(">f8"),
    ],
)
def test_what_is_like_an_array_is_read(like):
    mesh = spectral_tv.Mesh(like(VERTICES), TRIANGLES)
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    np.testing.assert_array_equal(SPLIT.filter(like(np.ones(5))), SPLIT.filter(np.ones(5)))
    assert SPLIT.filter(array.array("d", [1, 1, 1, 1, 1])).shape == VERTICES.shape


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (sparse.csr_matrix(VERTICES), r"csr_matrix; its toarray\(\) would do"),
        (sparse.coo_array(VERTICES), r"coo_array; its toarray\(\) would do"),
        (Tracked(), r"Tracked: .*Use tensor.detach\(\).numpy\(\) instead"),
        (VERTICES.astype(object), "not of object"),
        ([[Fraction(1, 3)] * 3] * 42, "not of object"),
        (np.zeros(42, [("x", "f8"), ("y", "f8"), ("z", "f8")]), r"not of \[\('x', '<f8'\)"),
        (VERTICES.astype("datetime64[s]"), "not of datetime64"),
        (VERTICES.astype(str), "not of <U"),
        ([[0.0, None, 1.0]] * 42, "not of object"),
        (object(), "not of the type object"),
        ({"x": 1.0}, "not of the type dict"),
        (range, "not of the type type"),
    ],
)
def test_what_is_no_array_of_numbers_is_refused_by_what_it_is(value, message):
    with pytest.raises(spectral_tv.MeshError, match=f"vertices must be an array .*{message}"):
        spectral_tv.Mesh(value, TRIANGLES)
    with pytest.raises(spectral_tv.MeshError, match=f"base must be an array .*{message}"):
        spectral_tv.decompose(MESH, "m3", base=value)
