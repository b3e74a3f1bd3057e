"""How fast Live follows a handle in Blender: ``python -m tools.bench.live [MESH…]``.

Each update has all that a window has but for drawing: the handle's place, a step of the solver, the
shape key and Blender's evaluation of the mesh. Without meshes of one's own it takes two generated
ones. Needs pip's ``bpy``, and the extension that ``make extension`` built.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from importlib import import_module
from pathlib import Path

import numpy as np

from .meshes import Shape, pinched_sphere

_RESOURCES = tempfile.TemporaryDirectory(prefix="spectral_tv_live_")
os.environ["BLENDER_USER_RESOURCES"] = _RESOURCES.name  # bpy reads it on import

import bpy  # noqa: E402

MODULE = "bl_ext.user_default.spectral_tv"
DIST = Path(__file__).resolve().parents[2] / "dist"
FRAMES, DEGREES = 30, 60
MOST_ROUGH = 100


def main() -> None:
    """Print a row for each mesh and algorithm."""
    (built,) = DIST.glob("spectral_tv-*.zip")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.extensions.package_install_files(
        filepath=str(built), repo="user_default", enable_on_install=True
    )
    paths = [Path(each) for each in sys.argv[1:]]
    shapes = [(path.stem, _read(path)) for path in paths]
    if not shapes:
        shapes = [(f"pinched sphere {n}", pinched_sphere(n)) for n in (26, 66)]
    print("mesh | vertices | algorithm | updates a second | slowest, ms | read, ms | "
          "lag at release, % | updates until settled | settling, s")  # fmt: skip
    for name, shape in shapes:
        for algorithm in ("POSE", "CONVEX"):
            print(" | ".join([name, str(len(shape[0])), algorithm, *_measure(shape, algorithm)]))
            bpy.ops.wm.read_homefile(use_empty=True)


def _measure(shape: Shape, algorithm: str) -> list[str]:
    """Take the upper end on an arc about the middle, then let it rest."""
    vertices, faces = shape
    obj = _object(vertices, faces)
    axis = int(np.ptp(vertices, axis=0).argmax())
    along = vertices[:, axis]
    low, high = np.quantile(along, [0.05, 0.93])
    constraints, empty = obj.spectral_tv.constraints, bpy.data.objects.new("Handle", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.location = start = vertices[along > high].mean(axis=0)
    bpy.context.view_layer.update()
    for name, is_in in (("Feet", along < low), ("Head", along > high)):
        obj.vertex_groups.new(name=name).add(np.flatnonzero(is_in).tolist(), 1.0, "REPLACE")
        constraints.add().vertex_group = name
    constraints[1].kind, constraints[1].target = "OBJECT", empty
    obj.spectral_tv.algorithm = algorithm
    began = time.perf_counter()
    live = import_module(f"{MODULE}.deformation.live").LiveDeformation(obj)
    live.update()
    while live.preparation is not None:
        live.update()
    reading = time.perf_counter() - began
    centre = vertices.mean(axis=0)
    arm, side = start - centre, np.roll(np.eye(3), 1, axis=0)[axis]
    side = side * np.linalg.norm(arm)
    times = []
    for frame in range(1, FRAMES + 1):
        angle = np.radians(DEGREES * frame / FRAMES)
        began = time.perf_counter()
        empty.location = centre + np.cos(angle) * arm + np.sin(angle) * side
        bpy.context.view_layer.update()
        live.update()
        _evaluate(obj)
        times.append(time.perf_counter() - began)
    released = _evaluate(obj)
    began = time.perf_counter()
    rough = 0
    while live._rough and rough < MOST_ROUGH:
        live.update()
        rough += 1
    while not live.is_settled:
        live.update()
        time.sleep(0.005)
    settling = time.perf_counter() - began
    lag = np.linalg.norm(_evaluate(obj) - released, axis=1).max()
    lag /= np.linalg.norm(np.ptp(vertices, axis=0))
    live.stop()
    return [
        f"{1 / np.mean(times):.1f}", f"{1e3 * max(times):.0f}", f"{1e3 * reading:.0f}",
        f"{100 * lag:.2f}", str(rough), f"{settling:.2f}",
    ]  # fmt: skip


def _object(vertices: np.ndarray, faces: np.ndarray) -> bpy.types.Object:
    data = bpy.data.meshes.new("Mesh")
    data.from_pydata(vertices.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new("Mesh", data)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    return obj


def _evaluate(obj: bpy.types.Object) -> np.ndarray:
    """What Blender shows, (V, 3)."""
    bpy.context.view_layer.update()
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flat = np.empty(3 * len(shape.vertices), dtype=np.float32)
    shape.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


def _read(path: Path) -> Shape:
    bpy.ops.wm.read_homefile(use_empty=True)
    getattr(bpy.ops.wm, f"{path.suffix[1:].lower()}_import")(filepath=str(path))
    data = bpy.context.object.data
    data.calc_loop_triangles()
    vertices = np.array([vertex.co for vertex in data.vertices], dtype=float)
    return vertices, np.array([list(each.vertices) for each in data.loop_triangles])


if __name__ == "__main__":
    main()
