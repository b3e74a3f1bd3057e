"""The Rust that Cargo.toml asks for is as new as crates need it; of our own code clippy tells."""

from __future__ import annotations

import json
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.skipif(shutil.which("cargo") is None, reason="cargo knows the crates")
def test_no_crate_asks_for_newer_rust():
    command = ["cargo", "metadata", "--format-version", "1", "--locked"]
    shown = subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT)
    asked = {
        (package["name"], package["version"]): tuple(
            map(int, package["rust_version"].split(".")[:2])
        )
        for package in json.loads(shown.stdout)["packages"]
        if package["rust_version"]
    }
    assert len(asked) > 50
    cargo = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))
    ours = tuple(map(int, cargo["workspace"]["package"]["rust-version"].split(".")))
    assert not {crate for crate, needed in asked.items() if needed > ours}
