"""Maps over UVs: what they hold."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
import pytest
from conftest import MODULE
from deform_scene import coordinates
from map_scene import (  # fmt: skip
    DISPLACEMENTS,
    Spots,
    amplitude,
    bake,
    distances,
    looked_up,
    low_poly,
    refused,
    scan,
    sphere_with_uvs,
    surface,
    unit,
)
from mathutils import Euler, Matrix, Vector
from mathutils.bvhtree import BVHTree
from mathutils.interpolate import poly_3d_calc

images = import_module(f"{MODULE}.maps.images")
TURN = Euler((0.4, 1.1, -0.3)).to_matrix().to_4x4()

pytestmark = pytest.mark.usefixtures("no_images")


# Onto a low-poly mesh.


@pytest.mark.parametrize("kind", DISPLACEMENTS)
def test_the_look_of_a_scan_goes_to_a_low_poly_mesh(kind, pair, tmp_path, capfd):
    obj, low = pair
    obj.data.shape_keys.key_blocks[3].value = 2
    values = bake(tmp_path / "map.exr", kind=kind, onto="OTHER", size=512)
    assert "rays look for the surface" in capfd.readouterr().out
    spots, seen = Spots(low.data), surface(obj)
    band = amplitude(obj)
    assert 0.005 < band < 0.02 < distances(seen, spots.points).mean() / 0.75
    assert distances(seen, spots.displaced(values, kind)).mean() < 0.02 * band


@pytest.mark.parametrize("kind", DISPLACEMENTS)
def test_objects_may_be_anywhere(kind, pair, tmp_path):
    obj, low = pair
    obj.data.transform(TURN @ Matrix.Diagonal((3, 3, 3, 1)), shape_keys=True)
    obj.matrix_world = Matrix.Translation((5, 2, -9)) @ Matrix.Diagonal((1 / 3, 1 / 3, -1 / 3, 1))
    low.matrix_world = Matrix.Translation((5, 2, -9)) @ TURN @ Matrix.Diagonal((0.5, 0.6, 0.7, 1))
    low.data.transform(Matrix.Diagonal((2, 1 / 0.6, 1 / 0.7, 1)))
    bpy.context.view_layer.update()
    values = bake(tmp_path / "map.exr", kind=kind, onto="OTHER", distance=0.2)
    spots = Spots(low.data)
    matrix = np.array(obj.matrix_world.inverted() @ low.matrix_world)
    found = spots.displaced(values, kind) @ matrix[:3, :3].T + matrix[:3, 3]
    start = spots.points @ matrix[:3, :3].T + matrix[:3, 3]
    seen = surface(obj)
    assert distances(seen, found).mean() < 0.05 * distances(seen, start).mean()


@pytest.mark.parametrize("samples", [1, 3])
def test_normals_are_those_of_cycles_own_bake(samples, pair, tmp_path):
    obj, low = pair
    options = {"kind": "NORMAL", "onto": "OTHER", "distance": 0.2}
    values = bake(tmp_path / "map.exr", margin=0, samples=samples, **options)
    np.testing.assert_allclose(np.linalg.norm(2 * values - 1, axis=-1), 1, atol=1e-5)
    expected = baked_by_hand(obj, low, 128)
    is_there = expected[..., 3] > 0
    assert is_there.mean() > 0.9
    cosines = (unit(2 * expected[..., :3] - 1) * (2 * values - 1)).sum(axis=-1)[is_there]
    # Cycles shades faces in single precision; means of samples are smoother.
    assert np.quantile(cosines, 0.02) > (0.9999 if samples == 1 else 0.99)
    flat = (2 * expected[..., 2] - 1)[is_there]
    assert np.quantile(flat, 0.1) < 0.99  # there is something to see


def baked_by_hand(obj, low, side: int) -> np.ndarray:
    """What Blender's own operator bakes of normals."""
    material = bpy.data.materials.new("By Hand")
    if material.node_tree is None:
        material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("By Hand", side, side, float_buffer=True, is_data=True)
    material.node_tree.nodes.active = node
    low.data.materials.append(material)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", 1, "CPU"
    with bpy.context.temp_override(active_object=low, object=low, selected_objects=[obj, low]):
        bpy.ops.object.bake(
            type="NORMAL", use_selected_to_active=True, cage_extrusion=0.2, max_ray_distance=0.4,
            margin=0,
        )  # fmt: skip
    flat = np.empty(side * side * 4, dtype=np.float32)
    node.image.pixels.foreach_get(flat)
    return flat.reshape(side, side, 4)


