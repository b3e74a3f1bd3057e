"""Whatever the image: a finite flow whose bands add up to it, or a refusal."""

from __future__ import annotations

import numpy as np
import spectral_tv
from hypothesis import given
from hypothesis import strategies as st
from test_any_value import NUMBERS, arrays, refusable

SHAPES = st.one_of(
    st.tuples(st.integers(2, 7), st.integers(2, 7)),
    st.tuples(st.integers(2, 5), st.integers(2, 5), st.integers(1, 5)),
    st.sampled_from([(), (3,), (1, 5), (0, 4), (4, 4, 0), (2, 2, 2, 2)]),
)


@given(st.data(), SHAPES)
def test_any_pixels_are_decomposed(data, shape):
    image = data.draw(arrays(shape))
    settings = {
        "metric": st.sampled_from(["flat", "surface", "", "Flat"]),
        "height": NUMBERS,
        "times": st.one_of(st.just([0.0, 0.1, 0.5]), st.lists(NUMBERS).map(sorted)),
        "scheme": st.sampled_from(["lagged", "exact"]),
        "tolerance": NUMBERS,
        "solver": st.sampled_from(["cholesky", "single", "multigrid"]),
    }
    names = data.draw(st.sets(st.sampled_from([*settings]), max_size=3))
    chosen = {"steps": 4, **{name: data.draw(settings[name]) for name in sorted(names)}}
    flow = refusable(lambda: spectral_tv.start_decompose_image(image, **chosen))
    if flow is None:
        return
    pixels = np.asarray(image, dtype=np.float64)
    assert flow.states.shape[1:] == pixels.shape
    assert np.isfinite(flow.states).all()
    assert np.isfinite(flow.residual).all()
    assert np.isfinite(flow.spectrum).all()
    assert (np.diff(flow.total_variation) <= 1e-5 * flow.total_variation[0]).all()
    bands = flow.bands([0, *flow.times[1:-1] * (1 + 1e-9), np.inf])
    size = max(np.abs(part).max() for part in (pixels, flow.residual, *bands))
    whole = bands.sum(axis=0) + flow.residual
    np.testing.assert_allclose(whole, pixels, rtol=0, atol=1e-12 * size)


@given(st.data(), st.integers(2, 6), st.integers(2, 6))
def test_any_weights_have_a_mean(data, rows, columns):
    image = np.arange(rows * columns, dtype=float).reshape(rows, columns)
    flow = spectral_tv.decompose_image(image, steps=3)
    shape = data.draw(st.sampled_from([(rows, columns), (rows, columns), (columns,), ()]))
    mean = refusable(lambda: flow.mean(data.draw(arrays(shape))))
    if mean is not None:
        assert (image.min() - 1e-9 <= mean).all()
        assert (mean <= image.max() + 1e-9).all()
