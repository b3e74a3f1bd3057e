"""Faces that fold or stretch, against their definition and against what is known of a sphere."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from nasty_meshes import corpus
from reference_guard import counted, lengths, normals, takes_part
from shapes import bumpy_sphere, icosphere

pytestmark = pytest.mark.filterwarnings("ignore::spectral_tv.MeshWarning")

SPHERE, TRIANGLES = icosphere(3)
FLATTENING = -SPHERE * [0, 0, 1]


def turns(vertices, triangles, displacement):
    """The area that each face keeps, as seen along its normal, relative to its own."""
    before = normals(vertices, triangles)
    after = normals(vertices + displacement, triangles)
    return (before * after).sum(axis=1) / (before**2).sum(axis=1)


def test_a_sphere_that_is_turned_inside_out_along_an_axis_folds_where_theory_says():
    """N(g)·n = 1 − g (1 − n_z²): beyond 1/(1 − n_z²) a face is turned by over 90°."""
    mesh = spectral_tv.Mesh(SPHERE, TRIANGLES)
    normal = normals(SPHERE, TRIANGLES)
    upright = normal[:, 2] ** 2 / (normal**2).sum(axis=1)
    safe = 0.8 / (1 - upright.min())
    for gain in (0.5, 1.0, 1.3, 2.0, 5.0):
        found = spectral_tv.folds(mesh, gain * FLATTENING, stretch=10)
        np.testing.assert_array_equal(found.flipped, np.flatnonzero(gain * (1 - upright) > 1))
        assert found.safe_gain == pytest.approx(safe / gain, rel=1e-12)
    at = 1 / (1 - upright.min())
    assert len(spectral_tv.folds(mesh, at * (1 - 1e-9) * FLATTENING).flipped) == 0
    assert len(spectral_tv.folds(mesh, at * (1 + 1e-9) * FLATTENING).flipped) > 0


def test_a_band_folds_nothing_up_to_its_safe_gain_and_soon_after():
    vertices, triangles = bumpy_sphere(4)
    mesh = spectral_tv.Mesh(vertices, triangles)
    split = spectral_tv.decompose(mesh, "m1", steps=12)
    band = split.bands(split.band_edges(3))[0]
    found = spectral_tv.folds(mesh, band, stretch=1e6)
    assert found.safe_gain < np.inf
    # The margin: the first face has a fifth of its area left.
    left = turns(vertices, triangles, found.safe_gain * band)
    assert left.min() == pytest.approx(0.2, rel=1e-9)
    below = np.linspace(0, found.safe_gain, 9)[:-1]
    assert all(turns(vertices, triangles, gain * band).min() > 0.2 for gain in below)
    tight = spectral_tv.folds(mesh, band, stretch=1.01)
    ratios = lengths(vertices + tight.safe_gain * band, triangles) / lengths(vertices, triangles)
    assert tight.safe_gain < found.safe_gain
    assert ratios.max() == pytest.approx(1.01, rel=1e-9)


@pytest.mark.parametrize("name", corpus())
@pytest.mark.parametrize("size", [1e-3, 0.1, 1.0, 30.0])
def test_bad_meshes_fold_and_stretch_by_definition(name, size):
    vertices, triangles = corpus()[name]
    mesh = spectral_tv.Mesh(vertices, triangles)
    rng = np.random.default_rng(7)
    edges = lengths(vertices, triangles)
    displacement = size * np.median(edges) * rng.normal(size=vertices.shape)
    found = spectral_tv.folds(mesh, displacement)
    part, (least, has_normal) = takes_part(vertices, triangles), counted(vertices, triangles)
    before, change = normals(vertices, triangles), normals(vertices + displacement, triangles)
    cosine = (before * change).sum(axis=1)
    rounding = 1e-9 * np.linalg.norm(before, axis=1) * np.linalg.norm(change, axis=1)
    is_flipped = np.isin(np.arange(len(triangles)), found.flipped)
    counts = part & has_normal
    assert is_flipped[counts & (cosine < -rounding)].all()
    assert not is_flipped[~counts | (cosine > rounding)].any()
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = lengths(vertices + displacement, triangles) / least
    ratio = np.where(part[:, np.newaxis], ratio, 0).max(axis=1)
    assert found.largest_stretch == pytest.approx(ratio.max(), rel=1e-6)
    is_stretched = np.isin(np.arange(len(triangles)), found.stretched)
    assert is_stretched[ratio > 2.5 * (1 + 1e-6)].all()
    assert not is_stretched[ratio < 2.5 * (1 - 1e-6)].any()
    assert found.safe_gain > 0
    if found.safe_gain < np.inf:
        below = spectral_tv.folds(mesh, 0.999 * found.safe_gain * displacement)
        assert len(below.flipped) == len(below.stretched) == 0


def test_the_arrays_of_a_result_are_the_callers():
    mesh = spectral_tv.Mesh(SPHERE, TRIANGLES)
    found = spectral_tv.folds(mesh, 3 * FLATTENING)
    assert found.flipped.dtype == found.stretched.dtype == np.int64
    count = len(found.flipped)
    found.flipped[:] = 0
    assert len(np.unique(found.flipped)) == count


@pytest.mark.parametrize(
    ("displacement", "stretch", "message"),
    [
        (SPHERE[1:], 2.5, r"every vertex \(642\), but has 641"),
        (SPHERE[:, :2], 2.5, r"displacement must have the shape \(rows, 3\)"),
        (SPHERE[:, 0], 2.5, r"displacement must have the shape \(rows, 3\)"),
        (np.where(SPHERE > 2, 0, np.nan), 2.5, "the value of vertex 0, channel 0"),
        (SPHERE, 1.0, "stretch must be above 1"),
        (SPHERE, np.nan, "stretch must be above 1"),
        (SPHERE, np.inf, "stretch must be above 1"),
    ],
)
def test_what_is_no_displacement_or_no_limit_is_refused(displacement, stretch, message):
    mesh = spectral_tv.Mesh(SPHERE, TRIANGLES)
    for function in (spectral_tv.folds, spectral_tv.safe_displacement):
        with pytest.raises(spectral_tv.MeshError, match=message):
            function(mesh, displacement, stretch)
    if not message.startswith("stretch"):
        with pytest.raises(spectral_tv.MeshError, match=message):
            spectral_tv.self_intersections(mesh, displacement)
