"""The command line's deform: what becomes of the parts that are held, moved and left free."""

from __future__ import annotations

import json
from pathlib import Path

import bpy
import numpy as np
import pytest
from ball import object_of
from command_line_files import empty, load, meshes, run, write_scene
from mathutils import Euler, Matrix, Vector
from shapes import dumbbell

EXACT = ["--algorithm", "convex"]  # moves what is moved as it is
UP = ["--pin", "z<10%", "--move", "z>90%:0,0,0.5", *EXACT]
SHOWN = (1, 5, 9)


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def coordinates(data) -> np.ndarray:
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


def key_positions(obj, name: str) -> np.ndarray:
    return coordinates(obj.data.shape_keys.key_blocks[name].data)


def moved(obj, name: str = "Deformation") -> np.ndarray:
    """What a shape key moves the vertices by in the world."""
    displacement = key_positions(obj, name) - key_positions(obj, "Basis")
    return displacement @ np.array(obj.matrix_world)[:3, :3].T


def in_world(obj, points: np.ndarray) -> np.ndarray:
    matrix = np.array(obj.matrix_world)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def shown() -> np.ndarray:
    """The points of the only mesh as they are seen in the world."""
    bpy.context.view_layer.update()
    (obj,) = meshes()
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return in_world(shape, coordinates(shape.data.vertices))


def assert_same_places(points: np.ndarray, others: np.ndarray) -> None:
    """Some formats store a point once per face corner."""
    apart = np.linalg.norm(points[:, None] - others[None], axis=2)
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-4


def assert_all(values: np.ndarray, expected, tolerance: float = 1e-5) -> None:
    assert len(values)
    np.testing.assert_allclose(values, np.broadcast_to(expected, values.shape), atol=tolerance)


def add_dumbbell(name: str = "Dumbbell") -> bpy.types.Object:
    """Two balls on a neck along z; the groups Feet and Head are their ends."""
    vertices, faces = dumbbell(n_around=24, n_along=60)
    obj = object_of(name, vertices, faces)
    for group, members in (("Feet", vertices[:, 2] < -1.8), ("Head", vertices[:, 2] > 1.8)):
        obj.vertex_groups.new(name=group).add(np.flatnonzero(members).tolist(), 1.0, "REPLACE")
    return obj


def write_dumbbell(path: Path) -> Path:
    empty()
    add_dumbbell()
    return write_scene(path)


def add_handle(obj) -> bpy.types.Object:
    """Pin the feet and return the empty that the head follows."""
    handle = bpy.data.objects.new("Handle", None)
    bpy.context.scene.collection.objects.link(handle)
    bpy.context.view_layer.update()
    pin, move = obj.spectral_tv.constraints.add(), obj.spectral_tv.constraints.add()
    pin.vertex_group, move.vertex_group = "Feet", "Head"
    move.kind, move.target = "OBJECT", handle
    obj.spectral_tv.algorithm = "CONVEX"
    return handle


def write_held(path: Path) -> Path:
    """A .blend with constraints, whose handle goes 0.8 along x from frame 1 to 9; shows frame 9."""
    empty()
    handle = add_handle(add_dumbbell())
    for frame, x in ((1, 0.0), (9, 0.8)):
        handle.location.x = x
        handle.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(9)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    return path


def deform(source: Path, target: Path, *options: str) -> bpy.types.Object:
    """Deform the file and return the mesh of what was written."""
    assert run(["deform", str(source), "-o", str(target), *options]) == 0
    load(target)
    return meshes()[0]


