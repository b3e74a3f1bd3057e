"""Maps in renders of Cycles: the surface that the material makes of a low-poly mesh."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from map_scene import DISPLACEMENTS, amplitude, bake, distances, low_poly, scan, surface, values_of

# Positions are made positive, as a surface emits no less than nothing.
SHIFT = 10


@pytest.fixture(autouse=True)
def _nothing_left():
    yield
    bpy.data.batch_remove([*bpy.data.images, *bpy.data.materials, *bpy.data.cameras])


def emit_positions(material: bpy.types.Material) -> None:
    """Have a material emit the places of its surface, with its displacement as it is."""
    tree = material.node_tree
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    shift, emission = tree.nodes.new("ShaderNodeVectorMath"), tree.nodes.new("ShaderNodeEmission")
    shift.inputs[1].default_value = (SHIFT, SHIFT, SHIFT)
    output = tree.nodes["Material Output"]
    tree.links.new(geometry.outputs["Position"], shift.inputs[0])
    tree.links.new(shift.outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])


def rendered(path: Path, samples: int = 1) -> np.ndarray:
    """The places that a camera in front sees, (N, 3)."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", samples, False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 2.3
    scene.camera.location, scene.camera.rotation_euler = (0, -5, 0), (np.pi / 2, 0, 0)
    scene.render.resolution_x = scene.render.resolution_y = 48
    scene.render.resolution_percentage = 100
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    found = values_of(path).reshape(-1, 3)
    return found[found[:, 0] > SHIFT / 2] - SHIFT


@pytest.mark.parametrize("kind", DISPLACEMENTS)
def test_cycles_renders_the_look_of_a_scan_on_a_low_poly_mesh(kind, tmp_path):
    obj, low = scan(4), low_poly()
    obj.data.shape_keys.key_blocks[3].value = 2
    modifier = low.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 3
    bake(tmp_path / "map.exr", kind=kind, onto="OTHER", size=256, material=True)
    emit_positions(low.material_slots[0].material)
    obj.hide_render = True
    found = rendered(tmp_path / "render.exr")
    assert len(found) > 1200
    assert distances(surface(low), found).mean() > 0.01  # it is displaced in renders alone
    # Faces between its vertices are flat; with a level more it is less than 2 %.
    assert distances(surface(obj), found).mean() < 0.06 * amplitude(obj)


def test_cycles_shades_a_low_poly_mesh_by_the_normals_of_the_look(tmp_path):
    """The picture of the low-poly mesh with the map is nearly that of the scan, unlike without."""
    obj, low = scan(), low_poly()
    plain = bpy.data.materials.new("Plain")
    if plain.node_tree is None:
        plain.use_nodes = True
    for each in (obj, low):
        each.data.materials.append(plain)
    scene = bpy.context.scene
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.rotation_euler = (np.pi / 2, 0, 0)  # from the camera, so that there are no shadows
    scene.collection.objects.link(sun)
    pictures = []
    for number, hidden in enumerate((low, obj, obj)):
        for each in (obj, low):
            each.hide_render = each == hidden
        if number == 2:
            bake(tmp_path / "map.exr", kind="NORMAL", onto="OTHER", size=256, material=True)
        scene.cycles.max_bounces = 0
        rendered(tmp_path / f"{number}.exr", samples=16)
        pictures.append(values_of(tmp_path / f"{number}.exr").mean(axis=-1))
        bpy.data.objects.remove(scene.camera)
    look, bare, mapped = pictures
    middle = slice(16, 32), slice(16, 32)  # away from outlines, which normals do not move
    off = np.abs(mapped - look)[middle].mean()
    assert off < 0.2 * np.abs(bare - look)[middle].mean()
