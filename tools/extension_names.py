"""Finds names in the extension that no module has: ``python extension_names.py``.

The extension is full of what bpy makes while it runs, so mypy cannot judge its types. What modules
have it can judge. Prints each such name; ends with 1 if there is one.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from mypy import api

EXTENSION = Path(__file__).parents[1] / "addon"
OPTIONS = ["--explicit-package-bases", "--config-file="]
LACKING = re.compile(r'error: (Module( ".*")? has no attribute|Cannot find .*"addon\.)')


def main() -> int:
    """Print what is lacking; 1 if anything is."""
    found, failure, _ = api.run([*OPTIONS, str(EXTENSION)])
    lacking = [line for line in found.splitlines() if LACKING.search(line)]
    for line in lacking:
        print(line)
    print(failure, file=sys.stderr, end="")
    return 1 if lacking or failure else 0


if __name__ == "__main__":
    sys.exit(main())
