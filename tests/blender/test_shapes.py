"""Which shape is decomposed: what is seen, unless the user chooses another."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector

QUICK = {"bands": 3, "steps": 8}


def coordinates(data) -> np.ndarray:
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


def seen(obj) -> np.ndarray:
    bpy.context.view_layer.update()
    return coordinates(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices)


def latest(obj) -> list[bpy.types.ShapeKey]:
    keys = obj.data.shape_keys
    return [keys.key_blocks[band.key] for band in obj.data.spectral_tv.decompositions[-1].bands]


def displacements(obj) -> np.ndarray:
    basis = coordinates(obj.data.shape_keys.reference_key.data)
    return np.array([coordinates(key.data) - basis for key in latest(obj)])


def low_pass(obj, **options) -> None:
    """Remove the finest of three bands, with whatever is seen as the start."""
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.decompose(into="ADD", **QUICK, **options)
    latest(obj)[0].value = -1


def from_scratch(points: np.ndarray, like) -> bpy.types.Object:
    """An object of that shape with the faces of another."""
    mesh = bpy.data.meshes.new("Scratch")
    mesh.from_pydata(points.tolist(), [], [tuple(face.vertices) for face in like.data.polygons])
    obj = bpy.data.objects.new("Scratch", mesh)
    bpy.context.collection.objects.link(obj)
    obj.matrix_world = like.matrix_world
    return obj


# A rounded position can turn a choice by which thickness is found.
@pytest.mark.parametrize(("keep_limbs", "most"), [(0, 1e-5), (1, 3e-5)])
def test_filtering_again_filters_what_the_first_filter_shows(monkey, keep_limbs, most):
    """Not the detail that is gone already, once more."""
    low_pass(monkey, keep_limbs=keep_limbs)
    once = seen(monkey)
    low_pass(monkey, keep_limbs=keep_limbs)
    twice = seen(monkey)
    fresh = from_scratch(once, monkey)
    low_pass(fresh, keep_limbs=keep_limbs)
    difference = np.abs(twice - seen(fresh))
    assert difference.max() < most
    assert difference.mean() < 1e-6


def test_other_keys_masks_and_mutes_count_as_they_are_shown(monkey):
    count = len(monkey.data.vertices)
    rng = np.random.default_rng(2)
    monkey.shape_key_add(name="Basis")
    half = monkey.vertex_groups.new(name="Half")
    half.add(list(range(count // 2)), 0.6, "REPLACE")
    for name in ("Wave", "Masked", "Muted", "Relative"):
        key = monkey.shape_key_add(name=name, from_mix=False)
        moved = coordinates(key.data) + rng.normal(0, 0.01, (count, 3))
        key.data.foreach_set("co", moved.astype(np.float32).ravel())
        key.value = 0.5
    blocks = monkey.data.shape_keys.key_blocks
    blocks["Masked"].vertex_group = "Half"
    blocks["Muted"].mute = True
    blocks["Relative"].relative_key = blocks["Wave"]
    before = seen(monkey)
    bpy.ops.spectral_tv.decompose(keep_limbs=0, **QUICK)
    np.testing.assert_allclose(seen(monkey), before, atol=1e-6)
    fresh = from_scratch(before, monkey)
    bpy.context.view_layer.objects.active = fresh
    bpy.ops.spectral_tv.decompose(keep_limbs=0, **QUICK)
    np.testing.assert_allclose(displacements(monkey), displacements(fresh), atol=1e-5)


def test_the_basis_is_decomposed_where_that_is_chosen(monkey):
    bpy.ops.spectral_tv.decompose(**QUICK)
    expected = displacements(monkey)
    monkey.shape_key_clear()
    monkey.shape_key_add(name="Basis")
    fat = monkey.shape_key_add(name="Fat", from_mix=False)
    for point in fat.data:
        point.co *= 2
    fat.value = 1
    bpy.ops.spectral_tv.decompose(shape="BASIS", **QUICK)
    np.testing.assert_allclose(displacements(monkey), expected, atol=1e-7)


def rough_half() -> bpy.types.Object:
    """The half of a rough ball at x ≥ 0, its midline near x = 0, with Mirror."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    obj = bpy.context.object
    noise = 1 + 0.05 * np.random.default_rng(3).normal(size=len(obj.data.vertices))
    edited = bmesh.new()
    edited.from_mesh(obj.data)
    for vertex, scale in zip(edited.verts, noise, strict=True):
        vertex.co *= scale
    geometry = [*edited.verts, *edited.edges, *edited.faces]
    bmesh.ops.bisect_plane(
        edited, geom=geometry, plane_co=(0, 0, 0), plane_no=(1, 0, 0), clear_inner=True
    )
    bmesh.ops.remove_doubles(edited, verts=edited.verts, dist=1e-5)
    edited.to_mesh(obj.data)
    edited.free()
    obj.modifiers.new("Mirror", "MIRROR").merge_threshold = 1e-5
    return obj


