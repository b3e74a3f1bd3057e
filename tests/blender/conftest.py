"""The installed extension: in Blender the one it was started with, in pip's bpy the built zip."""

from __future__ import annotations

import importlib
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
MODULE = "bl_ext.user_default.spectral_tv"
OLDEST = (4, 2)
IN_BLENDER = "bpy" in sys.modules
# What scripts of other processes begin with.
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

if not IN_BLENDER:  # the module reads the variable on import; the user's own files stay apart
    _RESOURCES = tempfile.TemporaryDirectory(prefix="spectral_tv_tests_")
    os.environ["BLENDER_USER_RESOURCES"] = _RESOURCES.name

# What its Python lacks packages for, or the tools; there the command line is judged from outside.
OUTSIDE = [
    "test_bench_posing.py",
    "test_gallery_bands.py",
    "test_limb_turns.py",
    "test_picture_files.py",
    "test_picture_headers.py",
    "test_redraw.py",
]
collect_ignore = OUTSIDE if IN_BLENDER else []

import bpy  # noqa: E402
from deform_scene import constrain, dumbbell_object, empty  # noqa: E402
from map_scene import low_poly, scan  # noqa: E402


def built_zip() -> Path:
    """The zip that SPECTRAL_TV_ZIP names, or that make extension built."""
    if named := os.environ.get("SPECTRAL_TV_ZIP"):
        return Path(named)
    zips = sorted((ROOT / "dist").glob("spectral_tv-*.zip"))
    assert zips, "dist/ holds no extension; run: make extension"
    return zips[-1]


def install() -> None:
    """Have the extension enabled, and with it the package ``spectral_tv`` for the tests."""
    if not IN_BLENDER:
        bpy.ops.wm.read_factory_settings()
        bpy.ops.extensions.package_install_files(
            filepath=str(built_zip()), repo="user_default", enable_on_install=True
        )
    assert MODULE in bpy.context.preferences.addons
    installed = Path(bpy.utils.user_resource("EXTENSIONS"))
    assert Path(sys.modules[MODULE].__file__).is_relative_to(installed)
    if "SPECTRAL_TV_ZIP" in os.environ:  # its own package too, not one that lies beside bpy
        package = importlib.import_module("spectral_tv")
        assert Path(package.__file__).is_relative_to(installed), package.__file__


# Blender takes it for the working directory, even after os.chdir.
os.environ.pop("PWD", None)
install()


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "executable: starts a real Blender executable")
    config.addinivalue_line("markers", "longest: takes minutes, and starts first")
    config.addinivalue_line("markers", "once: is long, of code of our own, and runs in one Blender")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--one-case", action="store_true", help="the first case of each test alone")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("one_case"):
        firsts: dict[str, pytest.Item] = {}
        for item in items:
            firsts.setdefault(item.nodeid.partition("[")[0], item)
        items[:] = firsts.values()
    for item in items:
        if "blender" in getattr(item, "fixturenames", ()):
            item.add_marker("executable")
    # By far the longest first, so that other processes run the others meanwhile.
    items.sort(key=lambda item: item.get_closest_marker("longest") is None)


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
        refuse = pytest.fail if named else pytest.skip
        refuse(f"Blender {version[1]}.{version[2]} is older than 4.2")
    return command


@pytest.fixture(scope="session")
def blender(tmp_path_factory) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs a Blender into which its own command line has installed the extension."""
    command = blender_command()
    resources = str(tmp_path_factory.mktemp("resources"))

    def run(
        *arguments: str, check: bool = True, under: Sequence[str] = (), **options: Any
    ) -> subprocess.CompletedProcess[str]:
        streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        done = subprocess.run(
            [*under, *command, *arguments],
            env={**os.environ, "BLENDER_USER_RESOURCES": resources},
            text=True,
            check=False,
            **{"timeout": 600, **streams, **options},
        )
        assert done.returncode == 0 or not check, done.stdout + done.stderr
        return done

    options = ["-r", "user_default", "--enable", str(built_zip())]
    run("--command", "extension", "install-file", *options)
    return run


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


@pytest.fixture(scope="session", autouse=True)
def _removed_in_the_end():
    yield
    bpy.ops.preferences.addon_disable(module=MODULE)
    if not IN_BLENDER:
        _RESOURCES.cleanup()


@pytest.fixture(scope="module", autouse=True)
def _own_file():
    """The tests of each file start in a new one of Blender's, which has no name."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.context.scene.cycles.use_denoising = False  # Debian's Blender lacks the denoiser


@pytest.fixture(autouse=True)
def _empty_scene():
    """Every test starts without objects and meshes."""
    yield
    if bpy.context.object is not None and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes, *bpy.data.curves])


@pytest.fixture(autouse=True)
def _context_holds_no_scene():
    """Up to Blender 4.3 reading `bpy.context.tool_settings` leaves the scene in `bpy.context`.

    Once another file is loaded, Blender's exporter of glTF may crash of that.
    """
    yield
    window = bpy.context.window
    assert window is None or not isinstance(window.id_data, bpy.types.Scene)


@pytest.fixture
def monkey():
    """Suzanne, subdivided: quads and triangles, three components, open borders."""
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 2
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    return obj


@pytest.fixture
def body():
    """A dumbbell with vertex groups at its ends, the active object."""
    return dumbbell_object()


@pytest.fixture
def held(body):
    """The same, its lower end pinned and its upper end following an empty."""
    constrain(body, "Feet", "PIN")
    constrain(body, "Head", "OBJECT", target=empty((0, 0, 2)))
    return body


@pytest.fixture
def pair() -> tuple[bpy.types.Object, bpy.types.Object]:
    """A scan with bands, and a low-poly mesh in its place."""
    return scan(), low_poly()


@pytest.fixture
def no_images():
    """The next test starts without images and materials."""
    yield
    bpy.data.batch_remove([*bpy.data.images, *bpy.data.materials])


@pytest.fixture
def choices():
    """The choices of the sidebar, which are as they were at first in the end."""
    found = bpy.context.scene.spectral_tv
    yield found
    found.fill(importlib.import_module("spectral_tv.bands.settings").Settings())
    for name in ("finest", "largest", "base_amount"):
        found.property_unset(name)
