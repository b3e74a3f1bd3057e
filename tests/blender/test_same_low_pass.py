"""One scan has one low-pass, whatever file or arrays it is handed in as."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
import spectral_tv
from command_line_files import QUICK, empty, exportable, load, meshes, run, write_scene
from shapes import bumpy_sphere

BANDS, STEPS = 3, 8


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


@pytest.fixture(scope="module")
def scan() -> tuple[np.ndarray, np.ndarray]:
    """Vertices as float32 holds them, and triangles, of an open surface."""
    vertices, triangles = bumpy_sphere(4)
    vertices = vertices.astype(np.float32).astype(float)
    return vertices, triangles[vertices[triangles].mean(axis=1)[:, 2] < 0.8]


@pytest.fixture(scope="module")
def expected(scan) -> np.ndarray:
    """Its low-pass without the two finest of three bands, (V, 3)."""
    return low_pass(spectral_tv.Mesh(*scan))


def low_pass(mesh: spectral_tv.Mesh) -> np.ndarray:
    split = spectral_tv.decompose(mesh, "m1", steps=STEPS)
    return mesh.vertices - split.bands(split.band_edges(BANDS))[:2].sum(axis=0)


def add(vertices: np.ndarray, triangles: np.ndarray, name: str) -> None:
    used, local = np.unique(triangles, return_inverse=True)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices[used].tolist(), [], local.reshape(-1, 3).tolist())
    bpy.context.collection.objects.link(bpy.data.objects.new(name, mesh))


def by_blender(path: Path, scan, pieces: int = 1) -> Path:
    """As Blender exports it, in so many objects."""
    empty()
    vertices, triangles = scan
    height = vertices[triangles].mean(axis=1)[:, 2].argsort().argsort()
    for piece in range(pieces):
        chosen = height * pieces // len(triangles) == piece
        add(vertices, triangles[chosen], f"Piece {piece}")
    return write_scene(path)


def ascii_stl(path: Path, scan) -> Path:
    """With six digits, every corner rounded by itself."""
    vertices, triangles = scan
    lines = ["solid scan"]
    for triangle in triangles:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex {:.6g} {:.6g} {:.6g}".format(*vertices[corner]) for corner in triangle]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid scan\n"]), encoding="ascii")
    return path


def wobbling_stl(path: Path, scan) -> Path:
    """A binary one whose corners differ in their last digits, as after a transformation."""
    vertices, triangles = scan
    rng = np.random.default_rng(1)
    facets = np.zeros(
        len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("end", "<u2")]
    )
    wobble = 1 + 1e-7 * rng.uniform(-2, 2, (len(triangles), 3, 3))
    facets["corners"] = vertices[triangles] * wobble
    header = bytes(80) + np.uint32(len(triangles)).tobytes()
    path.write_bytes(header + facets.tobytes())
    return path


FILES = {
    "ply": lambda folder, scan: by_blender(folder / "scan.ply", scan),
    "stl": lambda folder, scan: by_blender(folder / "scan.stl", scan),
    "stl, ascii": lambda folder, scan: ascii_stl(folder / "scan.stl", scan),
    "stl, last digits": lambda folder, scan: wobbling_stl(folder / "scan.stl", scan),
    "obj": lambda folder, scan: by_blender(folder / "scan.obj", scan),
    "obj, two objects": lambda folder, scan: by_blender(folder / "scan.obj", scan, 2),
    "obj, many objects": lambda folder, scan: by_blender(folder / "scan.obj", scan, 9),
    "glb": lambda folder, scan: by_blender(folder / "scan.glb", scan),
    "fbx": lambda folder, scan: by_blender(folder / "scan.fbx", scan),
    "usdc": lambda folder, scan: by_blender(folder / "scan.usdc", scan),
}
if ".usdc" not in exportable():  # as Debian builds Blender
    del FILES["usdc"]


@pytest.mark.parametrize("kind", FILES)
def test_of_files(tmp_path: Path, scan, expected, kind):
    target = tmp_path / "out.blend"
    source = FILES[kind](tmp_path, scan)
    gains = ["--gain", "1=0", "--gain", "2=0"]
    plain = ["--keep-limbs", "0", "--soft-edges", "0"]
    assert run(["decompose", str(source), "-o", str(target), *QUICK, *gains, *plain]) == 0
    load(target)
    vertices, _ = scan
    graph = bpy.context.evaluated_depsgraph_get()
    seen = np.zeros(len(vertices), dtype=bool)
    for obj in meshes():
        world = np.array(obj.matrix_world)
        before, after = (
            np.array([point.co for point in data]) @ world[:3, :3].T + world[:3, 3]
            for data in (
                obj.data.shape_keys.reference_key.data,
                obj.evaluated_get(graph).data.vertices,
            )
        )
        away = np.linalg.norm(before[:, None] - vertices, axis=2)
        places = away.argmin(axis=1)
        assert away.min(axis=1).max() < 1e-5
        seen[places] = True
        size = np.linalg.norm(np.ptp(vertices, axis=0))
        np.testing.assert_allclose(after, expected[places], atol=1e-5 * size)
    used = np.unique(scan[1])
    assert seen[used].all()


def test_of_arrays_that_are_not_joined(scan, expected):
    vertices, triangles = scan
    soup = vertices[triangles].reshape(-1, 3)
    corners = np.arange(len(soup)).reshape(-1, 3)
    mesh = spectral_tv.Mesh(soup, corners, weld=0.0)
    np.testing.assert_allclose(
        low_pass(mesh)[mesh.weld_map], expected[triangles].reshape(-1, 3), atol=1e-9
    )