def test_what_is_moved_moves_exactly_and_what_is_pinned_stays(tmp_path: Path):
    source = write_dumbbell(tmp_path / "dumbbell.ply")
    regions = ["--pin", " z < 10 %", "--move", "Z > 90% : 0.3, 0, 0.5", "--softness", "0"]
    obj = deform(source, tmp_path / "out.blend", *regions)
    basis = key_positions(obj, "Basis")
    height = (basis[:, 2] - basis[:, 2].min()) / np.ptp(basis[:, 2])
    assert_all(moved(obj)[height > 0.9], (0.3, 0, 0.5))
    assert_all(moved(obj)[height < 0.1], 0)
    # The balls come along rigidly, the neck between them gives.
    assert_all(moved(obj)[height > 0.7], (0.3, 0, 0.5), 0.01)
    assert_all(moved(obj)[height < 0.3], 0, 0.01)
    assert_same_places(shown(), key_positions(obj, "Deformation"))


def test_regions_and_offsets_are_those_of_the_world(tmp_path: Path):
    obj = add_dumbbell()
    obj.matrix_world = (
        Matrix.Translation((3, -2, 5))
        @ Euler((0.1, 1.4, 0.2)).to_matrix().to_4x4()
        @ Matrix.Diagonal((2, 0.5, 1.5, 1))
    )
    source = write_scene(tmp_path / "turned.blend")
    obj = deform(
        source, tmp_path / "out.blend", "--pin", "x<20%", "--move", "x>75.5%:0,1,0", *EXACT
    )
    x = in_world(obj, key_positions(obj, "Basis"))[:, 0]
    share = (x - x.min()) / np.ptp(x)
    assert_all(moved(obj)[share > 0.7551], (0, 1, 0))
    assert_all(moved(obj)[share < 0.1999], 0)


def test_vertex_groups_are_named(tmp_path: Path):
    source = write_dumbbell(tmp_path / "dumbbell.blend")
    obj = deform(source, tmp_path / "out.blend", "--pin", "Feet", "--move", "Head:0.2,0,0", *EXACT)
    z = key_positions(obj, "Basis")[:, 2]
    assert_all(moved(obj)[z > 1.8], (0.2, 0, 0))
    assert_all(moved(obj)[z < -1.8], 0)
    assert [group.name for group in obj.vertex_groups] == ["Feet", "Head"]


def test_a_blend_can_be_dragged_on(tmp_path: Path):
    obj = deform(write_dumbbell(tmp_path / "dumbbell.ply"), tmp_path / "out.blend", *UP)
    assert [(each.vertex_group, each.kind) for each in obj.spectral_tv.constraints] == [
        ("z<10%", "PIN"),
        ("z>90%", "OBJECT"),
    ]
    (handle,) = (each for each in bpy.context.scene.objects if each.type == "EMPTY")
    z = key_positions(obj, "Basis")[:, 2]
    top = z > z.min() + 0.9 * np.ptp(z)
    middle = in_world(obj, key_positions(obj, "Deformation"))[top].mean(axis=0)
    assert_all(np.array(handle.matrix_world.translation), middle)
    before = key_positions(obj, "Deformation")
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(key_positions(obj, "Deformation"), before, atol=1e-6)
    handle.location += Vector((0.2, 0, 0))
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform()
    assert_all(moved(obj)[top], (0.2, 0, 0.5))


def test_constraints_in_the_file_are_used_and_objects_without_are_left(tmp_path: Path):
    add_handle(add_dumbbell()).location.x = 0.4
    add_dumbbell("Other")
    bpy.context.view_layer.update()
    path = tmp_path / "two.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    deform(path, tmp_path / "out.blend")
    held, other = (bpy.data.objects[name] for name in ("Dumbbell", "Other"))
    assert_all(moved(held)[key_positions(held, "Basis")[:, 2] > 1.8], (0.4, 0, 0))
    assert other.data.shape_keys is None
    # Those that are given replace them, on every mesh or on those named.
    deform(path, tmp_path / "out.blend", *UP, "--object", "Dumbbell")
    held, other = (bpy.data.objects[name] for name in ("Dumbbell", "Other"))
    assert [each.vertex_group for each in held.spectral_tv.constraints] == ["z<10%", "z>90%"]
    assert other.data.shape_keys is None
    deform(path, tmp_path / "out.blend", *UP)
    for name in ("Dumbbell", "Other"):
        assert moved(bpy.data.objects[name])[:, 2].max() == pytest.approx(0.5, abs=1e-5)


