"""One mesh with bands whose sliders are moved in Blender, in a process of its own.

Each move has all that a window has but for drawing: the value, Blender's evaluation of the mesh,
what the extension listens to, and its panels. These draw into a layout that takes nothing in.
"""

from __future__ import annotations

import inspect
import json
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))  # the program runs this file alone

from tools.bench.in_blender import MODULE, add_object, bpy, install
from tools.bench.timing import interleaved

RUNS = 9


def main() -> None:
    """Print what is measured; the command line has a mesh, the number of bands, and their kind."""
    path, count, kind = sys.argv[sys.argv.index("--") + 1 :]
    install()
    data = np.load(path)
    obj = add_object(data["vertices"], data["triangles"])
    bpy.ops.spectral_tv.decompose(bands=int(count), steps=2 * int(count), bands_as=kind)
    import_module(f"{MODULE}.bands.live_guard").count(obj)  # so that it watches
    bands = import_module(f"{MODULE}.scene.records").bands_of(obj)
    for acting in (1, len(bands)):
        for band in bands[:acting]:
            band.value = 0.5
        print(
            json.dumps(
                {"version": bpy.app.version_string, "acting": acting, **measured(obj, bands[0])}
            )
        )


def measured(obj: bpy.types.Object, band: Any) -> dict[str, float]:
    """Median seconds from a value of a band until the mesh is evaluated: by Blender alone,
    with the extension, and with Blender's normals of faces or of vertices."""
    panels = _open_panels()

    def move() -> None:
        band.value = 0.25 if band.value > 0.5 else 0.75
        bpy.context.view_layer.update()

    def alone(read: Callable[[bpy.types.Mesh], object] = lambda _mesh: None) -> float:
        with _nobody_listens():
            began = time.perf_counter()
            move()
            read(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data)
            return time.perf_counter() - began

    def together() -> None:
        move()
        for panel in panels:
            _draw(panel)

    together()  # what is kept is kept now
    names = ("alone", "with", "faces", "vertices")
    works = (
        alone, together,
        lambda: alone(lambda mesh: mesh.polygon_normals[0].vector[:]),
        lambda: alone(lambda mesh: mesh.vertex_normals[0].vector[:]),
    )  # fmt: skip
    return dict(zip(names, interleaved(*works, runs=RUNS), strict=True))


@contextmanager
def _nobody_listens() -> Iterator[None]:
    """Have Blender call nothing of the extension for a while."""
    lists = [each for each in vars_of(bpy.app.handlers) if isinstance(each, list)]
    before = [list(each) for each in lists]
    for each in lists:
        each[:] = [handler for handler in each if not handler.__module__.startswith(MODULE)]
    try:
        yield
    finally:
        for each, handlers in zip(lists, before, strict=True):
            each[:] = handlers


def vars_of(group: object) -> list[object]:
    """The values of its attributes."""
    return [getattr(group, name) for name in dir(group)]


def _open_panels() -> list[type[bpy.types.Panel]]:
    """Those of the 3D view that are open at first, and there for the active object."""
    return [
        panel
        for panel in bpy.types.Panel.__subclasses__()
        if panel.__module__.startswith(MODULE)
        and panel.bl_space_type == "VIEW_3D"
        and "DEFAULT_CLOSED" not in getattr(panel, "bl_options", ())
        and (not hasattr(panel, "poll") or panel.poll(bpy.context))
    ]


def _draw(panel: type[bpy.types.Panel]) -> None:
    # Without a window there is no scale.
    system, region = SimpleNamespace(ui_scale=1.0), SimpleNamespace(width=300)
    preferences = _With(bpy.context.preferences, system=system)
    _Drawn(panel).draw(_With(bpy.context, region=region, preferences=preferences))


class _With:
    """Something with a few other attributes."""

    def __init__(self, base: object, **others: object) -> None:
        self.__dict__.update(others, base=base)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.base, name)


class _Drawn:
    """A panel as Blender would make one; its class makes none by itself."""

    def __init__(self, panel: type[bpy.types.Panel]) -> None:
        self.panel, self.layout = panel, _Nowhere()

    def __getattr__(self, name: str) -> Any:
        found = inspect.getattr_static(self.panel, name)
        return found.__get__(self, self.panel) if hasattr(found, "__get__") else found


class _Nowhere:
    """A layout that takes nothing in."""

    def __getattr__(self, _name: str) -> Callable[..., _Nowhere]:
        return lambda *_arguments, **_options: self


if __name__ == "__main__":
    main()