def test_a_band_goes_to_a_low_poly_mesh_as_it_moves_the_surface(pair, tmp_path):
    obj, low = pair
    values = bake(
        tmp_path / "map.exr", source="BAND", band=3, kind="OBJECT", onto="OTHER", size=256
    )
    keys = obj.data.shape_keys.key_blocks
    basis, band = (coordinates(each.points) for each in (keys[0], keys[3]))
    spots = Spots(low.data, 500)
    faces = [list(each.vertices) for each in obj.data.polygons]
    tree, expected = BVHTree.FromPolygons(basis.tolist(), faces), []
    for point, normal in zip(spots.points, spots.normals, strict=True):
        place, _, face, _ = tree.ray_cast(Vector(point + 0.2 * normal), Vector(-normal))
        weights = poly_3d_calc([Vector(each) for each in basis[faces[face]]], place)
        expected.append(np.array(weights) @ (band - basis)[faces[face]])
    off = np.linalg.norm(looked_up(values, spots.uvs) - expected, axis=1).mean()
    assert off < 0.03 * np.linalg.norm(expected, axis=1).mean()


def test_normals_of_a_band_alone_show_no_other(pair, tmp_path):
    flatness = []
    for band in (1, 3):
        values = bake(
            tmp_path / "map.exr",
            source="BAND",
            band=band,
            kind="NORMAL",
            onto="OTHER",
            distance=0.3,
        )
        flatness.append(np.abs(np.diff(values, axis=1))[20:-20].mean())
    assert flatness[0] != pytest.approx(flatness[1], rel=0.1)


def test_rays_that_meet_nothing_are_told_and_filled_by_the_margin(pair, tmp_path, capfd):
    low = pair[1]
    is_bare = ~bake(tmp_path / "map.exr", kind="OBJECT", onto="OTHER", margin=0).any(axis=-1)
    for vertex in low.data.vertices:
        if vertex.co.x > 0.8:
            vertex.co *= 1.8
    low.data.update()
    options = {"onto": "OTHER", "distance": 0.15, "kind": "OBJECT"}
    values = bake(tmp_path / "map.exr", margin=0, **options)
    out = capfd.readouterr().out
    share = float(
        out.split("% of the texels have rays that meet nothing within 15 cm")[0].split()[-1]
    )
    is_empty = ~values.any(axis=-1) & ~is_bare
    assert 1 < share < 20
    assert 100 * is_empty.sum() / (~is_bare).sum() == pytest.approx(share, abs=0.1)
    grown = bake(tmp_path / "map.exr", margin=2, **options)
    is_still = ~grown.any(axis=-1)
    assert 0 < is_still.sum() < is_empty.sum()
    is_there = values.any(axis=-1)
    np.testing.assert_array_equal(grown[is_there], values[is_there])
    refused(
        "no ray from it meets 'Scan' within",
        onto="OTHER",
        distance=1e-6,
        filepath=str(tmp_path / "b.exr"),
    )


def test_a_mesh_without_bands_can_be_baked_onto_another(tmp_path):
    scan()
    bpy.context.object.shape_key_clear()
    low = low_poly()
    values = bake(tmp_path / "map.exr", onto="OTHER")
    found = Spots(low.data).displaced(values, "DISPLACEMENT")
    assert distances(surface(bpy.context.object), found).mean() < 1e-3
    refused("no bands", onto="THIS", filepath=str(tmp_path / "a.exr"))
    refused("no bands", onto="OTHER", source="BAND", filepath=str(tmp_path / "a.exr"))


def test_modifiers_of_both_count(pair, tmp_path):
    obj, low = pair
    low.modifiers.new("Subdivision", "SUBSURF").levels = 2
    obj.modifiers.new("Smooth", "SMOOTH").iterations = 5
    values = bake(tmp_path / "map.exr", onto="OTHER")
    graph = bpy.context.evaluated_depsgraph_get()
    spots = Spots(low.evaluated_get(graph).to_mesh())
    found = spots.displaced(values, "DISPLACEMENT")
    assert (
        distances(surface(obj), found).mean() < 0.05 * distances(surface(obj), spots.points).mean()
    )


def test_what_cannot_be_a_target_is_refused(pair, tmp_path):
    low = pair[1]
    path = str(tmp_path / "map.exr")
    low.select_set(False)
    refused("select one other mesh", onto="OTHER", filepath=path)
    low.select_set(True)
    low.hide_viewport = True
    bpy.context.view_layer.update()
    refused("select one other mesh|'Low' is hidden", onto="OTHER", filepath=path)
    low.hide_viewport = False
    low.select_set(True)
    low.data.uv_layers.remove(low.data.uv_layers[0])
    refused("no UV map; unwrap it first", onto="OTHER", filepath=path)
    low.data.uv_layers.new()
    low.scale.x = 0
    bpy.context.view_layer.update()
    refused("the scale of 'Low' is zero along an axis", onto="OTHER", filepath=path)
    assert not list(tmp_path.iterdir())


# Over the UVs of the mesh itself.