@pytest.mark.parametrize(
    ("options", "settings"),
    [
        (["--algorithm", "arap"], {"algorithm": "ARAP"}),
        (["--algorithm", "convex", "--softness", "40%"], {"softness": 40}),
    ],
)
def test_settings_are_the_operators_and_kept(tmp_path: Path, options, settings):
    obj = deform(write_held(tmp_path / "held.blend"), tmp_path / "out.blend", *options)
    result = key_positions(obj, "Deformation")
    for name, value in settings.items():
        assert getattr(obj.spectral_tv, name) == value
    load(tmp_path / "held.blend")
    (obj,) = meshes()
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.deform()
    assert np.abs(key_positions(obj, "Deformation") - result).max() > 1e-3
    bpy.ops.spectral_tv.deform(**settings)
    np.testing.assert_allclose(key_positions(obj, "Deformation"), result, atol=1e-6)


def test_frames_are_baked_as_by_the_operator(tmp_path: Path):
    source = write_held(tmp_path / "held.blend")
    obj = deform(source, tmp_path / "out.blend", "--frames", "1-9:4")
    assert bpy.context.scene.frame_current == 9
    names = [key.name for key in obj.data.shape_keys.key_blocks]
    assert names == ["Basis", *(f"Deformation {frame}" for frame in SHOWN)]
    shapes = {}
    for frame in SHOWN:
        bpy.context.scene.frame_set(frame)
        shapes[frame] = shown()
    load(source)
    (obj,) = meshes()
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.bake_deformation(frame_start=1, frame_end=9, step=4)
    for frame, shape in shapes.items():
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(shown(), shape, atol=1e-6)


@pytest.mark.parametrize("suffix", [".blend", ".glb", ".fbx"])
def test_over_frames_what_is_moved_goes_its_way(tmp_path: Path, suffix):
    source = write_dumbbell(tmp_path / "dumbbell.ply")
    deform(source, tmp_path / f"out{suffix}", *UP, "--frames", "1-301:100")
    heights = []
    first = 0 if suffix == ".glb" else 1  # where Blender's importer begins
    for frame in (0, 150, 225, 300):
        bpy.context.scene.frame_set(first + frame)
        heights.append(shown()[:, 2].max())
    np.testing.assert_allclose(np.diff(heights), [0.25, 0.125, 0.125], atol=2e-3)


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl", ".glb", ".fbx"])
def test_other_formats_hold_the_deformed_shape_alone(tmp_path: Path, suffix):
    source = write_dumbbell(tmp_path / "dumbbell.ply")
    deform(source, tmp_path / "out.blend", *UP)
    expected = shown()
    deform(source, tmp_path / f"out{suffix}", *UP)
    assert [obj.type for obj in bpy.context.scene.objects] == ["MESH"]
    assert_same_places(shown(), expected)


@pytest.mark.once
def test_pictures_show_the_deformed_shape_of_the_frame(tmp_path: Path):
    source = write_held(tmp_path / "held.blend")
    pictures = []
    for options in ([], ["--frames", "1-9:4"], ["--algorithm", "arap"]):
        path = tmp_path / f"{len(pictures)}.png"
        assert run(["deform", str(source), "--render", str(path), *options]) == 0
        pixels = bpy.data.images.load(str(path)).pixels
        pictures.append(np.array(pixels).reshape(-1, 4)[:, 3] > 0.5)
    one, same, other = pictures
    assert np.count_nonzero(one != same) < 0.002 * np.count_nonzero(one)
    assert np.count_nonzero(one != other) > 0.01 * np.count_nonzero(one)


