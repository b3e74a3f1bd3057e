"""Coordinates keep their digits, files their kind, units and axes."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import empty, exportable, load, meshes, run, write_scene
from spectral_tv.files import fbx, ply, usd

ALL_PASS = ["--gain", "all=1", "--bands", "1", "--steps", "2"]
MAP = np.array([5_000_000.0, 4_000_000.0, 300.0])


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def terrain(offset: np.ndarray = MAP) -> tuple[np.ndarray, np.ndarray]:
    """Vertices of a bumpy terrain, 200 wide, to a tenth of a millimetre; its triangles."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(12.0), np.arange(12.0)))
    noise = np.random.default_rng(0).normal(0, 0.5, (144, 3))
    points = np.column_stack([18.181 * x, 18.181 * y, 5 * np.sin(x) * np.cos(y)]) + noise
    corner = np.arange(144).reshape(12, 12)[:-1, :-1].ravel()
    lower = np.column_stack([corner, corner + 1, corner + 13])
    upper = np.column_stack([corner, corner + 13, corner + 12])
    return (points + offset).round(4), np.vstack([lower, upper])


def write_ply(path: Path, order: str, kind: str = "double", offset: np.ndarray = MAP) -> Path:
    """A PLY with colors, a label and a comment, in an order of bytes, or as text."""
    points, faces = terrain(offset)
    names = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}
    kinds = [f"property {kind} {axis}\n" for axis in "xyz"]
    colors = [f"property uchar {name}\n" for name in ("red", "green", "blue")]
    head = [
        f"ply\nformat {names[order]} 1.0\ncomment TextureFile hill.png\n",
        f"element vertex {len(points)}\n", *kinds, *colors, "property int label\n",
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\n",
        "property float quality\nend_header\n",
    ]  # fmt: skip
    rows = [(*point, i, 208, 255 - i, i) for i, point in enumerate(points.tolist())]
    if order:
        size = {"double": "d", "float": "f"}[kind]
        body = b"".join(struct.pack(f"{order}3{size}BBBi", *row) for row in rows)
        body += b"".join(struct.pack(f"{order}B3if", 3, *face, 0.5) for face in faces)
    else:
        lines = [" ".join(map(repr, row)) for row in rows]
        lines += [f"3 {' '.join(map(str, face))} 0.5" for face in faces.tolist()]
        body = "".join(f"{line}\n" for line in lines).encode()
    path.write_bytes("".join(head).encode() + body)
    return path


def write_obj(path: Path, offset: np.ndarray = MAP) -> Path:
    """Two objects, Z up as it stands, the second with a texture."""
    points, faces = terrain(offset)
    texture = path.parent / "hill.png"
    image = bpy.data.images.new("Hill", 4, 4)
    image.filepath_raw, image.file_format = str(texture), "PNG"
    image.save()
    (path.parent / "hill.mtl").write_text("newmtl Hill\nKd 1 1 1\nmap_Kd hill.png\n")
    lines = ["mtllib hill.mtl"]
    for number in range(2):
        lines += [f"o Part{number}"]
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
        lines += ["vt 0 0", "vt 1 0", "vt 0 1", "usemtl Hill"]
        first = 1 + number * len(points)
        lines += [f"f {a + first}/1 {b + first}/2 {c + first}/3" for a, b, c in faces.tolist()]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_stl(path: Path, offset: np.ndarray = MAP) -> Path:
    points, faces = terrain(offset)
    lines = ["solid hill"]
    for face in faces:
        lines += ["facet normal 0 0 1", " outer loop"]
        lines += [f"  vertex {x!r} {y!r} {z!r}" for x, y, z in points[face].tolist()]
        lines += [" endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid hill", ""]))
    return path