def open_edges(obj) -> int:
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    edited = bmesh.new()
    edited.from_object(shape, bpy.context.evaluated_depsgraph_get())
    count = sum(len(edge.link_faces) < 2 for edge in edited.edges)
    edited.free()
    return count


@pytest.mark.parametrize("method", ["M1", "M2", "M3"])
def test_a_mirrored_half_stays_joined_and_gets_the_bands_of_the_whole(method):
    # Thickness is measured at samples, which follow the order of the triangles.
    exact = {"method": method, "base": "FLOW", "keep_limbs": 0}
    half = rough_half()
    half.matrix_world = Matrix.LocRotScale((3, 1, 0), None, Vector((1.0, 2.0, 0.7)))
    bpy.context.view_layer.update()
    midline = np.abs(coordinates(half.data.vertices)[:, 0]) < 1e-6
    assert midline.any() and open_edges(half) == 0
    whole = seen(half)
    bpy.ops.spectral_tv.decompose(**exact, **QUICK)
    for key in latest(half):
        key.value = -1
    smooth = seen(half)
    assert open_edges(half) == 0
    assert np.abs(smooth[: len(midline)][midline, 0]).max() < 1e-6

    half.modifiers.clear()
    half.shape_key_clear()
    half.modifiers.new("Mirror", "MIRROR").merge_threshold = 1e-5
    bpy.ops.object.modifier_apply(modifier="Mirror")
    np.testing.assert_allclose(coordinates(half.data.vertices), whole, atol=1e-6)
    bpy.ops.spectral_tv.decompose(**exact, **QUICK)
    for key in latest(half):
        key.value = -1
    np.testing.assert_allclose(seen(half), smooth, atol=2e-5)


def test_two_planes_of_symmetry_about_another_object():
    half = rough_half()
    about = bpy.data.objects.new("About", None)
    bpy.context.collection.objects.link(about)
    about.matrix_world = Matrix.LocRotScale((0, 0, 0), None, None)
    mirror = half.modifiers["Mirror"]
    mirror.mirror_object = about
    mirror.use_axis = (True, True, False)
    mirror.merge_threshold = 1e-4
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.decompose(**QUICK)
    on_plane = np.abs(coordinates(half.data.vertices)[:, 0]) < 1e-6
    np.testing.assert_allclose(displacements(half)[:, on_plane, 0], 0, atol=1e-7)


def test_modifiers_that_change_the_shape_are_applied_where_that_is_chosen(monkey):
    monkey.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.05
    monkey.vertex_groups.new(name="All").add(range(len(monkey.data.vertices)), 1.0, "REPLACE")
    shown = seen(monkey)
    bpy.ops.spectral_tv.decompose(shape="APPLIED", **QUICK)
    result = bpy.context.object
    assert result.name == f"{monkey.name} Applied" and monkey.hide_get()
    assert monkey.data.shape_keys is None and len(monkey.modifiers) == 1
    np.testing.assert_allclose(seen(result), shown, atol=1e-6)
    assert [group.name for group in result.vertex_groups] == ["All"]
    assert len(latest(result)) == 3
    fresh = from_scratch(shown, result)
    bpy.context.view_layer.objects.active = fresh
    bpy.ops.spectral_tv.decompose(**QUICK)
    np.testing.assert_allclose(displacements(result), displacements(fresh), atol=1e-5)


