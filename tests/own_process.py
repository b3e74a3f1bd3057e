"""Python code in a process of its own."""

from __future__ import annotations

import subprocess
import sys


def output(code: str, timeout: float) -> str:
    """What the code prints; it fails with what it says of errors, and ends within the seconds."""
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout
