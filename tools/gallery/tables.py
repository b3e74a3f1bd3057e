"""Tables of a page, between markers, whose rows are made anew one by one."""

from __future__ import annotations

import re
from pathlib import Path


def write_row(page: Path, table: str, row: str) -> None:
    """Put a row of a table in the place of the one with its name, or at its end."""
    text = page.read_text(encoding="utf-8")
    place = re.search(rf"<!-- {table} -->\n(.*?)<!-- /{table} -->", text, re.DOTALL)
    if place is None:
        raise SystemExit(f"{page} lacks the markers <!-- {table} --> <!-- /{table} -->")
    name = row.split(" | ", maxsplit=1)[0]
    lines = place[1].splitlines()
    known = [line.split(" | ")[0] for line in lines]
    if name in known:
        lines[known.index(name)] = row
    else:
        lines.append(row)
    body = "\n".join(lines)
    page.write_text(f"{text[: place.start(1)]}{body}\n{text[place.end(1) :]}", encoding="utf-8")