def split_ball() -> tuple[bpy.types.Object, list[bpy.types.Object]]:
    """A rough ball, and the same in three objects whose open edges meet."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    whole = bpy.context.object
    noise = 1 + 0.05 * np.random.default_rng(5).normal(size=len(whole.data.vertices))
    points = coordinates(whole.data.vertices) * noise[:, None]
    whole.data.vertices.foreach_set("co", points.astype(np.float32).ravel())
    faces = np.array([tuple(face.vertices) for face in whole.data.polygons])
    middle = points[faces].mean(axis=1)[:, 2]
    pieces = []
    for number, chosen in enumerate([middle < -0.3, abs(middle) <= 0.3, middle > 0.3]):
        used, local = np.unique(faces[chosen], return_inverse=True)
        mesh = bpy.data.meshes.new(f"Piece {number}")
        shift = Vector((0.5 * number, 0, 0))
        mesh.from_pydata(
            (coordinates(whole.data.vertices)[used] - np.array(shift)).tolist(),
            [],
            local.reshape(-1, 3).tolist(),
        )
        piece = bpy.data.objects.new(f"Piece {number}", mesh)
        piece.location = shift
        bpy.context.collection.objects.link(piece)
        pieces.append(piece)
    bpy.context.view_layer.update()
    return whole, pieces


def add_base(obj: bpy.types.Object) -> None:
    """The shape key Base: a sphere in the world."""
    obj.shape_key_add(name="Basis", from_mix=False)
    key = obj.shape_key_add(name="Base", from_mix=False)
    key.value = 0
    shift = np.array(obj.location)
    points = seen(obj) + shift
    points *= 0.9 / np.linalg.norm(points, axis=1, keepdims=True)
    key.data.foreach_set("co", (points - shift).astype(np.float32).ravel())


@pytest.mark.parametrize(
    ("method", "base"), [("M1", "FLOW"), ("M2", "FLOW"), ("M3", "FLAT"), ("M3", "KEY")]
)
def test_objects_whose_open_edges_meet_are_decomposed_as_one(method, base):
    whole, pieces = split_ball()
    for obj in (whole, *pieces) if base == "KEY" else ():
        add_base(obj)
    how = {"method": method, "base": base, "base_key": "Base", "keep_limbs": 0, **QUICK}
    bpy.ops.spectral_tv.decompose(**how)
    places = {tuple(np.round(p, 5)): index for index, p in enumerate(seen(whole))}
    bpy.ops.object.select_all(action="DESELECT")
    for piece in pieces:
        piece.select_set(True)
    bpy.context.view_layer.objects.active = pieces[1]
    bpy.ops.spectral_tv.decompose(together=True, **how)
    for piece in pieces:
        points = seen(piece) + np.array(piece.location)
        same = [places[tuple(np.round(p, 5))] for p in points]
        np.testing.assert_allclose(displacements(piece), displacements(whole)[:, same], atol=1e-5)
    bpy.context.view_layer.objects.active = pieces[0]
    bpy.ops.spectral_tv.cut(bands=4)
    assert len(latest(pieces[0])) == 4 and len(latest(pieces[1])) == 3


def test_vertices_nowhere_in_no_face_stay_and_faces_with_such_can_be_left_out(monkey):
    count = len(monkey.data.vertices)
    monkey.data.vertices.add(1)
    monkey.data.vertices[count].co.x = float("nan")
    assert bpy.ops.spectral_tv.decompose(**QUICK) == {"FINISHED"}
    assert np.isnan(coordinates(latest(monkey)[0].data)[count, 0])
    monkey.shape_key_clear()
    monkey.data.vertices[11].co.y = float("inf")
    with pytest.raises(RuntimeError, match="vertex 11"):
        bpy.ops.spectral_tv.decompose(**QUICK)
    assert bpy.ops.spectral_tv.decompose(leaves_out=True, **QUICK) == {"FINISHED"}
    moves = displacements(monkey)[:, :count]
    assert np.isfinite(moves).all() and np.abs(moves).max() > 1e-3
    np.testing.assert_array_equal(moves[:, 11], 0)