@pytest.mark.parametrize("kind", DISPLACEMENTS)
@pytest.mark.parametrize("bands_as", ["KEYS", "ATTRIBUTES"])
def test_the_original_displaced_by_its_map_is_the_look(kind, bands_as, tmp_path, capfd):
    obj = sphere_with_uvs()
    if bands_as == "ATTRIBUTES":
        bpy.ops.spectral_tv.convert_bands(to="ATTRIBUTES")
    seen = surface(obj)
    original = obj.data.copy()
    capfd.readouterr()
    values = bake(tmp_path / "map.exr", kind=kind, size=256)
    spots = Spots(original)
    before, after = spots.points, spots.displaced(values, kind)
    is_told = "of the movement is sideways" in capfd.readouterr().out
    if kind != "DISPLACEMENT":
        assert not is_told
        assert distances(seen, after).mean() < 0.03 * distances(seen, before).mean()
        return
    assert is_told
    vectors = looked_up(bake(tmp_path / "map.exr", kind="OBJECT", size=256), spots.uvs)
    along = (vectors * spots.normals).sum(axis=1)
    assert np.abs(looked_up(values, spots.uvs)[:, 0] - along).mean() < 0.03 * np.abs(along).mean()


def test_a_band_is_what_its_slider_at_1_adds_within_its_mask(tmp_path):
    obj = sphere_with_uvs()
    keys = obj.data.shape_keys.key_blocks
    group = obj.vertex_groups.new(name="Half")
    upper = np.flatnonzero(coordinates(obj.data.vertices)[:, 2] > 0)
    group.add(upper.tolist(), 0.5, "REPLACE")
    keys[2].vertex_group = "Half"
    values = bake(tmp_path / "map.exr", source="BAND", band=2, kind="OBJECT", size=512)
    expected = coordinates(keys[2].points) - coordinates(keys[0].points)
    expected[upper] *= 0.5
    expected[np.setdiff1d(np.arange(len(expected)), upper)] = 0
    mesh = obj.data
    uvs = np.array([each.vector for each in mesh.uv_layers[0].uv])
    vertices = np.array([each.vertex_index for each in mesh.loops])
    inner = (uvs > 0.03).all(axis=1) & (uvs < 0.97).all(axis=1)
    found = looked_up(values, uvs[inner])
    # A vertex lies between the texels.
    assert np.abs(found - expected[vertices][inner]).mean() < 0.1 * np.abs(expected).mean()


def test_normals_of_the_look_are_seen_on_the_original(tmp_path):
    obj = sphere_with_uvs()
    original = obj.data.copy()
    graph = bpy.context.evaluated_depsgraph_get()
    look = obj.evaluated_get(graph).to_mesh().copy()
    values = bake(tmp_path / "map.exr", kind="NORMAL", size=256)
    spots, expected = Spots(original), Spots(look)
    x, y, z = (2 * looked_up(values, spots.uvs) - 1).T[..., np.newaxis]
    found = unit(x * spots.tangents + y * spots.bitangents + z * spots.normals)
    cosines = (found * expected.normals).sum(axis=1)
    assert np.quantile(cosines, 0.02) > 0.999
    assert np.quantile((spots.normals * expected.normals).sum(axis=1), 0.02) < 0.98


def test_a_png_has_normals_in_16_bits(tmp_path):
    sphere_with_uvs()
    exact = bake(tmp_path / "map.exr", kind="NORMAL", size=64)
    found = bake(tmp_path / "map.png", kind="NORMAL", size=64)
    assert 0 < np.abs(found - exact).max() <= 1 / 65535


def test_samples_of_a_texel_are_their_mean(tmp_path):
    sphere_with_uvs()
    fine = bake(tmp_path / "fine.exr", kind="OBJECT", size=128, margin=0)
    coarse = bake(tmp_path / "coarse.exr", kind="OBJECT", size=64, samples=2, margin=0)
    means = fine.reshape(64, 2, 64, 2, 3).mean(axis=(1, 3))
    is_inner = fine.any(axis=-1).reshape(64, 2, 64, 2).all(axis=(1, 3))
    np.testing.assert_allclose(coarse[is_inner], means[is_inner], atol=1e-6)
    refused(
        "131072 × 131072 samples takes about 4295.0 GB",
        size=16384,
        samples=8,
        filepath=str(tmp_path / "a.exr"),
    )


def test_margins_go_on_as_the_borders_are():
    values, filled = np.zeros((64, 2)), np.zeros(64, dtype=bool)
    filled[[9, 10]] = True
    values[9], values[10] = (1, 4), (3, 4)
    grown = images.with_margin(values, filled, 8, 1).reshape(8, 8, 2)
    assert (grown[:3, :4, 1] == 4).all() and not grown[3:].any() and not grown[:, 4:].any()
    assert grown[0, 0, 0] == 1 and grown[0, 1, 0] == 2 and grown[0, 3, 0] == 3
    assert (images.with_margin(values, filled, 8, 99)[:, 1] == 4).all()
    assert (images.with_margin(values, filled, 8, 0) == values).all()