def test_a_group_that_only_other_objects_have_is_left_out_there(tmp_path: Path, capfd):
    """A body with both groups, hair with the one that moves, eyes with none."""
    for name, missing in (("Body", []), ("Hair", ["Feet"]), ("Eyes", ["Feet", "Head"])):
        obj = add_dumbbell(name)
        for group in missing:
            obj.vertex_groups.remove(obj.vertex_groups[group])
    path = tmp_path / "three.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    parts = ["--pin", "Feet", "--move", "Head:0.4,0,0", *EXACT]
    deform(path, tmp_path / "out.blend", *parts)
    told = capfd.readouterr().err
    assert f"{path}: Hair: it has no vertex group 'Feet'" in told
    assert f"{path}: Eyes: it was left as it is: it has none of the groups to move" in told
    body, hair, eyes = (bpy.data.objects[name] for name in ("Body", "Hair", "Eyes"))
    z = key_positions(body, "Basis")[:, 2]
    assert_all(moved(body)[z > 1.8], (0.4, 0, 0))
    assert_all(moved(body)[z < -1.8], 0)
    assert_all(moved(hair), (0.4, 0, 0))
    assert eyes.data.shape_keys is None
    # Asked for by name, it is an error.
    assert (
        run(["deform", str(path), "-o", str(tmp_path / "no.blend"), *parts, "--object", "Hair"])
        == 1
    )
    assert "Hair: there is no vertex group 'Feet'" in capfd.readouterr().err
    assert not (tmp_path / "no.blend").exists()


def test_hidden_handles_in_the_file_move_over_frames(tmp_path: Path):
    source = write_held(tmp_path / "held.blend")
    load(source)
    bpy.data.objects["Handle"].hide_viewport = True
    bpy.ops.wm.save_mainfile()
    obj = deform(source, tmp_path / "out.blend", "--frames", "1-9:4")
    z = key_positions(obj, "Basis")[:, 2]
    for frame, x in ((1, 0), (5, 0.4), (9, 0.8)):
        assert_all(moved(obj, f"Deformation {frame}")[z > 1.8], (x, 0, 0))


def test_a_deleted_handle_in_the_file_is_told(tmp_path: Path, capfd):
    source = write_held(tmp_path / "held.blend")
    load(source)
    bpy.context.scene.collection.objects.unlink(bpy.data.objects["Handle"])
    bpy.ops.wm.save_mainfile()
    assert run(["deform", str(source), "-o", str(tmp_path / "out.blend")]) == 1
    assert "the object 'Handle' that moves 'Head' was deleted" in capfd.readouterr().err


def test_over_frames_in_stretched_time_what_is_moved_goes_its_way(tmp_path: Path):
    source = write_dumbbell(tmp_path / "dumbbell.blend")
    load(source)
    bpy.context.scene.render.frame_map_new = 200
    bpy.ops.wm.save_mainfile()
    deform(source, tmp_path / "out.blend", *UP, "--frames", "1-9:4")
    heights = []
    for frame in (1, 5, 9):
        bpy.context.scene.frame_set(frame)
        heights.append(shown()[:, 2].max())
    np.testing.assert_allclose(np.diff(heights), 0.25, atol=1e-3)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".stl"])
def test_a_format_that_cannot_play_gets_a_file_for_each_frame(tmp_path: Path, suffix):
    source, report = write_held(tmp_path / "held.blend"), tmp_path / "report.jsonl"
    options = ["--frames=-3-9:4", "--report", str(report)]
    assert run(["deform", str(source), "-o", str(tmp_path / f"out{suffix}"), *options]) == 0
    assert bpy.context.scene.frame_current == 9
    names = [f"out_{frame}{suffix}" for frame in ("-003", "0001", "0005", "0009")]
    assert sorted(path.name for path in tmp_path.glob(f"out*{suffix}")) == sorted(names)
    line = json.loads(report.read_text())
    assert line["output"] == [str(tmp_path / name) for name in names]
    assert not any("scene starts" in text for text in line["warnings"])
    for name, x in zip(names, (0.0, 0.0, 0.4, 0.8), strict=True):
        load(tmp_path / name)
        points = shown()
        head = points[points[:, 2] > points[:, 2].max() - 0.1]
        assert head[:, 0].mean() == pytest.approx(x, abs=0.05)