def points_of(path: Path) -> np.ndarray:
    """The coordinates in a file, with all their digits, in order."""
    if path.suffix == ".ply":
        found = ply.find_vertices(path, ply.read_header(path)).points()
    else:
        word = {".obj": "v", ".stl": "vertex"}[path.suffix]
        rows = re.findall(rf"^\s*{word} (\S+) (\S+) (\S+)", path.read_text(), re.MULTILINE)
        found = np.array(rows).astype(float)
    return np.unique(found.round(5), axis=0)


def off(one: np.ndarray, other: np.ndarray) -> float:
    """How far points of either are from the nearest of the other."""
    apart = np.linalg.norm(one[:, np.newaxis] - other, axis=2)
    return float(max(apart.min(axis=0).max(), apart.min(axis=1).max()))


SCANS = {
    "little.ply": lambda path: write_ply(path, "<"),
    "big.ply": lambda path: write_ply(path, ">"),
    "text.ply": lambda path: write_ply(path, ""),
    "hill.obj": write_obj,
    "text.stl": write_stl,
}


@pytest.mark.parametrize("name", SCANS)
def test_a_scan_in_map_coordinates_keeps_its_digits(tmp_path: Path, capfd, name):
    source = SCANS[name](tmp_path / name)
    target = tmp_path / f"out{source.suffix}"
    assert run(["decompose", str(source), "-o", str(target), *ALL_PASS]) == 0
    assert "worked on relative to (5000100, 4000100, 300)" in capfd.readouterr().err
    assert off(points_of(source), points_of(target)) < 2e-5
    is_text = b"\0" not in source.read_bytes()
    assert (b"\0" not in target.read_bytes()) == is_text


def test_the_digits_outlive_a_blend_and_other_formats(tmp_path: Path, capfd):
    source = write_ply(tmp_path / "scan.ply", "<")
    expected = points_of(source)
    blend, glb = tmp_path / "scan.blend", tmp_path / "scan.glb"
    assert run(["decompose", str(source), "-o", str(blend), *ALL_PASS]) == 0
    for suffix in (".ply", ".obj"):
        target = tmp_path / f"again{suffix}"
        assert run(["decompose", str(blend), "-o", str(target), *ALL_PASS]) == 0
        turned = expected if suffix == ".ply" else expected[:, [0, 2, 1]] * (1, 1, -1)
        assert off(turned, points_of(target)) < 2e-5
    capfd.readouterr()
    assert run(["decompose", str(source), "-o", str(glb), *ALL_PASS]) == 0
    assert "a .glb stays relative to (5000100, 4000100, 300)" in capfd.readouterr().err
    load(glb)
    (obj,) = meshes()
    local = np.array([obj.matrix_world @ vertex.co for vertex in obj.data.vertices])
    assert off(expected, local + np.array([5000100, 4000100, 300])) < 2e-5


def test_the_texture_of_a_far_obj_is_found(tmp_path: Path):
    source = write_obj(tmp_path / "hill.obj")
    load(source)
    (image,) = (image for image in bpy.data.images if image.source == "FILE")
    assert image.size[:] == (4, 4)


def test_filtered_relative_to_a_point_is_filtered_alike(tmp_path: Path):
    """The same low-pass, near 0 and far from it."""
    near, far = (
        write_ply(tmp_path / f"{n}.ply", "<", offset=m) for n, m in (("a", 0 * MAP), ("b", MAP))
    )
    shapes = []
    for source in (near, far):
        target = source.with_stem(f"{source.stem}_out")
        assert run(["decompose", str(source), "-o", str(target), "--gain", "all=0"]) == 0
        shapes.append(points_of(target))
    assert off(shapes[0] + MAP, shapes[1]) < 1e-4
    assert off(shapes[0], points_of(near)) > 0.1


