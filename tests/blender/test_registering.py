"""The extension comes and goes as a whole, however often."""

from __future__ import annotations

import bpy
from ball import bumpy_ball
from conftest import MODULE
from deform_scene import evaluated

NAME = "spectral_tv"


def present() -> set[str]:
    """What Blender has of the extension: classes, properties, operators, and who listens."""
    found = {name for name in dir(bpy.types) if NAME in name.lower()}
    owners = (getattr(bpy.types, name) for name in dir(bpy.types))
    for owner in owners:
        properties = owner.bl_rna.properties.keys() if hasattr(owner, "bl_rna") else ()
        found |= {f"{owner.__name__}.{name}" for name in properties if name.startswith(NAME)}
    found |= {f"bpy.ops.{name}" for name in dir(getattr(bpy.ops, NAME))}
    for name in dir(bpy.app.handlers):
        handlers = getattr(bpy.app.handlers, name)
        for handler in handlers if isinstance(handlers, list) else ():
            if getattr(handler, "__module__", "").startswith(MODULE):
                found.add(f"{name}: {handler.__name__} {handlers.count(handler)}")
    return found


def test_it_leaves_nothing_behind_and_comes_back_the_same():
    obj = bumpy_ball()
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    bpy.ops.spectral_tv.filter(preset="EXAGGERATE", first=2, last=3)
    before, look = present(), evaluated(obj)
    assert len(before) > 100
    for _ in range(2):
        bpy.ops.preferences.addon_disable(module=MODULE)
        assert not present()
        assert (evaluated(obj) == look).all()
        bpy.ops.preferences.addon_enable(module=MODULE)
        assert present() == before
    bpy.ops.spectral_tv.filter(preset="RESET")
    assert (evaluated(obj) != look).any()
