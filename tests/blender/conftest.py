"""The extension installed from its built zip into pip's bpy, apart from the user's own files."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest

_RESOURCES = tempfile.TemporaryDirectory(prefix="spectral_tv_tests_")
os.environ["BLENDER_USER_RESOURCES"] = _RESOURCES.name

import bpy  # noqa: E402  (reads the variable above)

ROOT = Path(__file__).resolve().parents[2]
MODULE = "bl_ext.user_default.spectral_tv"


@pytest.fixture(scope="session")
def extension_zip() -> Path:
    zips = sorted((ROOT / "dist").glob("spectral_tv-*.zip"))
    assert zips, "dist/ holds no extension; run: make extension"
    return zips[-1]


@pytest.fixture(scope="session", autouse=True)
def _installed(extension_zip):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.extensions.package_install_files(
        filepath=str(extension_zip), repo="user_default", enable_on_install=True
    )
    assert MODULE in bpy.context.preferences.addons
    yield
    bpy.ops.preferences.addon_disable(module=MODULE)


@pytest.fixture(autouse=True)
def _empty_scene():
    """Every test starts without objects and meshes."""
    yield
    if bpy.context.object is not None and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes, *bpy.data.curves])


@pytest.fixture
def monkey():
    """Suzanne, subdivided: quads and triangles, three components, open borders."""
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 2
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    return obj
