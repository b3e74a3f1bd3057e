"""Frames of moving shapes: one filter for all, and what it makes of them does not flicker."""

from __future__ import annotations

import pickle
from itertools import pairwise

import numpy as np
import pytest
import pyvista
import spectral_tv
from moving_shapes import frames, remeshed_frames
from shapes import Mesh, dumbbell, icosphere

BANDS = 5
# Gains of bands, less 1.
FILTERS = {
    "low-pass": [-1, -1, -1, 0, 0],
    "high-pass": [0, 0, 0, -1, -1],
    "without bands": [-1] * 5,
    "fine detail doubled": [1, 1, 0, 0, 0],
    "exaggerated": [0, 0, 0.8, 0.8, 0.8],
}
# Where motion is slow, what differs by chance is large beside it.
SLOW, FAST = 1e-4, 0.03
METHODS = {
    "m1": {"soft_edges": 0.3, "keeps_limbs": True},
    "m2": {},
    "m3": {"base": "limbs", "displacement": "vector"},
}


def bands_of(shapes: list[Mesh], method: str) -> list[np.ndarray]:
    meshes = [spectral_tv.Mesh(*shape) for shape in shapes]
    options = METHODS[method]
    keep = (1.0,) if options.get("keeps_limbs") else ()
    splits = spectral_tv.decompose_sequence(meshes, method, **options)
    return [split.bands(split.band_edges(BANDS), *keep) for split in splits]


def filtered(shapes: list[Mesh], bands: list[np.ndarray], values: list[float]) -> list[Mesh]:
    pairs = zip(shapes, bands, strict=True)
    return [(places + np.tensordot(values, band, 1), faces) for (places, faces), band in pairs]


def size(shape: Mesh) -> float:
    areas = spectral_tv.Mesh(*shape).vertex_areas
    middle = np.average(shape[0], axis=0, weights=areas)
    return root_mean_square(shape, shape[0] - middle)


def root_mean_square(shape: Mesh, vectors: np.ndarray) -> float:
    areas = spectral_tv.Mesh(*shape).vertex_areas
    return float(np.sqrt(np.average(np.sum(vectors**2, axis=1), weights=areas)))


def difference(one: Mesh, other: Mesh) -> float:
    """How far two frames with the same vertices are apart, relative to their size."""
    return root_mean_square(one, other[0] - one[0]) / size(one)


def distance(one: Mesh, other: Mesh) -> float:
    """How far a frame's vertices are from the surface of another one, relative to its size."""
    surface = pyvista.PolyData.from_regular_faces(*one)
    _, nearest = surface.find_closest_cell(other[0], return_closest_point=True)
    return root_mean_square(other, nearest - other[0]) / size(one)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("bends", [False, True])
@pytest.mark.parametrize("step", [SLOW, FAST])
def test_frames_with_the_same_vertices_do_not_flicker(method, bends, step):
    shapes = frames(4, step, bends=bends)
    bands = bands_of(shapes, method)
    for name, values in FILTERS.items():
        pairs = zip(pairwise(shapes), pairwise(filtered(shapes, bands, values)), strict=True)
        for before, after in pairs:
            assert difference(*after) < 2 * difference(*before), name


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [SLOW, FAST])
def test_frames_with_other_vertices_do_not_flicker(method, step):
    shapes = remeshed_frames(4, step)
    bands = bands_of(shapes, method)
    for name, values in FILTERS.items():
        pairs = zip(pairwise(shapes), pairwise(filtered(shapes, bands, values)), strict=True)
        for before, after in pairs:
            assert distance(*after) < 2 * distance(*before), name


def test_limbs_flicker_where_each_frame_measures_its_own_thickness():
    """So that the tests above judge something."""
    shapes = frames(4, SLOW, bends=False)
    worst = 0.0
    splits = [spectral_tv.decompose(spectral_tv.Mesh(*shape), soft_edges=0.3) for shape in shapes]
    bands = [split.bands(split.band_edges(BANDS), 1.0) for split in splits]
    after = filtered(shapes, bands, FILTERS["without bands"])
    for one, other in zip(pairwise(shapes), pairwise(after), strict=True):
        worst = max(worst, difference(*other) / difference(*one))
    assert worst > 3


