"""Find dead links in a built site: python -m tools.site.links FOLDER.

Every link to a file of the site, and to an anchor in a page, has to lead somewhere. Nothing that a
page loads may come from the network.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from urllib.parse import unquote, urlsplit

from lxml import html

# What rustdoc and the theme wrote is their own matter; but that it is there is ours.
OTHERS = ("rust", "_static")
LOADED = {"img", "script", "iframe", "source", "video", "audio", "embed"}
LOADED_RELATIONS = {"stylesheet", "preload", "icon", "modulepreload", "prefetch"}


def main() -> None:
    """Name each dead link, and exit with a message if there are any."""
    site = Path(sys.argv[1]).resolve()
    pages = [page for page in site.rglob("*.html") if page.relative_to(site).parts[0] not in OTHERS]
    count, problems = 0, []
    for page in pages:
        for address, is_loaded in links(page):
            count += 1
            if problem := fault(site, page, address, is_loaded):
                problems.append(f"{page.relative_to(site)}: {address} {problem}")
    print(f"{count} links of {len(pages)} pages followed")
    if problems or not count:
        sys.exit("\n".join(problems) or "there is no link")


def links(page: Path) -> Iterator[tuple[str, bool]]:
    """Addresses that a page names, and whether it loads what is there."""
    for element, attribute, address, _ in parsed(page).iterlinks():
        relations = set((element.get("rel") or "").split())
        is_loaded = element.tag in LOADED or bool(relations & LOADED_RELATIONS)
        if attribute in {"href", "src", "data", "poster"}:
            yield address, is_loaded


def fault(site: Path, page: Path, address: str, is_loaded: bool) -> str | None:
    """What is wrong with an address."""
    parts = urlsplit(address)
    if parts.scheme or parts.netloc:
        return "comes from the network" if is_loaded and parts.scheme != "data" else None
    target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    if not target.is_relative_to(site):
        return "leads out of the site"
    if not target.is_file():
        return "leads nowhere"
    anchor = unquote(parts.fragment)
    is_page = target.suffix == ".html" and target.relative_to(site).parts[0] not in OTHERS
    if anchor and is_page and anchor not in anchors(target):
        return "leads to no such place in the page"
    return None


@cache
def parsed(page: Path) -> html.HtmlElement:
    """The tree of a page."""
    return html.fromstring(page.read_bytes(), parser=html.HTMLParser(encoding="utf-8"))


@cache
def anchors(page: Path) -> frozenset[str]:
    """The names of places in a page."""
    return frozenset(parsed(page).xpath("//@id | //a/@name"))


if __name__ == "__main__":
    main()
