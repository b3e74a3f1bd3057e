"""Runs the extension's tests in the Python of a Blender in which it is installed and enabled.

    blender --background --python-exit-code 7 --python run_inside.py -- PACKAGES

PACKAGES is a directory with pytest, which Blender has not. With EVERY_CASE in the environment all
cases of each test run, else the first.
"""

import os
import sys
from pathlib import Path

OPTIONS = ["-rs", "-p", "no:cacheprovider", "-m", "not executable and not once"]
if not os.environ.get("EVERY_CASE"):
    OPTIONS.append("--one-case")


if __name__ == "__main__":  # processes that tests spawn read this file too
    sys.path.insert(0, sys.argv[sys.argv.index("--") + 1])
    import pytest

    status = pytest.main([*OPTIONS, str(Path(__file__).parent)])
    if status:
        raise RuntimeError(f"pytest returned {status!r}")