@pytest.mark.parametrize("method", ["m1", "m2", "m3", "lb", "displacement"])
def test_the_first_frame_decides_on_scales_or_a_given_area_does(method):
    vertices, triangles = icosphere(2)
    vertices = vertices * (1 + 0.05 * np.sin(9 * vertices[:, :1]))
    first, second = (spectral_tv.Mesh(scale * vertices, triangles) for scale in (1, 2))
    options = {"eigenpairs": 40} if method == "lb" else {}
    one, other = spectral_tv.decompose_sequence([first, second], method, steps=6, **options)
    alone = spectral_tv.decompose(first, method, steps=6, **options)
    np.testing.assert_allclose(one.residual, alone.residual, atol=1e-9)
    if method != "displacement":
        np.testing.assert_array_equal(one.times, other.times)
        np.testing.assert_allclose(one.times, alone.times)
    pair = spectral_tv.decompose_sequence([first], method, steps=6, area=second.area, **options)
    (by_area,) = pair
    if method in ("m1", "m2", "m3"):
        expected = spectral_tv.decompose(second, method, steps=6).times
        np.testing.assert_allclose(by_area.times, expected)
    if method in ("m3", "displacement"):
        twice = spectral_tv.default_base_time() * second.area
        given = spectral_tv.decompose(first, method, by_area.times if method == "m3" else None,
                                      base_time=twice)  # fmt: skip
        np.testing.assert_allclose(by_area.residual, given.residual, atol=1e-9)


def test_an_accuracy_decides_on_the_steps_in_the_first_frame_alone():
    meshes = [spectral_tv.Mesh(*shape) for shape in frames(3, FAST, subdivisions=3)]
    splits = list(spectral_tv.decompose_sequence(meshes, accuracy=0.2))
    first = spectral_tv.decompose(meshes[0], accuracy=0.2)
    for split in splits:
        np.testing.assert_array_equal(split.times, first.times)


def test_a_sequence_is_taken_frame_by_frame_and_wrong_arguments_are_told():
    taken = []

    def meshes():
        for shape in frames(3, FAST, subdivisions=2):
            taken.append(shape)
            yield spectral_tv.Mesh(*shape)

    told: list[float] = []
    splits = spectral_tv.decompose_sequence(meshes(), steps=4, progress=told.append)
    next(splits)
    assert len(taken) == 1 and told[-1] == 1
    with pytest.raises(spectral_tv.MeshError, match="method"):
        next(spectral_tv.decompose_sequence(meshes(), "m4"))
    with pytest.raises(TypeError, match="edge"):
        next(spectral_tv.decompose_sequence(meshes(), edges=3))


def test_a_given_thickness_is_what_limbs_are_kept_by():
    mesh = spectral_tv.Mesh(*dumbbell())
    thick = mesh.with_thickness(np.full(len(mesh.vertices), 1e6))
    assert np.array_equal(spectral_tv.thickness(thick), np.full(len(mesh.vertices), 1e6))
    edges = spectral_tv.decompose(mesh, steps=8).band_edges(3)
    bands = {
        name: spectral_tv.decompose(each, steps=8).bands(edges, keep)
        for name, each, keep in (("free", thick, 1.0), ("own", mesh, 1.0), ("thick", mesh, 1e-12))
    }
    np.testing.assert_allclose(bands["free"], bands["thick"], atol=1e-6)
    assert np.abs(bands["free"] - bands["own"]).max() > 1e-3
    again = pickle.loads(pickle.dumps(thick))
    np.testing.assert_array_equal(spectral_tv.thickness(again), spectral_tv.thickness(thick))
    for wrong, message in (([1.0], "one value per vertex"), (-np.ones(len(mesh.vertices)), "0 or")):
        with pytest.raises(spectral_tv.MeshError, match=message):
            mesh.with_thickness(wrong)


def test_thickness_goes_on_over_other_vertices():
    before = spectral_tv.Mesh(*icosphere(3))
    given = 1 + 0.5 * before.vertices[:, 2]
    mesh = spectral_tv.Mesh(*icosphere(4))
    found = spectral_tv.thickness(mesh, before.with_thickness(given))
    wanted = 1 + 0.5 * mesh.vertices[:, 2]
    assert np.abs(found / wanted - 1).max() < 0.12
    moved = spectral_tv.Mesh(mesh.vertices + np.array([100, 0, 0]), mesh.triangles)
    own = spectral_tv.thickness(moved)
    np.testing.assert_allclose(spectral_tv.thickness(moved, before), own, rtol=1e-6)
