"""A temporary scene in which a mesh is photographed as matte clay."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler, Vector
from PIL import Image

# Direction the light travels in camera space (x right, y up, -z into the picture), strength
# in W/m², and angular diameter in degrees: large for softness, small for crisp relief.
LIGHTS = {
    "Key": ((0.85, -0.8, -0.55), 3.3, 8.0),
    "Fill": ((-0.9, -0.1, -0.8), 0.4, 60.0),
    "Rim": ((-0.75, -0.55, 0.7), 3.2, 20.0),
}
AMBIENT = 0.24
CLAY = (0.52, 0.43, 0.35)
# Of painted surfaces, so much of the light is their own.
GLOW = 0.6
MARK = (0.8, 0.02, 0.01)
CLAY_NAME, PAINT, MARK_NAME = "Studio Clay", "Studio Paint", "Studio Mark"


class Studio:
    """Scene, camera, lights and a mesh whose vertices are replaced from picture to picture.

    Use it within `temporary_data`. The camera is orthographic and looks at the object from the
    front (-Y), turned by `azimuth` to its left.

    Parameters
    ----------
    obj : bpy.types.Object
        Mesh object that supplies the faces and the placement in the world.
    size : int
        Width and height of a picture in pixels.
    margin : float
        Space around the object's own shape as a share of its larger extent in the picture.
    azimuth, elevation : float
        Direction to look from, in degrees.
    samples : int
        Cycles samples per pixel.
    smooth : bool
        Whether faces are shaded smoothly.
    """

    def __init__(
        self,
        obj: bpy.types.Object,
        size: int,
        *,
        margin: float = 0.18,
        azimuth: float = 25.0,
        elevation: float = 12.0,
        samples: int = 24,
        smooth: bool = True,
    ) -> None:
        """Set everything up but the position of the camera."""
        self._world = np.array(obj.matrix_world)
        self._turn = Euler((np.radians(90 - elevation), 0, np.radians(azimuth))).to_matrix()
        self.scene = bpy.data.scenes.new("Studio")
        _set_up_output(self.scene, size, samples)
        self._mesh = _bare_copy(obj.data)
        if not smooth:
            self._mesh.shade_flat()
        self._mesh.materials.append(None)
        self._mesh.materials.append(_matte(MARK_NAME, _marked))
        self._paint = self._mesh.color_attributes.new(PAINT, "FLOAT_COLOR", "POINT")
        self._add("Subject", self._mesh).matrix_world = obj.matrix_world
        self._add_lights()
        self._add_ambient()
        low, high = self._extent(vertices_of(obj.data))
        camera = bpy.data.cameras.new("Studio")
        camera.type = "ORTHO"
        self._frame: tuple[np.ndarray, np.ndarray] | None = None
        self._margin = margin
        self._scale = float((high - low)[:2].max()) * (1 + margin)
        self._distance = 2 * self._scale + float(high[2] - low[2])
        camera.clip_end = 100 * self._distance
        self.scene.camera = self._add("Camera", camera)
        self.scene.camera.rotation_euler = self._turn.to_euler()

    def hold_still(self, shapes: Sequence[np.ndarray]) -> None:
        """Have the camera stay where it sees each of some (V, 3) positions, as for a film."""
        extents = [self._extent(vertices) for vertices in shapes]
        low = np.min([each[0] for each in extents], axis=0)
        high = np.max([each[1] for each in extents], axis=0)
        self._frame = low, high
        self._scale = float((high - low)[:2].max()) * (1 + self._margin)

    def shoot(
        self,
        vertices: np.ndarray,
        colors: np.ndarray | None = None,
        marked: Sequence[int] | np.ndarray = (),
    ) -> Image.Image:
        """Photograph the mesh with other vertex positions, centred in the picture.

        The scale is that of the mesh's own shape, or smaller where a shape would not fit. After
        `hold_still` centre and scale stay.

        Parameters
        ----------
        vertices : (V, 3) array
            Positions in the object's own space.
        colors : (V, 3) array, optional
            Linear red, green and blue of the vertices; otherwise the mesh is clay.
        marked : sequence of int
            Faces that are red.

        Returns
        -------
        PIL.Image.Image
            RGBA, transparent around the mesh.
        """
        self._mesh.vertices.foreach_set("co", np.ravel(vertices).astype(np.float32))
        self._mesh.materials[0] = (
            _matte(CLAY_NAME, _clay) if colors is None else _matte(PAINT, _painted)
        )
        if colors is not None:
            rgba = np.column_stack([colors, np.ones(len(colors))]).astype(np.float32)
            self._paint.data.foreach_set("color", rgba.ravel())
        is_marked = np.zeros(len(self._mesh.polygons), dtype=np.int32)
        is_marked[np.asarray(marked, dtype=int)] = 1
        self._mesh.polygons.foreach_set("material_index", is_marked)
        self._mesh.update()
        low, high = self._frame or self._extent(vertices)
        self.scene.camera.data.ortho_scale = max(self._scale, 1.02 * (high - low)[:2].max())
        eye = (low + high) / 2
        eye[2] = high[2] + self._distance
        self.scene.camera.location = self._turn @ Vector(eye)
        return rendered(self.scene)

    def _extent(self, vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner of the box around `vertices` in camera directions."""
        world = vertices @ self._world[:3, :3].T + self._world[:3, 3]
        seen = world @ np.array(self._turn)
        return seen.min(axis=0), seen.max(axis=0)

    def _add(self, name: str, data: bpy.types.ID) -> bpy.types.Object:
        item = bpy.data.objects.new(name, data)
        self.scene.collection.objects.link(item)
        return item

    def _add_ambient(self) -> None:
        self.scene.world = bpy.data.worlds.new("Studio")
        ambient = self.scene.world.node_tree.nodes["Background"].inputs
        ambient["Color"].default_value = (0.9, 0.95, 1.0, 1.0)
        ambient["Strength"].default_value = AMBIENT

    def _add_lights(self) -> None:
        for name, (direction, strength, angle) in LIGHTS.items():
            light = bpy.data.lights.new(name, "SUN")
            light.energy = strength
            light.angle = np.radians(angle)
            lamp = self._add(name, light)
            travel = self._turn @ Vector(direction)
            lamp.rotation_euler = travel.to_track_quat("-Z", "Y").to_euler()


