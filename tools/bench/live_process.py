"""One mesh that *Live* keeps up to date in Blender, in a process of its own.

Each update has all that a window has but for drawing: the handle's place, a step of the solver, the
shape key and Blender's evaluation of the mesh. Needs pip's ``bpy``, and the extension that ``make
extension`` built.
"""

from __future__ import annotations

import json
import sys
import time
from importlib import import_module

import numpy as np

from .in_blender import MODULE, add_object, bpy, install
from .process import peak_memory
from .turn import Turn

POLL = 1 / 120


def main() -> None:
    """Print what is measured with the mesh, the algorithm and the frames of the command line."""
    path, algorithm, frames = sys.argv[1:]
    install()
    data = np.load(path)
    turn = Turn("Mesh", data["vertices"], data["triangles"], is_free=True)
    print(json.dumps(measured(turn, algorithm, int(frames))))


def measured(turn: Turn, algorithm: str, frames: int) -> dict[str, float]:
    """Take the handle on its way, then let it rest."""
    obj = add_object(turn.vertices, turn.triangles)
    constraints, empty = obj.spectral_tv.constraints, bpy.data.objects.new("Handle", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.location = _place(turn, 0.0)
    bpy.context.view_layer.update()
    for name, is_in in (("Held", ~turn.is_handle), ("Handle", turn.is_handle)):
        members = turn.indices[is_in].tolist()
        obj.vertex_groups.new(name=name).add(members, 1.0, "REPLACE")
        constraints.add().vertex_group = name
    constraints[1].kind, constraints[1].target = "OBJECT", empty
    obj.spectral_tv.algorithm = algorithm
    before = peak_memory()
    began = time.perf_counter()
    live = import_module(f"{MODULE}.deformation.live").LiveDeformation(obj)
    live.update()
    while live.preparation is not None:
        live.update()
    reading = time.perf_counter() - began
    times = []
    for frame in range(1, frames + 1):
        empty.location = _place(turn, frame / frames)
        bpy.context.view_layer.update()
        if frame == 1:
            live.update()
            continue  # the hand goes on meanwhile
        began = time.perf_counter()
        _wait(live)
        _evaluate(obj)
        times.append(time.perf_counter() - began)
    _wait(live)  # for the answer to the last place
    released = _evaluate(obj)
    began = time.perf_counter()
    rough = 0
    while live._rough:
        _wait(live)
        rough += 1
    while not live.is_settled:
        _wait(live)
    settling = time.perf_counter() - began
    most = peak_memory()
    lag = turn.distance(_evaluate(obj), released)
    live.stop()
    return {
        "reading": reading, "mean": float(np.mean(times)), "slowest": max(times), "lag": lag,
        "rough": rough, "settling": settling, "before": before, "most": most,
    }  # fmt: skip


def _wait(live) -> None:
    """Let it look as often as its operator does until the shape changes."""
    while not live.update():
        time.sleep(POLL)


def _place(turn: Turn, part: float) -> np.ndarray:
    """Where the middle of the handle is after a part of the turn."""
    return turn.targets(part)[turn.is_handle].mean(axis=0)


def _evaluate(obj: bpy.types.Object) -> np.ndarray:
    """What Blender shows, (V, 3)."""
    bpy.context.view_layer.update()
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flat = np.empty(3 * len(shape.vertices), dtype=np.float32)
    shape.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


if __name__ == "__main__":
    main()
