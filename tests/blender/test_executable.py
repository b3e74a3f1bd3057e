"""The extension in a real Blender executable, where there is one."""

from __future__ import annotations

import re
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from conftest import MODULE
from network_calls import network_calls, traced

# What tests may be left out for there.
REASONS = (
    "this Blender is built without",
    "got empty parameter set for (suffix)",  # of formats that it is built without
    "no disk can be mounted",
    "could not import 'trimesh'",  # which examples of the docs need, and the next
    "could not import 'matplotlib'",
)
PYTEST = ("pytest", "_pytest", "pluggy", "iniconfig", "packaging", "pygments", "py")


def test_decomposes_in_background_without_a_network(blender, tmp_path: Path):
    script = tmp_path / "script.py"
    saved = tmp_path / "bands.blend"
    script.write_text(
        "import bpy\n"
        "bpy.ops.mesh.primitive_monkey_add()\n"
        "bpy.ops.spectral_tv.decompose(method='M2', bands=3, steps=8)\n"
        f"bpy.ops.wm.save_as_mainfile(filepath={str(saved)!r})\n",
        encoding="utf-8",
    )
    log = tmp_path / "network.log"
    is_traced = sys.platform == "linux"  # strace is Linux's
    under = traced(log) if is_traced else ()
    blender("--background", "--python-exit-code", "7", "--python", str(script), under=under)
    assert not is_traced or not network_calls(log)
    check = "import bpy; print('keys', [k.name for k in bpy.data.shape_keys[0].key_blocks])"
    done = blender("--background", str(saved), "--python-exit-code", "7", "--python-expr", check)
    assert (
        "keys ['Basis', 'Limbs and Head Band 1', 'Limbs and Head Band 2', 'Limbs and Head Band 3']"
        in done.stdout
    )


def test_it_starts_with_factory_settings_and_warns_of_nothing(blender):
    """Not even of what Python tells on demand alone."""
    enable = (
        "import bpy, warnings; warnings.simplefilter('always'); "
        f"bpy.ops.preferences.addon_enable(module={MODULE!r}); "
        f"assert {MODULE!r} in bpy.context.preferences.addons; "
        f"assert hasattr(bpy.types, 'SPECTRAL_TV_OT_decompose')"
    )
    start = ["--background", "--factory-startup", "--python-exit-code", "7"]
    plain = blender(*start)
    for way in (["--python-expr", enable], ["--addons", MODULE, "--python-expr", enable]):
        done = blender(*start, *way)
        assert (done.stdout, done.stderr) == (plain.stdout, plain.stderr)


@pytest.mark.longest
def test_the_extension_passes_its_tests_inside(blender, tmp_path: Path):
    """Blender's own Python runs pytest, lent from here, on the extension it was started with."""
    packages = tmp_path / "packages"
    packages.mkdir()
    for name in PYTEST:
        source = Path(find_spec(name).origin)
        source = source.parent if source.name == "__init__.py" else source
        (packages / source.name).symlink_to(source)
    script = Path(__file__).with_name("run_inside.py")
    options = ["--background", "--python-exit-code", "7", "--python", str(script)]
    done = blender(*options, "--", str(packages), timeout=1500)
    assert re.search(r"\d+ passed", done.stdout), done.stdout
    skipped = re.findall(r"^SKIPPED .*", done.stdout, re.MULTILINE)
    assert all(any(reason in line for reason in REASONS) for line in skipped), skipped
