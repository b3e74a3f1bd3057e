"""The extension where its native module cannot be used: enabled all the same, it says why."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from importlib.metadata import distribution
from pathlib import Path
from zipfile import ZipFile

import bpy
import pytest
from conftest import IN_BLENDER, MODULE, built_zip

FOREIGN = "linux_riscv64"  # Blender runs on none, so its wheel is never the one for this machine
INSTALL = """
import importlib, os, sys
import bpy

def install(path):
    bpy.ops.extensions.package_install_files(
        filepath=path, repo="user_default", enable_on_install=True
    )
    assert {module!r} in bpy.context.preferences.addons

def tell():
    print("problem:", importlib.import_module({module!r} + ".native").problem())
    print("panels:", *sorted(n for n in dir(bpy.types) if n.startswith("SPECTRAL_TV_PT_")))
    print("operators:", *sorted(dir(bpy.ops.spectral_tv)))
"""
WORKING = re.compile(r"problem: None\npanels: .*_PT_decompose.*\noperators: .*decompose")
UNAVAILABLE = r"problem: (.*)\npanels: SPECTRAL_TV_PT_unavailable\noperators:\s*\n"


@pytest.fixture
def session(tmp_path: Path):
    """Runs a script in another process of this Blender, where nothing of ours is installed."""
    packages = tmp_path / "packages"
    packages.mkdir()
    resources = tmp_path / "resources"
    resources.mkdir()
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(resources)}
    if IN_BLENDER:
        environment.pop("PYTHONPATH", None)
        command = [bpy.app.binary_path, "--background", "--python-exit-code", "7", "--python"]
    else:  # all packages that lie beside bpy but this one
        for path in Path(str(distribution("bpy").locate_file(""))).iterdir():
            if not path.name.startswith("spectral_tv"):
                (packages / path.name).symlink_to(path)
        environment["PYTHONPATH"] = str(packages)
        command = [sys.executable, "-s", "-S"]

    def run(script: str) -> str:
        file = tmp_path / "script.py"
        file.write_text(
            INSTALL.format(module=MODULE) + script + "\nsys.stdout.flush(); os._exit(0)\n",
            encoding="utf-8",
        )
        done = subprocess.run(
            [*command, str(file)],
            env=environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=300,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run


def altered_zip(target: Path, rename: tuple[str, str], version: str | None = None) -> Path:
    """Copy the extension, its wheel renamed, its manifest of another version."""
    with ZipFile(built_zip()) as source, ZipFile(target, "w") as copy:
        for name in source.namelist():
            content = source.read(name)
            if name.endswith("blender_manifest.toml"):
                text = content.decode().replace(*rename)
                if version is not None:
                    text = re.sub(r'(?m)^version = ".*"', f'version = "{version}"', text)
                content = text.encode()
            copy.writestr(name.replace(*rename), content)
    return target


def platform_tag() -> str:
    """The platform that the built zip's wheel is for."""
    with ZipFile(built_zip()) as source:
        (wheel,) = (name for name in source.namelist() if name.endswith(".whl"))
    return Path(wheel).stem.rsplit("-", 1)[1]


def test_on_another_platform(session, tmp_path: Path):
    """A wheel for elsewhere is not installed; the panel and the command say what is missing."""
    foreign = altered_zip(tmp_path / "foreign.zip", (platform_tag(), FOREIGN))
    output = session(
        f"install({str(foreign)!r})\ntell()\n"
        f"bpy.ops.preferences.addon_disable(module={MODULE!r})\n"
        f"bpy.ops.preferences.addon_enable(module={MODULE!r})\ntell()\n"
        f"command = importlib.import_module({MODULE + '.unavailable'!r})\n"
        "sys.stderr = sys.stdout\n"
        "print('code:', command.run(['decompose']))\n"
        f"install({str(built_zip())!r})\ntell()\n"
    )
    first, second = re.findall(UNAVAILABLE, output)
    assert first == second
    assert re.match(r"The native module .* is missing: install spectral_tv-[\w.-]+\.zip", first)
    assert f"{FOREIGN}.whl" in first
    assert f"spectral_tv: {first}\ncode: 1\n" in output
    assert WORKING.search(output)  # once the right zip is installed, in the same session


def test_of_another_version(session, tmp_path: Path):
    """An extension does not work with the native module of another."""
    newer = altered_zip(tmp_path / "newer.zip", ("", ""), version="99.1.2")
    output = session(
        f"install({str(newer)!r})\ntell()\nimport spectral_tv\n"
        "print('found:', spectral_tv.__version__)\n"
        f"install({str(built_zip())!r})\ntell()\n"
    )
    (problem,) = re.findall(UNAVAILABLE, output)
    (found,) = re.findall(r"found: (.*)", output)
    assert "99.1.2" in problem and f"version {found}" in problem and "restart" in problem
    assert WORKING.search(output)


def test_that_the_system_refuses(session, tmp_path: Path):
    """A module that the loader turns down is named with the loader's own words."""
    broken = tmp_path / "broken.zip"
    with ZipFile(built_zip()) as source, ZipFile(broken, "w") as copy:
        for name in source.namelist():
            content = source.read(name)
            if name.endswith(".whl"):
                content = without_native_code(content, tmp_path)
            copy.writestr(name, content)
    (problem,) = re.findall(UNAVAILABLE, session(f"install({str(broken)!r})\ntell()\n"))
    assert problem.startswith("The native module does not load on this ")
    assert "_native" in problem


def without_native_code(wheel: bytes, directory: Path) -> bytes:
    """Empty the shared library in a wheel."""
    old, new = directory / "old.whl", directory / "new.whl"
    old.write_bytes(wheel)
    with ZipFile(old) as source, ZipFile(new, "w") as copy:
        for name in source.namelist():
            is_library = name.endswith((".so", ".pyd"))
            copy.writestr(name, b"" if is_library else source.read(name))
    return new.read_bytes()