@pytest.mark.parametrize("kind", ["float", "double"])
@pytest.mark.parametrize("order", ["<", ">", ""])
def test_a_ply_keeps_its_kind_its_colors_and_its_comments(tmp_path: Path, capfd, order, kind):
    source = write_ply(tmp_path / "scan.ply", order, kind, offset=0 * MAP)
    target = tmp_path / "out.ply"
    assert run(["decompose", str(source), "-o", str(target), *ALL_PASS]) == 0
    told = capfd.readouterr().err
    assert "left out, as Blender does not read them: quality of faces" in told
    header = ply.read_header(target)
    assert (header.order == "") == (order == "")
    assert header.is_double == (kind == "double")
    assert b"comment TextureFile hill.png" in header.comments
    assert off(points_of(source), points_of(target)) < 1e-4
    assert colors_and_labels(target) == colors_and_labels(source)


def colors_and_labels(path: Path) -> list[tuple[int, ...]]:
    header = ply.read_header(path)
    vertices = ply.find_vertices(path, header)
    data = path.read_bytes()[vertices.begin : vertices.end]
    names = ["red", "green", "blue", "label"]
    if header.order:
        rows = np.frombuffer(data, vertices.element.row(header.order))
        return sorted(tuple(int(row[name]) for name in names) for row in rows)
    columns = vertices.columns()
    return sorted(zip(*(columns[name].astype(int).tolist() for name in names), strict=True))


def test_an_obj_has_all_digits_of_a_float(tmp_path: Path):
    source, target = tmp_path / "small.obj", tmp_path / "out.obj"
    rng = np.random.default_rng(0)
    points = (1e-3 * rng.random((3, 3))).astype(np.float32)
    rows = [" ".join(str(number) for number in point) for point in points]
    lines = ["o Small", *(f"v {row}" for row in rows), "f 1 2 3"]
    source.write_text("\n".join(lines) + "\n")
    assert run(["decompose", str(source), "-o", str(target), *ALL_PASS]) == 0
    found = re.findall(r"^v (\S+) (\S+) (\S+)", target.read_text(), re.MULTILINE)
    assert [" ".join(row) for row in found] == rows


def test_objects_of_an_obj_stay_apart_and_where_they_are(tmp_path: Path):
    source, target = write_obj(tmp_path / "hill.obj", 0 * MAP), tmp_path / "out.obj"
    text = source.read_text().replace("o Part1", "o Part 1")
    source.write_text(text)
    assert run(["decompose", str(source), "-o", str(target), "--apart", *ALL_PASS]) == 0
    lines = target.read_text().splitlines()
    assert {line for line in lines if line.startswith("o ")} == {"o Part0", "o Part_1"}
    assert sum(line.startswith("v ") for line in lines) == 288
    assert off(points_of(source), points_of(target)) < 2e-5
    materials = target.with_suffix(".mtl").read_text()
    assert "mtllib out.mtl" in lines
    assert "map_Kd hill.png" in materials


@pytest.mark.parametrize("is_text", [False, True])
def test_an_stl_of_either_kind_is_read_right_and_stays_one(tmp_path: Path, capfd, is_text):
    points, faces = terrain(0 * MAP)
    source, target = tmp_path / "hill.stl", tmp_path / "out.stl"
    if is_text:
        write_stl(source, 0 * MAP)
    else:
        rows = [struct.pack("<12fH", *[0] * 3, *points[face].ravel(), 0) for face in faces]
        body = b"".join(rows) + b"trailing"
        source.write_bytes(b"solid, but not text".ljust(80) + struct.pack("<I", len(rows)) + body)
    assert run(["decompose", str(source), "-o", str(target), *ALL_PASS]) == 0
    told = capfd.readouterr().err
    assert ("8 bytes after its last triangle were passed over" in told) == (not is_text)
    assert target.read_bytes().startswith(b"solid") == is_text
    load(target)
    (obj,) = meshes()
    found = np.array([vertex.co for vertex in obj.data.vertices])
    assert off(points, found) < 1e-4
    assert len(obj.data.polygons) == len(faces)


