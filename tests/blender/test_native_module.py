"""The extension where its native module cannot be used: enabled all the same, it says why."""

from __future__ import annotations

import re
from pathlib import Path
from zipfile import ZipFile

from conftest import MODULE, built_zip

FOREIGN = "linux_riscv64"  # Blender runs on none, so its wheel is never the one for this machine
WORKING = re.compile(r"problem: None\npanels: .*_PT_decompose.*\noperators: .*decompose")
UNAVAILABLE = r"problem: (.*)\npanels: SPECTRAL_TV_PT_unavailable\noperators:\s*\n"


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
