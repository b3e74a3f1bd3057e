"""The installed extension has its licence, and those of what is built into it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from conftest import MODULE, ROOT


@pytest.mark.parametrize("name", ["LICENSE", "THIRD_PARTY_LICENSES.txt"])
def test_licences_lie_beside_the_manifest(name):
    folder = Path(sys.modules[MODULE].__file__).parent
    assert (folder / "blender_manifest.toml").is_file()
    assert (folder / name).read_bytes() == (ROOT / name).read_bytes()
