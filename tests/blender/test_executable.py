"""The extension in a real Blender executable, where there is one."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

OLDEST = (4, 2)


def blender_command() -> list[str]:
    """The executable that BLENDER names or that is on PATH, if it is new enough."""
    named = os.environ.get("BLENDER")
    command = shlex.split(named) if named else [path for path in [shutil.which("blender")] if path]
    if not command:
        pytest.skip("no Blender: BLENDER is not set and blender is not on PATH")
    output = subprocess.run([*command, "--version"], capture_output=True, text=True, check=True)
    version = re.search(r"Blender (\d+)\.(\d+)", output.stdout)
    assert version, output.stdout
    if tuple(map(int, version.groups())) < OLDEST:
        pytest.skip(f"Blender {version[1]}.{version[2]} is older than 4.2")
    return command


def test_installs_and_decomposes_in_background(extension_zip: Path, tmp_path: Path):
    command = blender_command()
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path)}

    def run(*arguments: str) -> str:
        done = subprocess.run(
            [*command, *arguments],
            env=environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=300,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    install = ["extension", "install-file", "-r", "user_default", "--enable", str(extension_zip)]
    run("--command", *install)
    script = tmp_path / "script.py"
    saved = tmp_path / "bands.blend"
    script.write_text(
        "import bpy\n"
        "bpy.ops.mesh.primitive_monkey_add()\n"
        "bpy.ops.spectral_tv.decompose(method='M2', bands=3, steps=8)\n"
        f"bpy.ops.wm.save_as_mainfile(filepath={str(saved)!r})\n",
        encoding="utf-8",
    )
    run("--background", "--python-exit-code", "7", "--python", str(script))
    check = "import bpy; print('keys', [k.name for k in bpy.data.shape_keys[0].key_blocks])"
    output = run("--background", str(saved), "--python-exit-code", "7", "--python-expr", check)
    assert "keys ['Basis', 'M2 Band 1', 'M2 Band 2', 'M2 Band 3']" in output
