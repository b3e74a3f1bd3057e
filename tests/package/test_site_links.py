"""The check of the site's links finds what is dead."""

from __future__ import annotations

import pytest

from tools.site.links import fault, links


@pytest.fixture
def site(tmp_path):
    (tmp_path / "docs").mkdir()
    (tmp_path / "picture.png").write_bytes(b"")
    (tmp_path / "index.html").write_text('<h1 id="top">Front</h1><a name="old"></a>')
    return tmp_path


@pytest.mark.parametrize(
    ("element", "problem"),
    [
        ('<a href="../index.html">', None),
        ('<a href="../index.html#top">', None),
        ('<a href="../index.html#old">', None),
        ('<a href="#here">', None),
        ('<img src="../picture.png?digest=1">', None),
        ('<a href="https://example.org/page">', None),
        ('<a href="mailto:someone@example.org">', None),
        ('<img src="data:image/png;base64,">', None),
        ('<a href="../gone.html">', "leads nowhere"),
        ('<a href="../index.html#gone">', "leads to no such place in the page"),
        ('<a href="#gone">', "leads to no such place in the page"),
        ('<a href="../docs">', "leads nowhere"),
        ('<a href="../../passwd">', "leads out of the site"),
        ('<img src="https://example.org/picture.png">', "comes from the network"),
        ('<script src="//example.org/code.js"></script>', "comes from the network"),
        ('<link rel="stylesheet" href="https://example.org/style.css">', "comes from the network"),
    ],
)
def test_each_kind_of_link(site, element, problem):
    page = site / "docs" / "page.html"
    page.write_text(f'<html><body><p id="here">Text</p>{element}</body></html>')
    ((address, is_loaded),) = links(page)
    assert fault(site, page, address, is_loaded) == problem
