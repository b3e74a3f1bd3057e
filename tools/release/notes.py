"""Print what CHANGELOG.md says of a version, as the text of its release.

python notes.py VERSION
"""

import re
import sys
from pathlib import Path

CHANGELOG = Path(__file__).resolve().parents[2] / "CHANGELOG.md"


def notes(changelog: str, version: str) -> str:
    """Return the section of a version; exits if there is none, or none with a date."""
    sections = re.split(r"^## ", changelog, flags=re.MULTILINE)[1:]
    found = [section for section in sections if section.split(maxsplit=1)[0] == version]
    if not found:
        sys.exit(f"notes.py: CHANGELOG.md has no section of {version}")
    heading, _, text = found[0].partition("\n")
    if not re.search(r"\d{4}-\d{2}-\d{2}$", heading):
        sys.exit(f"notes.py: CHANGELOG.md has no date of {version}: {heading}")
    # Where releases are shown, the end of a line is one: let only blank lines, points of lists,
    # rows of tables and headings begin anew.
    return re.sub(r"(?<=\S)\n[ ]*(?=[^\s#|-])", " ", text.strip())


if __name__ == "__main__":
    (asked,) = sys.argv[1:]
    print(notes(CHANGELOG.read_text(encoding="utf-8"), asked))
