"""The text of a release is what CHANGELOG.md says of its version."""

from __future__ import annotations

import pytest

from tools.release.notes import notes

CHANGELOG = """\
# Changelog

## 0.2.0 – unreleased

- New.

## 0.1.0 – 2026-05-04

- A fact that takes
  two lines.
- Another fact.

A paragraph of
two lines.
"""


def test_lines_are_whole_paragraphs():
    expected = "- A fact that takes two lines.\n- Another fact.\n\nA paragraph of two lines."
    assert notes(CHANGELOG, "0.1.0") == expected


@pytest.mark.parametrize(("version", "reason"), [("0.2.0", "no date"), ("0.1", "no section")])
def test_nothing_is_released_without_a_section_and_a_date(version, reason):
    with pytest.raises(SystemExit, match=reason):
        notes(CHANGELOG, version)
