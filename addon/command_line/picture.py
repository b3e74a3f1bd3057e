"""A picture of objects: clay in front of a light ground, framed by itself."""

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler, Vector
from spectral_tv.refusal import Refusal

from ..scene.coordinates import coordinates
from .writing import written_by_blender

SIDE = 640
SAMPLES = 24
# From the front (-Y), turned to the object's left and raised a little; degrees.
AZIMUTH, ELEVATION = 30.0, 15.0
LENS, MARGIN = 85.0, 1.1
CLAY = (0.52, 0.43, 0.35, 1.0)
# Where light travels in the camera's space, its strength in W/m², its angular diameter in degrees.
LIGHTS = (((0.85, -0.8, -0.55), 3.3, 8.0), ((-0.9, -0.1, -0.8), 0.5, 60.0))
AMBIENT = 0.25


def render(objects: Sequence[bpy.types.Object], path: Path) -> None:
    """Render objects as they are now to a PNG.

    It leaves a scene behind, and shows objects that were hidden. Raises Refusal, NotWritten or
    RuntimeError if there is nothing to see or no picture comes of it.
    """
    shown = bpy.context.scene
    scene = bpy.data.scenes.new("Picture")
    scene.frame_set(shown.frame_current, subframe=shown.frame_subframe)
    for obj in objects:
        obj.hide_render = obj.hide_viewport = False
        scene.collection.objects.link(obj)
    turn = Euler((np.radians(90 - ELEVATION), 0, np.radians(AZIMUTH)))
    _add_lights(scene, turn)
    layer = scene.view_layers[0]
    layer.material_override = _clay()
    _add_camera(scene, turn, _points(objects, layer))
    _set_output(scene)
    bpy.ops.render.render(scene=scene.name)
    with written_by_blender(path) as place:
        # The renderer itself would take # and {} in the path for more than they are.
        bpy.data.images["Render Result"].save_render(str(place), scene=scene)


def _points(objects: Sequence[bpy.types.Object], layer: bpy.types.ViewLayer) -> np.ndarray:
    """The vertices of the objects' filtered shapes in world space, (N, 3)."""
    layer.update()
    graph = layer.depsgraph
    parts = []
    for obj in objects:
        shape = obj.evaluated_get(graph)
        local = coordinates(shape.data.vertices).reshape(-1, 3)
        matrix = np.array(shape.matrix_world)
        parts.append(local @ matrix[:3, :3].T + matrix[:3, 3])
    points = np.concatenate(parts)
    if len(points) == 0 or not np.isfinite(points).all():
        raise Refusal("there is no finite shape to picture")
    return points


def _add_camera(scene: bpy.types.Scene, turn: Euler, points: np.ndarray) -> None:
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.rotation_euler = turn
    camera.data.lens = LENS * MARGIN
    scene.render.resolution_x = scene.render.resolution_y = SIDE
    layer = scene.view_layers[0]
    layer.update()
    camera.location, _ = camera.camera_fit_coords(layer.depsgraph, points.ravel().tolist())
    camera.data.lens = LENS
    distance = np.linalg.norm(points - np.array(camera.location), axis=1).max()
    camera.data.clip_start, camera.data.clip_end = 1e-4 * distance, 2 * distance


def _add_lights(scene: bpy.types.Scene, turn: Euler) -> None:
    for direction, strength, angle in LIGHTS:
        light = bpy.data.lights.new("Light", "SUN")
        light.energy, light.angle = strength, np.radians(angle)
        lamp = bpy.data.objects.new("Light", light)
        lamp.rotation_euler = (
            (turn.to_matrix() @ Vector(direction)).to_track_quat("-Z", "Y").to_euler()
        )
        scene.collection.objects.link(lamp)
    scene.world = bpy.data.worlds.new("Picture")
    _use_nodes(scene.world)
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = AMBIENT
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.9, 0.95, 1, 1)


def _clay() -> bpy.types.Material:
    material = bpy.data.materials.new("Clay")
    _use_nodes(material)
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = CLAY
    shader.inputs["Roughness"].default_value = 0.75
    return material


def _use_nodes(data: bpy.types.World | bpy.types.Material) -> None:
    if data.node_tree is None:  # before Blender 5, where setting it is deprecated
        data.use_nodes = True


def _set_output(scene: bpy.types.Scene) -> None:
    try:
        scene.render.engine = "CYCLES"
    except TypeError as error:
        raise Refusal("pictures need Cycles, which is disabled or not part of Blender") from error
    scene.cycles.device = "CPU"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_denoising = False  # not every build has it
    scene.cycles.max_bounces = 1
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = True
    scene.render.use_compositing = scene.render.use_sequencer = False
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