def test_frames_that_no_scene_starts_at_are_told(tmp_path: Path, capfd):
    source = write_held(tmp_path / "held.blend")
    obj = deform(source, tmp_path / "out.blend", "--frames=-4-9:20")
    assert "the scene starts at frame 0: no export goes back to -4" in capfd.readouterr().err
    names = [key.name for key in obj.data.shape_keys.key_blocks]
    assert names == ["Basis", "Deformation -4", "Deformation 9"]


def test_objects_of_one_mesh_are_deformed_alike_and_that_is_told(tmp_path: Path, capfd):
    source = write_dumbbell(tmp_path / "dumbbell.blend")
    load(source)
    (obj,) = meshes()
    twin = bpy.data.objects.new("Twin", obj.data)
    bpy.context.scene.collection.objects.link(twin)
    bpy.ops.wm.save_mainfile()
    deform(source, tmp_path / "out.blend", *UP)
    assert f"{source}: 2 objects share its mesh: all are deformed alike" in capfd.readouterr().err
    load(source)
    for each in meshes():
        add_handle(each)
    bpy.ops.wm.save_mainfile()
    assert run(["deform", str(source), "-o", str(tmp_path / "no.blend")]) == 1
    assert "Its mesh is also that of" in capfd.readouterr().err


def write_halves(path: Path, gap: float = 1e-6) -> Path:
    """Two halves of a plate, left and right, whose borders are so far apart."""
    empty()
    for name, x in (("left", -0.5), ("right", 0.5 + gap)):
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=9, y_subdivisions=9, size=1)
        obj = bpy.context.object
        obj.name = obj.data.name = name
        for vertex in obj.data.vertices:
            vertex.co.x += x
    return write_scene(path)


@pytest.mark.parametrize("suffix", [".obj", ".glb", ".blend"])
def test_objects_that_belong_together_and_are_deformed_apart_are_told(
    tmp_path: Path, capfd, suffix
):
    options = ["--pin", "x<10%", "--move", "x>90%:0,0,0.2"]
    source, target = write_halves(tmp_path / f"in{suffix}"), tmp_path / f"out{suffix}"
    assert run(["deform", str(source), "-o", str(target), *options]) == 0
    told = capfd.readouterr().err
    assert "open edges of left, right meet, but each object is deformed by itself" in told
    assert "x<10%, x>90%: percent are of each object by itself, left, right" in told


def test_objects_apart_and_single_ones_tear_nowhere(tmp_path: Path, capfd):
    options = ["--pin", "x<10%", "--move", "x>90%:0,0,0.2"]
    target = tmp_path / "out.obj"
    source = write_halves(tmp_path / "in.obj", gap=0.3)
    assert run(["deform", str(source), "-o", str(target), *options]) == 0
    told = capfd.readouterr().err
    assert "meet" not in told
    assert "percent are of each object by itself, left, right" in told
    source = write_halves(tmp_path / "in.obj")
    assert run(["deform", str(source), "-o", str(target), *options, "--object", "left"]) == 0
    told = capfd.readouterr().err
    assert "meet" not in told
    assert "percent" not in told


def test_an_object_that_stays_beside_one_that_is_deformed_is_told(tmp_path: Path, capfd):
    write_halves(tmp_path / "in.blend")
    obj = bpy.data.objects["right"]
    for name, is_in in (("Feet", lambda x: x < 0.1), ("Head", lambda x: x > 0.9)):
        members = [vertex.index for vertex in obj.data.vertices if is_in(vertex.co.x)]
        obj.vertex_groups.new(name=name).add(members, 1.0, "REPLACE")
    add_handle(obj)
    source, target = write_scene(tmp_path / "in.blend"), tmp_path / "out.obj"
    assert run(["deform", str(source), "-o", str(target)]) == 0
    assert "open edges of right, left meet" in capfd.readouterr().err
