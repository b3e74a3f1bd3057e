"""The package is read in parts: what computes is read when it is first asked for."""

from __future__ import annotations

import pytest
import spectral_tv
from own_process import output

LATER = ("numpy", "spectral_tv._functions", "spectral_tv._results", "spectral_tv._work")


def test_importing_it_reads_no_numpy_and_no_function():
    seen = output(
        "import sys, spectral_tv\n"
        f"print([name for name in {LATER!r} if name in sys.modules])\n"
        "print(sorted({*spectral_tv.__all__} - {*dir(spectral_tv)}))\n"
        "assert spectral_tv.MeshError.faces.shape == (0,) and 'numpy' in sys.modules\n"
        "from spectral_tv import decompose\n"
        "assert decompose is spectral_tv.decompose and 'spectral_tv._functions' in sys.modules\n",
        60,
    )
    assert seen == "[]\n[]\n"


def test_a_star_brings_all_names():
    names: dict[str, object] = {}
    exec("from spectral_tv import *", names)
    assert {*spectral_tv.__all__} <= {*names}


def test_a_name_that_it_does_not_have():
    with pytest.raises(AttributeError, match="module 'spectral_tv' has no attribute 'decomposed'"):
        spectral_tv.decomposed  # noqa: B018
    with pytest.raises(ImportError, match="decomposed"):
        exec("from spectral_tv import decomposed")
