"""Errors that concern elements of a mesh have the indices of all of them."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import icosphere

VERTICES, TRIANGLES = icosphere(2)
MESH = spectral_tv.Mesh(VERTICES, TRIANGLES)


def changed(array, value, *indices):
    array = array.copy()
    for index in indices:
        array[index] = value
    return array


@pytest.mark.parametrize(
    ("call", "vertices", "faces"),
    [
        (
            lambda: spectral_tv.Mesh(changed(VERTICES, np.nan, (17, 1), (4, 2)), TRIANGLES),
            [4, 17],
            [],
        ),
        (lambda: spectral_tv.Mesh(VERTICES, changed(TRIANGLES, -1, (9, 0), (9, 2), 5)), [], [5, 9]),
        (
            lambda: spectral_tv.decompose(
                MESH, "m3", base=changed(VERTICES, np.inf, (8, 2), (3, 0))
            ),
            [3, 8],
            [],
        ),
        (lambda: spectral_tv.flow(MESH, changed(VERTICES, 1e300, 40), [0, 1]), [40], []),
        (
            lambda: spectral_tv.start_flow(MESH, changed(VERTICES, 1e300, 40), [0, 1]).result(),
            [40],
            [],
        ),
        (lambda: spectral_tv.decompose(MESH, steps=0), [], []),
        (lambda: spectral_tv.Mesh(VERTICES, "triangles"), [], []),
    ],
)
def test_errors_tell_the_elements(call, vertices, faces):
    with pytest.raises(spectral_tv.MeshError) as caught:
        call()
    for found, expected in ((caught.value.vertices, vertices), (caught.value.faces, faces)):
        assert found.dtype == np.int64
        assert found.tolist() == expected
    assert str(caught.value).endswith("so it is with 1 more") == (len(vertices + faces) == 2)
