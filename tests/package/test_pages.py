"""Pages for newcomers name files that are there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import spectral_tv

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("addon", "docs", "python", "rust", "tests", "tools")


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "README.md", "docs/design.md"])
def test_files_that_a_page_names_are_there(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    named = [path for path in re.findall(r"`([\w./-]+)`", text) if path.split("/")[0] in FOLDERS]
    assert named
    for path in named:
        assert (ROOT / path).exists() or "artifacts" in path or "corpus" in path, path


def test_the_page_on_the_python_api_has_every_name():
    text = (ROOT / "docs" / "site" / "python_api.md").read_text(encoding="utf-8")
    named = re.findall(r"^\.\. auto\w+:: (\w+)$", text, re.MULTILINE)
    assert sorted(named) == sorted({*spectral_tv.__all__, "spectral_tv"} - {"__version__"})