@pytest.mark.parametrize(
    "name", ["cut.ply", "cut.stl", "cut.glb", "cut.abc", "cut.usdc", "empty.obj", "empty.stl"]
)
def test_inputs_that_are_cut_short_are_refused(tmp_path: Path, capfd, name):
    source = tmp_path / name
    if source.suffix not in exportable():
        pytest.skip(f"this Blender is built without {source.suffix}")
    if name.startswith("cut"):
        empty()
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
        write_scene(source)
        data = source.read_bytes()
        source.write_bytes(data[: len(data) // 2])
    else:
        source.write_bytes(b"")
    assert run(["decompose", str(source), "-o", str(tmp_path / "out.blend")]) == 1
    told = capfd.readouterr().err
    reason = "the file is not whole: " if name.startswith("cut") else "the file is empty"
    assert f"{source}: error: {reason}" in told


def world(path: Path) -> np.ndarray:
    load(path)
    (obj,) = meshes()
    return np.array([obj.matrix_world @ vertex.co for vertex in obj.data.vertices])


@pytest.mark.parametrize(
    ("suffix", "options"),
    [
        (".fbx", {}),
        (".fbx", {"apply_scale_options": "FBX_SCALE_UNITS"}),
        (".fbx", {"axis_up": "Z", "axis_forward": "Y"}),
        (".fbx", {"axis_up": "Z", "axis_forward": "-Y", "global_scale": 10.0}),
        (".usda", {}),
        (".usdc", {"convert_scene_units": "CENTIMETERS", "convert_orientation": True}),
        (".usdz", {"convert_scene_units": "CUSTOM", "meters_per_unit": 0.7}),
    ],
)
def test_units_and_axes_of_a_file_stay(tmp_path: Path, suffix, options):
    source, target = tmp_path / f"in{suffix}", tmp_path / f"out{suffix}"
    empty()
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(1, 2, 3), rotation=(1, 0, 2))
    bpy.context.object.scale = (1, 2, 3)
    bpy.context.view_layer.update()
    if suffix not in exportable():
        pytest.skip(f"this Blender is built without {suffix}")
    operator = bpy.ops.export_scene.fbx if suffix == ".fbx" else bpy.ops.wm.usd_export
    known = operator.get_rna_type().properties
    operator(filepath=str(source), **{n: value for n, value in options.items() if n in known})
    before = world(source)
    assert run(["decompose", str(source), "-o", str(target), *ALL_PASS]) == 0
    metadata = (fbx if suffix == ".fbx" else usd).metadata
    assert metadata(source) == pytest.approx(metadata(target))
    assert len(metadata(target)) >= 2
    assert off(before, world(target)) < 1e-5 * np.ptp(before)


def test_custom_attributes_of_a_gltf_are_not_mixed_up(tmp_path: Path):
    """Blender's importer goes through their names in an order of its own."""
    source, target = tmp_path / "in.glb", tmp_path / "out.glb"
    empty()
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=3)
    mesh = bpy.context.object.data
    names = ["_A", "_BC", "_Q", "_X", "_Y9", "_ZED"]
    for number, name in enumerate(names):
        kind = "FLOAT" if number % 2 else "FLOAT_VECTOR"
        values = np.full(16 * (3 - 2 * (number % 2)), float(number))
        attribute = mesh.attributes.new(name, kind, "POINT")
        attribute.data.foreach_set("value" if number % 2 else "vector", values)
    bpy.ops.export_scene.gltf(filepath=str(source), export_attributes=True)
    assert run(["decompose", str(source), "-o", str(target), *ALL_PASS]) == 0
    load(target)
    (obj,) = meshes()
    for number, name in enumerate(names):
        values = [getattr(item, "value", None) for item in obj.data.attributes[name].data]
        values = [number if value is None else value for value in values]
        assert set(values) == {float(number)}
    assert {tuple(item.vector) for item in obj.data.attributes["_Q"].data} == {(2.0,) * 3}
