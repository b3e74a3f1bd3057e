"""A stage with a floor, lights and a camera, on which several shapes stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector
from PIL import Image

from ..demo.studio import rendered
from ..gallery.page import Shape

Color = tuple[float, float, float]

# Of the floor and the wall that it bends up to, linear.
FLOOR: Color = (0.040, 0.052, 0.072)
SKY: Color = (0.55, 0.70, 1.0)
SKY_STRENGTH = 0.22
# Each light's place as seen from what it shines on (to the right, to the camera, up), its size,
# both in the height of the shapes, its strength and its color.
LIGHTS = (
    ((2.4, 2.2, 2.6), 1.3, 420.0, (1.0, 0.93, 0.84)),
    ((-3.0, 1.6, 1.2), 2.5, 60.0, (0.72, 0.84, 1.0)),
    ((-2.2, -2.2, 2.6), 1.4, 420.0, (0.62, 0.78, 1.0)),
    ((2.6, -2.4, 1.8), 1.2, 240.0, (1.0, 0.80, 0.60)),
)
# Creases are darker and ridges lighter than the color, by pointiness.
CREASE, RIDGE = (0.43, 0.45), (0.58, 1.25)


@dataclass(frozen=True)
class Figure:
    """A shape on the stage: where it stands, how far it is turned, in degrees, and its color.

    A color may be one for each vertex, (V, 3).
    """

    shape: Shape
    color: Color | np.ndarray
    x: float = 0.0
    y: float = 0.0
    turn: float = 0.0
    size: float = 1.0


@dataclass(frozen=True)
class View:
    """Where the camera is, what it looks at, and the angle that it sees across, in degrees."""

    place: tuple[float, float, float]
    target: tuple[float, float, float]
    angle: float = 20.0


def place_in_picture(
    view: View, point: tuple[float, float, float], size: tuple[int, int]
) -> tuple[float, float]:
    """Where a view shows a point of the stage, in pixels from the top left."""
    eye, target = np.array(view.place), np.array(view.target)
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    x, y, depth = (float(np.dot(way, point - eye)) for way in (right, up, forward))
    pixels = size[0] / 2 / np.tan(np.radians(view.angle) / 2) / depth
    return size[0] / 2 + pixels * x, size[1] / 2 - pixels * y


def photograph(
    figures: Sequence[Figure],
    view: View,
    size: tuple[int, int],
    samples: int,
    *,
    has_floor: bool = True,
) -> Image.Image:
    """A picture of figures on the floor, or of them alone, transparent around them.

    Use it within `temporary_data`.
    """
    scene = bpy.data.scenes.new("Stage")
    _set_up_output(scene, size, samples)
    scene.render.film_transparent = not has_floor
    scene.world = bpy.data.worlds.new("Stage")
    sky = scene.world.node_tree.nodes["Background"].inputs
    sky["Color"].default_value = (*SKY, 1.0)
    sky["Strength"].default_value = SKY_STRENGTH
    for figure in figures:
        _add_figure(scene, figure)
    if has_floor:
        _add_floor(scene)
    _add_lights(scene, Vector(view.target), Vector(view.place))
    _add_camera(scene, view)
    return rendered(scene)


def _add(scene: bpy.types.Scene, name: str, data: bpy.types.ID) -> bpy.types.Object:
    item = bpy.data.objects.new(name, data)
    scene.collection.objects.link(item)
    return item


def _add_figure(scene: bpy.types.Scene, figure: Figure) -> None:
    shape = figure.shape
    data = bpy.data.meshes.new("Figure")
    standing = shape.vertices - [0, 0, shape.vertices[:, 2].min()]
    data.from_pydata(standing.tolist(), [], shape.triangles.tolist())
    data.shade_smooth()
    colors = np.broadcast_to(np.asarray(figure.color, dtype=np.float32), standing.shape)
    rgba = np.column_stack([colors, np.ones(len(colors), dtype=np.float32)])
    data.color_attributes.new("Color", "FLOAT_COLOR", "POINT").data.foreach_set(
        "color", rgba.astype(np.float32).ravel()
    )
    data.materials.append(_clay())
    item = _add(scene, "Figure", data)
    item.location = (figure.x, figure.y, 0)
    item.rotation_euler = (0, 0, np.radians(figure.turn))
    item.scale = [figure.size] * 3


def _clay() -> bpy.types.Material:
    """Clay in the color of the vertices."""
    material = bpy.data.materials.new("Clay")
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.48
    shader.inputs["Specular IOR Level"].default_value = 0.35
    color = nodes.new("ShaderNodeVertexColor")
    color.layer_name = "Color"
    ramp = nodes.new("ShaderNodeValToRGB")
    for stop, (position, light) in zip(ramp.color_ramp.elements, (CREASE, RIDGE), strict=True):
        stop.position, stop.color = position, (light, light, light, 1.0)
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Pointiness"], ramp.inputs["Fac"])
    mix = nodes.new("ShaderNodeMix")
    mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
    mix.inputs["Factor"].default_value = 1.0
    links.new(color.outputs["Color"], mix.inputs["A"])
    links.new(ramp.outputs["Color"], mix.inputs["B"])
    links.new(mix.outputs["Result"], shader.inputs["Base Color"])
    return material


def _add_floor(scene: bpy.types.Scene) -> None:
    """A floor that bends up into a wall behind the figures."""
    bend = np.linspace(0, np.pi / 2, 24)
    profile = [(-30.0, 0.0), *zip(6 + 4 * np.sin(bend), 4 - 4 * np.cos(bend), strict=True)]
    profile.append((10.0, 40.0))
    corners = [(x, float(y), float(z)) for y, z in profile for x in (-60.0, 60.0)]
    faces = [(2 * n, 2 * n + 1, 2 * n + 3, 2 * n + 2) for n in range(len(profile) - 1)]
    data = bpy.data.meshes.new("Floor")
    data.from_pydata(corners, [], faces)
    data.shade_smooth()
    material = bpy.data.materials.new("Floor")
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*FLOOR, 1.0)
    shader.inputs["Roughness"].default_value = 0.55
    shader.inputs["Specular IOR Level"].default_value = 0.3
    data.materials.append(material)
    _add(scene, "Floor", data)


def _add_lights(scene: bpy.types.Scene, target: Vector, camera: Vector) -> None:
    near = (camera - target) * Vector((1, 1, 0))
    near.normalize()
    right = Vector((-near.y, near.x, 0))
    for place, size, strength, color in LIGHTS:
        light = bpy.data.lights.new("Light", "AREA")
        light.shape, light.size = "DISK", 2 * size
        light.energy, light.color = strength, color
        lamp = _add(scene, "Light", light)
        offset = 2 * (place[0] * right + place[1] * near + Vector((0, 0, place[2])))
        lamp.location = target + offset
        lamp.rotation_euler = (-offset).to_track_quat("-Z", "Y").to_euler()


def _add_camera(scene: bpy.types.Scene, view: View) -> None:
    data = bpy.data.cameras.new("Camera")
    data.angle = np.radians(view.angle)
    camera = _add(scene, "Camera", data)
    camera.location = view.place
    way = Vector(view.target) - Vector(view.place)
    camera.rotation_euler = way.to_track_quat("-Z", "Y").to_euler()
    scene.camera = camera


def _set_up_output(scene: bpy.types.Scene, size: tuple[int, int], samples: int) -> None:
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = True
    scene.cycles.max_bounces = 2
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Medium High Contrast"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
