"""What a file gives comes in, goes out in its order with its digits, or is told."""

from __future__ import annotations

import re
import struct
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import empty, exportable, load, meshes, run, write_scene
from spectral_tv import notes
from spectral_tv.files import obj as objs
from spectral_tv.files import ply
from spectral_tv.files import ply_table as tables

pytestmark = pytest.mark.once

ALL_PASS = ["--gain", "all=1", "--bands", "1", "--steps", "2"]
ORDINARY = re.compile(r"\d+ %|: wrote |the filter changes nothing")
ORDERS = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def grid(side: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Vertices of a bumpy sheet, shuffled, and its triangles."""
    rng = np.random.default_rng(0)
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(float(side)), np.arange(float(side))))
    points = np.column_stack([x, y, np.sin(x) * np.cos(y)]) + rng.normal(0, 0.05, (side**2, 3))
    corner = np.arange(side**2).reshape(side, side)[:-1, :-1].ravel()
    lower = np.column_stack([corner, corner + 1, corner + side + 1])
    upper = np.column_stack([corner, corner + side + 1, corner + side])
    place = rng.permutation(side**2)
    shuffled = np.empty_like(points)
    shuffled[place] = points
    return shuffled, place[np.vstack([lower, upper])]


def write_ply(path: Path, points, faces, order="", kind="float", **columns) -> Path:
    """A PLY file with further columns of vertices, floats but for those of bytes."""
    letters = {"float": "f", "double": "d"}
    more = {name: np.asarray(values) for name, values in columns.items()}
    kinds = {name: "uchar" if more[name].dtype == np.uint8 else "float" for name in more}
    head = ["ply", f"format {ORDERS[order]} 1.0", f"element vertex {len(points)}"]
    head += [f"property {kind} {axis}" for axis in "xyz"]
    head += [f"property {kinds[name]} {name}" for name in more]
    head += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    text = "".join(f"{line}\n" for line in head).encode()
    rows = [
        (*map(float, point), *(values[place].item() for values in more.values()))
        for place, point in enumerate(points)
    ]
    if order:
        layout = (
            order
            + 3 * letters[kind]
            + "".join("B" if k == "uchar" else "f" for k in kinds.values())
        )
        body = b"".join(struct.pack(layout, *row) for row in rows)
        body += b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces)
    else:
        lines = [" ".join(map(repr, row)) for row in rows]
        lines += [" ".join(map(str, (len(face), *face))) for face in faces]
        body = "".join(f"{line}\n" for line in lines).encode()
    path.write_bytes(text + body)
    return path


def write_obj(path: Path, points, faces) -> Path:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(points, dtype=float).tolist()]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]
    path.write_text("\n".join([*lines, ""]))
    return path


def write_stl(path: Path, points, faces, is_text: bool) -> Path:
    corners = np.asarray(points, dtype=float)[np.asarray(faces)]
    if is_text:
        lines = ["solid sheet"]
        for triangle in corners.tolist():
            lines += ["facet normal 0 0 1", " outer loop"]
            lines += ["  vertex {!r} {!r} {!r}".format(*corner) for corner in triangle]
            lines += [" endloop", "endfacet"]
        path.write_text("\n".join([*lines, "endsolid sheet", ""]))
    else:
        rows = [struct.pack("<12fH", *[0] * 3, *triangle.ravel(), 0) for triangle in corners]
        path.write_bytes(bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows))
    return path


WRITERS = {
    "text.ply": write_ply,
    "little.ply": lambda path, *shape: write_ply(path, *shape, "<"),
    "double.ply": lambda path, *shape: write_ply(path, *shape, ">", "double"),
    "double_text.ply": lambda path, *shape: write_ply(path, *shape, "", "double"),
    "sheet.obj": write_obj,
    "text.stl": lambda path, *shape: write_stl(path, *shape, True),
    "binary.stl": lambda path, *shape: write_stl(path, *shape, False),
}  # fmt: skip

FLOATS = ("little.ply", "binary.stl")


def points_of(path: Path) -> np.ndarray:
    """The vertices of a .ply or .obj in their order, in double precision."""
    if path.suffix == ".ply":
        return ply.find_vertices(path, ply.read_header(path)).points()
    rows = re.findall(r"^v (\S+) (\S+) (\S+)", path.read_text(), re.MULTILINE)
    return np.array(rows).astype(float)


def told(path: Path, target: Path, capfd, *options: str, code: int = 0) -> str:
    capfd.readouterr()
    assert run(["decompose", str(path), "-o", str(target), *ALL_PASS, *options]) == code
    return capfd.readouterr().err


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *((name, value) for name in WRITERS for value in (np.nan, np.inf, -np.inf)),
        *((name, 1e39) for name in WRITERS if name not in FLOATS),
    ],
)
@pytest.mark.filterwarnings("error")
def test_a_vertex_that_is_nowhere_is_refused_or_left_out(tmp_path: Path, capfd, name, value):
    points, faces = grid()
    vertex = int(faces[0, 0])
    points[vertex, 1] = value
    source = WRITERS[name](tmp_path / name, points, faces.tolist())
    target = tmp_path / f"out{source.suffix}"
    error = told(source, target, capfd, code=1)
    assert "has a coordinate that is not finite" in error
    if source.suffix != ".stl":
        assert f"vertex {vertex} has" in error
    assert not target.exists()
    left_out = told(source, target, capfd, "--leave-out")
    assert re.search(r"dropped \d+ vert.* not finite, and \d+ triangles there", left_out), left_out
    if source.suffix != ".stl":
        ensure_whole(points_of(target), np.delete(points, vertex, axis=0))


def ensure_whole(found: np.ndarray, expected: np.ndarray) -> None:
    """What has a place in a file is all that is expected, and no more."""
    found = found[(np.abs(found) < 1e37).all(axis=1)]
    apart = np.linalg.norm(found[:, np.newaxis] - expected, axis=2)
    assert apart.min(axis=1).max() < 1e-5
    assert apart.min(axis=0).max() < 1e-5


@pytest.mark.parametrize("suffix", [".glb", ".gltf", ".fbx", ".usdc", ".abc"])
def test_a_vertex_that_is_nowhere_in_other_formats_is_refused_or_left_out(
    tmp_path: Path, capfd, suffix
):
    if suffix not in exportable():
        pytest.skip(f"this Blender is built without {suffix}")
    points, faces = grid()
    vertex = int(faces[0, 0])
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    points[vertex, 1] = -77.25 if suffix.startswith(".gl") else np.nan
    mesh.vertices.foreach_set("co", points.ravel())
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Sheet", mesh))
    source, target = write_scene(tmp_path / f"in{suffix}"), tmp_path / "out.ply"
    if suffix.startswith(".gl"):  # its exporter writes no such numbers
        data = source if suffix == ".glb" else source.with_suffix(".bin")
        mark, nan = (struct.pack("<f", number) for number in (77.25, np.nan))
        assert mark in data.read_bytes()
        data.write_bytes(data.read_bytes().replace(mark, nan))
    assert "has a coordinate that is not finite" in told(source, target, capfd, code=1)
    assert not target.exists()
    told(source, target, capfd, "--leave-out")
    ensure_whole(points_of(target), np.delete(points, vertex, axis=0))


@pytest.mark.parametrize("name", WRITERS)
def test_faces_that_blender_leaves_out_are_counted(tmp_path: Path, capfd, name):
    points, faces = grid()
    good = [face.tolist() for face in faces]
    broken = [good[3][:2] + good[3][:1], good[7][::-1]]  # a vertex twice, a face twice
    if not name.endswith("stl"):
        broken += [[*good[0][:2], 99], [*good[0][:2], -1], good[0][:2]]
    if name == "sheet.obj":
        broken[-2] = [*good[0][:2], -2]  # −1 would be the last vertex; this becomes f … −1
    source = WRITERS[name](tmp_path / name, points, good + broken)
    if name == "sheet.obj":
        text = source.read_text()
        source.write_text(text.replace(" -1\n", " 0\n"))
    error = told(source, tmp_path / f"out{source.suffix}", capfd)
    if source.suffix == ".ply":  # Blender 5.2 takes the first vertex for one that is not there
        corners = tables.read(tmp_path / "out.ply").faces.corners.reshape(-1, 3)
        assert {frozenset(face) for face in corners.tolist()} == {frozenset(face) for face in good}
    total = len(good) + len(broken)
    assert f"{len(broken)} of {total} faces were left out" in error
    assert f"1 has a vertex twice (the first is face {len(good)})" in error
    assert f"1 has the vertices of another face (the first is face {len(good) + 1})" in error
    if not name.endswith("stl"):
        assert f"2 refer to a vertex that is not there (the first is face {len(good) + 2}" in error
        assert f"1 has fewer than 3 corners (the first is face {len(good) + 4})" in error


@pytest.mark.parametrize("name", WRITERS)
def test_of_whole_files_nothing_is_told(tmp_path: Path, capfd, name):
    source = WRITERS[name](tmp_path / name, *grid())
    lines = told(source, tmp_path / f"out{source.suffix}", capfd).splitlines()
    assert [
        line for line in lines if line.startswith(str(source)) and not ORDINARY.search(line)
    ] == []


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_faces_of_gltf_that_blender_leaves_out_are_counted(tmp_path: Path, capfd, suffix):
    points, faces = grid()
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    mesh.shade_smooth()
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Sheet", mesh))
    source, target = write_scene(tmp_path / f"in{suffix}"), tmp_path / f"out{suffix}"
    assert "left out" not in told(source, target, capfd)
    data = source if suffix == ".glb" else source.with_suffix(".bin")
    content = data.read_bytes()
    corners = struct.pack("<3H", *faces[3])
    assert content.count(corners) == 1
    data.write_bytes(content.replace(corners, struct.pack("<3H", *faces[4])))
    assert "1 of 50 faces were left out" in told(source, target, capfd)


def test_an_obj_cut_in_a_face_is_told(tmp_path: Path, capfd):
    source = write_obj(tmp_path / "sheet.obj", *grid())
    source.write_text(source.read_text().rstrip("\n").rsplit(" ", 1)[0])
    error = told(source, tmp_path / "out.obj", capfd)
    assert "its last line has no end: it may have been cut short" in error
    assert "1 of 50 faces were left out" in error
    assert "1 has fewer than 3 corners" in error


def test_a_polygon_of_an_obj_that_blender_changes_is_told(tmp_path: Path, capfd):
    points, faces = grid()
    a, b, c = faces[0].tolist()
    source = write_obj(tmp_path / "sheet.obj", points, [[a, b, b, c], *faces[1:].tolist()])
    error = told(source, tmp_path / "out.obj", capfd)
    assert "faces were changed" in error
    assert "1 has a vertex twice" in error


@pytest.mark.parametrize("is_parted", [False, True])
def test_loose_vertices_of_an_obj_stay_in_their_places(tmp_path: Path, capfd, is_parted):
    points, faces = grid()
    loose = np.array([[9.0, 9, 9], [8, 8, 8]])
    points = np.vstack([loose[:1], points[:10], loose[1:], points[10:]])
    shift = 1 + np.arange(36) + (np.arange(36) >= 10)
    source, target = (
        write_obj(tmp_path / "a.obj", points, shift[faces].tolist()),
        tmp_path / "o.obj",
    )
    if is_parted:  # all vertices before the only object
        source.write_text(source.read_text().replace("f ", "o Sheet\nf ", 1))
    told(source, target, capfd)
    np.testing.assert_allclose(points_of(target), points, atol=1e-6)
    found = re.findall(r"^f (\d+)\S* (\d+)\S* (\d+)", target.read_text(), re.MULTILINE)
    assert sorted(map(tuple, np.array(found).astype(int) - 1)) == sorted(map(tuple, shift[faces]))
    assert target.read_text().count("o ") == 1


def test_objects_of_an_obj_stay_in_their_order(tmp_path: Path, capfd):
    points, faces = grid()
    source, target = tmp_path / "a.obj", tmp_path / "out.obj"
    lines = []
    for number, name in enumerate(("Zebra", "Apple", "Moon")):
        lines += [
            f"o {name}",
            *("v {!r} {!r} {!r}".format(*p) for p in (points + 9 * number).tolist()),
        ]
        lines += ["f {} {} {}".format(*(face + 1 + 36 * number)) for face in faces]
    source.write_text("\n".join([*lines, ""]))
    told(source, target, capfd)
    assert re.findall(r"^o (\S+)", target.read_text(), re.MULTILINE) == ["Zebra", "Apple", "Moon"]
    np.testing.assert_allclose(points_of(target), points_of(source), atol=1e-5)


@pytest.mark.parametrize("order", ORDERS)
def test_vertices_of_a_ply_with_uvs_stay_in_their_order(tmp_path: Path, capfd, order):
    points, faces = grid()
    rng = np.random.default_rng(1)
    normals = rng.normal(size=points.shape)
    normals[:, 2] = np.abs(normals[:, 2]) + 1
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    columns = dict(zip(("nx", "ny", "nz"), normals.T, strict=True))
    uvs = dict(zip("st", rng.random((2, len(points))), strict=True))
    colors = {n: rng.integers(0, 256, 36).astype(np.uint8) for n in ("red", "green", "blue")}
    extra = {"label": np.arange(36.0)}
    source = write_ply(
        tmp_path / "a.ply", points, faces.tolist(), order, **columns, **uvs, **colors, **extra
    )
    target = tmp_path / "out.ply"
    told(source, target, capfd)
    before, after = tables.read(source), tables.read(target)
    assert set(after.columns) == set(before.columns)  # no alpha
    assert after.header.format == before.header.format
    for name, values in before.columns.items():
        within = 1e-3 if name.startswith("n") else 1e-6  # Blender keeps directions in 16 bits
        np.testing.assert_allclose(after.columns[name], values, atol=within, err_msg=name)
    np.testing.assert_array_equal(after.faces.corners, before.faces.corners)


def test_vertices_of_a_blend_become_those_of_a_ply_in_order(tmp_path: Path, capfd):
    """Where UVs have seams vertices are doubled, behind all others; quads and edges stay."""
    empty()
    bpy.ops.mesh.primitive_cube_add(size=2)
    bpy.ops.mesh.primitive_uv_sphere_add(
        segments=8, ring_count=6, location=(3, 1, 0), rotation=(1, 2, 3)
    )
    mesh = bpy.context.object.data
    bpy.context.object.data.vertices.add(2)
    mesh.edges.add(1)
    mesh.edges[-1].vertices = (len(mesh.vertices) - 2, 5)
    mesh.update()
    bpy.context.view_layer.update()
    expected = np.array([obj.matrix_world @ v.co for obj in meshes() for v in obj.data.vertices])
    source, target = write_scene(tmp_path / "a.blend"), tmp_path / "out.ply"
    error = told(source, target, capfd, "--apart")
    found = points_of(target)
    assert f"{len(found) - len(expected)} vertices were doubled at the seams of UV maps" in error
    assert len(found) > len(expected)
    np.testing.assert_allclose(found[: len(expected)], expected, atol=1e-5)
    assert tables.read(target).edges.tolist() == [[len(expected) - 2, 8 + 5]]


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("offset", [0.0, 4_512_345.678])
def test_a_double_ply_that_is_not_changed_has_the_same_doubles(
    tmp_path: Path, capfd, order, offset
):
    points, faces = grid()
    points = 100 * points + offset
    source = write_ply(tmp_path / "a.ply", points, faces.tolist(), order, "double")
    target = tmp_path / "out.ply"
    told(source, target, capfd)
    assert ply.read_header(target).is_double
    np.testing.assert_array_equal(points_of(target), points_of(source))


def test_a_filtered_double_ply_differs_by_its_displacements(tmp_path: Path, capfd):
    points, faces = grid()
    source = write_ply(tmp_path / "a.ply", points, faces.tolist(), "<", "double")
    blend, target = tmp_path / "a.blend", tmp_path / "out.ply"
    choices = ["--gain", "all=0", "--bands", "1", "--steps", "4"]
    assert run(["decompose", str(source), "-o", str(blend), *choices]) == 0
    load(blend)
    (obj,) = meshes()
    basis, band = (
        np.array([point.co for point in key.data]) for key in obj.data.shape_keys.key_blocks[:2]
    )
    assert run(["decompose", str(source), "-o", str(target), *choices]) == 0
    np.testing.assert_allclose(points_of(target), points - (band - basis), atol=1e-6)


@pytest.mark.parametrize("order", ORDERS)
def test_floats_in_map_coordinates_are_filtered_without_steps(tmp_path: Path, capfd, order):
    """The result is in double precision, though the input is not."""
    points, faces = grid(8)
    points = (10 * points).round() / 2  # as floats have them there
    far = points + np.array([500_000.0, 4_512_345.0, 100.0])
    shapes = []
    for name, where in (("near.ply", points), ("far.ply", far)):
        source = write_ply(tmp_path / name, where, faces.tolist(), order)
        target = tmp_path / f"out_{name}"
        choices = ["--gain", "all=0", "--bands", "1", "--steps", "4"]
        assert run(["decompose", str(source), "-o", str(target), *choices]) == 0
        shapes.append(points_of(target))
    assert "its coordinates are far from 0" in capfd.readouterr().err
    assert ply.read_header(target).is_double
    assert np.abs(shapes[0] + (far - points) - shapes[1]).max() < 1e-4
    assert np.abs(shapes[0] - points).max() > 0.05


@pytest.mark.parametrize("suffix", [".stl", ".glb", ".blend"])
def test_formats_with_floats_alone_tell_of_coarse_steps(tmp_path: Path, capfd, suffix):
    points, faces = grid()
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata((points + 4_512_345).tolist(), [], faces.tolist())
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Sheet", mesh))
    source = write_scene(tmp_path / f"in{suffix}")
    error = told(source, tmp_path / f"out{suffix}", capfd)
    assert "so far from 0 that its coordinates are in steps of 0.5" in error


def test_obj_files_with_odd_lines_are_read_as_they_are(tmp_path: Path):
    """Indices from the end, lines that go on, corners with UVs, and what is no number."""
    source = tmp_path / "odd.obj"
    source.write_text(
        "v 0 0 0\n v 1 0 \\\n0 1 0.5 0\nv 1 1\nv 1 x 0\nvt 0 0\n"
        "f 1/1 2/1/1 3//1\nf -1 -2 \\\n -3\nf 1 2 99999999999999999999\nf 1 2 a\nf 4 0 5\nl 1 -1\n"
    )
    read = objs.read(source)
    np.testing.assert_array_equal(
        read.points, [[0, 0, 0], [1, 0, 0], [1, 1, np.nan], [1, np.nan, 0]]
    )
    assert read.faces.sizes.tolist() == [3, 3, 3, 3, 3]
    expected = [0, 1, 2, 3, 2, 1, 0, 1, -1, 0, 1, -1, 3, -1, -1]
    assert read.faces.corners.tolist() == expected
    assert read.loose.tolist() == []


def test_groups_of_an_obj_are_told(tmp_path: Path, capfd):
    source = write_obj(tmp_path / "a.obj", *grid())
    source.write_text(source.read_text().replace("f ", "g Left arm\nf ", 1))
    error = told(source, tmp_path / "out.obj", capfd)
    assert "left out, as they are not read: groups of faces (Left arm)" in error


def soup(gap: float) -> tuple[np.ndarray, list[list[int]]]:
    """The triangles of a sheet, each with corners of its own, moved by up to a gap."""
    points, faces = grid()
    corners = points[faces].reshape(-1, 3)
    corners += gap * np.random.default_rng(0).uniform(-1, 1, corners.shape)
    return corners, np.arange(len(corners)).reshape(-1, 3).tolist()


def test_advice_about_welding_is_that_of_the_option(tmp_path: Path, capfd):
    """What it advises joins the corners, so that nothing is advised then."""
    source = write_ply(tmp_path / "soup.ply", *soup(1e-3), "<")
    error = told(source, tmp_path / "out.ply", capfd, "--weld", "0")
    found = re.search(r"drift apart; pass --weld (\S+)\n", error)
    assert found, error
    again = told(source, tmp_path / "out.ply", capfd, "--weld", found[1])
    assert "--weld" not in again
    assert "drift apart" not in again


def test_advice_about_welding_in_blender_names_the_property(tmp_path: Path):
    surface = import_module("bl_ext.user_default.spectral_tv.scene.surface")
    load(write_ply(tmp_path / "soup.ply", *soup(1e-3), "<"))
    with notes.gathered() as found:
        surface.Surface.read(meshes()[0], reading=surface.Reading(0, False))
    assert re.search(r"set Join Within to [\d.]+ %$", found[-1]), found


@pytest.mark.parametrize("suffix", [".ply", ".obj"])
def test_an_object_far_away_is_written_with_all_digits_of_its_mesh(tmp_path: Path, capfd, suffix):
    points, faces = grid()
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new("Sheet", mesh)
    obj.location = (500_000, 4_512_345, 100)
    bpy.context.scene.collection.objects.link(obj)
    source, target = write_scene(tmp_path / "in.blend"), tmp_path / f"out{suffix}"
    told(source, target, capfd)
    expected = points + np.array([500_000, 4_512_345, 100])
    found = points_of(target)
    if suffix == ".obj":
        found = found[:, [0, 2, 1]] * (1, -1, 1)
    assert np.abs(found - expected).max() < 1e-5
