"""Enabling the extension reads what Blender shows, and not what operators work with."""

from __future__ import annotations

import sys
from importlib import import_module
from operator import attrgetter

from conftest import MODULE, built_zip

# What is not read before something is computed.
WORK = [
    "bands.adding",
    "bands.converting",
    "bands.corresponding",
    "bands.frame_shapes",
    "bands.point_cache",
    "bands.recut",
    "bands.verb",
    "recipes.making",
    "recipes.verb",
    "maps.baking",
    "maps.surfaces",
    "maps.verb",
    "deformation.deform",
    "deformation.live",
    "deformation.armature",
    "deformation.verb",
    "attributes.flows",
    "attributes.sources",
    "images.results",
    "images.verb",
    "segmentation.parts",
    "command_line.load",
    "command_line.save",
]
PACKAGE = [
    "_functions",
    "_results",
    "_work",
    "batches",
    "cli",
    "command_line.program",
    "deformation.solvers",
    "files.whole",
    "options.arguments",
]
SCRIPT = """
numpy = {{name: sys.modules.pop(name) for name in [*sys.modules] if name.startswith("numpy")}}
install({zip!r})
print("read:", [name for name in ["numpy", *{names!r}] if name in sys.modules])
sys.modules.update(numpy)
bpy.ops.mesh.primitive_monkey_add()
bpy.ops.spectral_tv.decompose(bands=2, steps=4)
print("keys:", len(bpy.context.object.data.shape_keys.key_blocks), {names[0]!r} in sys.modules)
"""


def test_what_only_work_needs_is_read_at_work(session):
    names = [f"{MODULE}.{name}" for name in WORK] + [f"spectral_tv.{name}" for name in PACKAGE]
    output = session(SCRIPT.format(zip=str(built_zip()), names=names))
    assert "read: []\n" in output
    assert "keys: 3 True\n" in output


def test_all_that_the_features_name_is_there():
    registration = sys.modules[f"{MODULE}.registration"]
    for table in ("START", "LOADED", "FORGET", "WITHDRAW"):
        found = [*registration._named(table)]
        assert found
        for module, function in found:
            assert callable(attrgetter(function)(import_module(module)))