@contextmanager
def temporary_data() -> Iterator[None]:
    """On leaving, delete all of Blender's data-blocks that were made inside."""
    before = {block.as_pointer() for block in _data_blocks()}
    try:
        yield
    finally:
        bpy.data.batch_remove([b for b in _data_blocks() if b.as_pointer() not in before])


def _data_blocks() -> list[bpy.types.ID]:
    """All data-blocks of the kinds that are made here."""
    data = bpy.data
    kinds = (data.scenes, data.objects, data.meshes, data.cameras, data.lights, data.worlds)
    return [block for kind in (*kinds, data.materials, data.images) for block in kind]


def _set_up_output(scene: bpy.types.Scene, size: int, samples: int) -> None:
    """Make `scene` render with Cycles, untoned and transparent, on a square of `size` pixels."""
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = True
    scene.cycles.max_bounces = 2
    scene.render.resolution_x = size
    scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = True
    scene.render.use_compositing = False
    scene.render.use_sequencer = False
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.look = "None"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"


def rendered(scene: bpy.types.Scene) -> Image.Image:
    """Render `scene` by way of a file, as Blender's own "Render Result" cannot be read."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "render.png"
        scene.render.filepath = str(path)
        with _silence():
            bpy.ops.render.render(scene=scene.name, write_still=True)
        with Image.open(path) as picture:
            return picture.convert("RGBA")


@contextmanager
def _silence() -> Iterator[None]:
    """Keep Blender's own lines of every render off the progress bar."""
    sys.stdout.flush()
    terminal = os.dup(1)
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(terminal, 1)
        os.close(terminal)


def vertices_of(mesh: bpy.types.Mesh) -> np.ndarray:
    """Vertex positions (V, 3) of `mesh` in its own space."""
    positions = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", positions)
    return positions.reshape(-1, 3).astype(float)


def _bare_copy(mesh: bpy.types.Mesh) -> bpy.types.Mesh:
    """A smoothly shaded copy with vertices and faces only: no shape keys, normals, materials."""
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_start", starts)
    copy = bpy.data.meshes.new("Studio")
    copy.vertices.add(len(mesh.vertices))
    copy.vertices.foreach_set("co", vertices_of(mesh).astype(np.float32).ravel())
    copy.loops.add(len(corners))
    copy.loops.foreach_set("vertex_index", corners)
    copy.polygons.add(len(starts))
    copy.polygons.foreach_set("loop_start", starts)
    copy.update(calc_edges=True)
    copy.shade_smooth()
    return copy


def _clay(material: bpy.types.Material, shader: bpy.types.ShaderNode) -> None:
    """Matte clay, a little darker in creases so that relief reads at a small size."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    ramp = nodes.new("ShaderNodeValToRGB")
    _shade(ramp.color_ramp.elements, ((0.42, 0.55), (0.58, 1.18)))
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Pointiness"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], shader.inputs["Base Color"])


def _painted(material: bpy.types.Material, shader: bpy.types.ShaderNode) -> None:
    """The same surface in the colors of the vertices."""
    paint = material.node_tree.nodes.new("ShaderNodeVertexColor")
    paint.layer_name = PAINT
    for name in ("Base Color", "Emission Color"):  # shades are not to be taken for values
        material.node_tree.links.new(paint.outputs["Color"], shader.inputs[name])
    shader.inputs["Emission Strength"].default_value = GLOW
    shader.inputs["Specular IOR Level"].default_value = 0


def _marked(_material: bpy.types.Material, shader: bpy.types.ShaderNode) -> None:
    """Red that shows in the shade too."""
    for name in ("Base Color", "Emission Color"):
        shader.inputs[name].default_value = (*MARK, 1.0)
    shader.inputs["Emission Strength"].default_value = GLOW


def _matte(
    name: str, finish: Callable[[bpy.types.Material, bpy.types.ShaderNode], None]
) -> bpy.types.Material:
    """The matte material of a name, made if it is not there."""
    material = bpy.data.materials.get(name)
    if material is not None:
        return material
    material = bpy.data.materials.new(name)
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.62
    shader.inputs["Specular IOR Level"].default_value = 0.3
    finish(material, shader)
    return material


def _shade(stops: Iterable, levels: Iterable[tuple[float, float]]) -> None:
    """Set the stops of a color ramp to (position, brightness of the clay) pairs."""
    for stop, (position, brightness) in zip(stops, levels, strict=True):
        stop.position = position
        stop.color = (*(brightness * c for c in CLAY), 1.0)
