"""Nothing is sent or asked for over a network."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from many_files import COMMAND, QUICK, write_good
from network_calls import network_calls, traced

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="strace is Linux's")


def calls(log: Path, *command: str) -> list[str]:
    subprocess.run([*traced(log), *command], check=True, capture_output=True)
    return network_calls(log)


def test_the_command_line_calls_no_network(tmp_path):
    write_good(tmp_path / "in", 2)
    (tmp_path / "out").mkdir()
    options = ["-o", str(tmp_path / "out"), "--format", "npz", *QUICK]
    assert not calls(tmp_path / "log", *COMMAND, str(tmp_path / "in"), *options)
    assert len([*(tmp_path / "out").rglob("*.npz")]) == 2


def test_a_call_would_be_seen(tmp_path):
    code = "import socket; socket.socket(socket.AF_INET, socket.SOCK_DGRAM).close()"
    assert len(calls(tmp_path / "log", sys.executable, "-c", code)) == 1
