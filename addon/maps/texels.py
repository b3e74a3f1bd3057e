"""Where on surfaces the texels of a map are, as Cycles bakes it.

Every triangle emits its number and the place within it, and Cycles bakes the emission in floats. So
what a map holds can be worked out of arrays, in double precision, and one bake does for all kinds
of maps. Cycles does so in a scene of its own: nothing of the user's is touched.
"""

from __future__ import annotations

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..scene.temporary import Temporary
from .triangles import Triangles

FACE, CORNER = "Face", "Corner"
# The weights of the second and the third corner, at the corners of a triangle.
CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0))
# Single precision counts so far.
MOST_FACES = 1 << 24


@dataclass(frozen=True)
class Places:
    """Of a square image of a ``side``, from the bottom: the ``texels`` (N,) that lie on a surface,
    their triangles ``faces`` (N,), and the ``weights`` (N, 3) of the triangles' corners there."""

    side: int
    texels: np.ndarray
    faces: np.ndarray
    weights: np.ndarray

    def values(self, corners: np.ndarray, chosen: slice | np.ndarray = slice(None)) -> np.ndarray:
        """Values (F, 3, C) at the corners of all triangles, as they are at texels, (N, C)."""
        found = corners[self.faces[chosen]]
        return np.einsum("nk,nkc->nc", self.weights[chosen], found, dtype=np.float64)

    def among(self, texels: np.ndarray) -> Places:
        """Those of some texels, which all are among them."""
        rows = np.searchsorted(self.texels, texels)
        return Places(self.side, texels, self.faces[rows], self.weights[rows])


def own_places(target: Triangles, side: int) -> Places:
    """Where the texels are on the surface that has the UVs."""
    with Temporary() as now:
        baking = _Baking(now, side)
        return baking.bake(baking.add(now, target), None, 0.0)


def places_met(target: Triangles, source: Triangles, side: int, distance: float) -> Places:
    """Where rays from the surface that has the UVs meet another one, within a distance.

    They go along the normals of the vertices, from outside, and end at what they meet first.
    """
    with Temporary() as now:
        baking = _Baking(now, side)
        return baking.bake(baking.add(now, target), baking.add(now, source), distance)


def distance_between(target: Triangles, source: Triangles, count: int = 2000) -> float:
    """How far two surfaces are apart at most, by some points of both."""
    with Temporary() as now:
        scene = now.made(bpy.data.scenes.new("Distance"))
        found = 0.0
        for surface, other in ((target, source), (source, target)):
            obj = now.made(bpy.data.objects.new("Surface", now.made(other.mesh())))
            scene.collection.objects.link(obj)
            layer = scene.view_layers[0]
            layer.update()
            steps = np.linspace(0, len(surface.vertices) - 1, min(count, len(surface.vertices)))
            faces = surface.vertices[np.unique(steps.astype(int))]
            used = surface.positions[faces]
            for point in np.concatenate([used[:, 0], used.mean(axis=1)]):
                is_there, near, _, _ = obj.closest_point_on_mesh(point, depsgraph=layer.depsgraph)
                if is_there:
                    found = max(found, float(np.linalg.norm(np.array(near) - point)))
        return found


class _Baking:
    """A scene, an image and a material for baking, which are temporary."""

    def __init__(self, now: Temporary, side: int) -> None:
        self.scene = now.made(bpy.data.scenes.new("Bake"))
        try:
            self.scene.render.engine = "CYCLES"
        except TypeError as error:
            raise Refusal("maps need Cycles, which is disabled or not part of Blender") from error
        cycles = self.scene.cycles
        cycles.device, cycles.samples = "CPU", 1
        cycles.use_denoising = cycles.use_adaptive_sampling = False
        self.image = now.made(
            bpy.data.images.new("Bake", side, side, alpha=True, float_buffer=True, is_data=True)
        )
        self.material = now.made(bpy.data.materials.new("Bake"))
        _emit_places(self.material, self.image)

    def add(self, now: Temporary, triangles: Triangles) -> bpy.types.Object:
        """Add an object that emits its places."""
        count = len(triangles.vertices)
        if count >= MOST_FACES:
            raise Refusal(f"maps are baked of up to {MOST_FACES} triangles, not of {count}")
        mesh = now.made(triangles.mesh())
        faces = mesh.attributes.new(FACE, "FLOAT", "FACE")
        faces.data.foreach_set("value", np.arange(1, count + 1, dtype=np.float32))
        corners = mesh.attributes.new(CORNER, "FLOAT_VECTOR", "CORNER")
        corners.data.foreach_set("vector", np.tile(np.float32(CORNERS), (count, 1)).ravel())
        mesh.materials.append(self.material)
        obj = now.made(bpy.data.objects.new("Bake", mesh))
        self.scene.collection.objects.link(obj)
        return obj

    def bake(
        self, target: bpy.types.Object, source: bpy.types.Object | None, distance: float
    ) -> Places:
        """Have Cycles bake; raises Refusal if it does not."""
        layer = self.scene.view_layers[0]
        layer.update()
        chosen = [target] if source is None else [target, source]
        rays = {"use_selected_to_active": True, "cage_extrusion": distance}
        rays["max_ray_distance"] = 2 * distance
        context = {"scene": self.scene, "view_layer": layer, "active_object": target}
        context |= {"object": target, "selected_objects": chosen}
        try:
            with bpy.context.temp_override(**context, selected_editable_objects=chosen):
                status = bpy.ops.object.bake(
                    type="EMIT", margin=0, use_clear=True, target="IMAGE_TEXTURES",
                    save_mode="INTERNAL", **({} if source is None else rays)
                )  # fmt: skip
        except RuntimeError as error:
            raise Refusal(f"Cycles does not bake: {str(error).strip()}") from error
        if status != {"FINISHED"}:
            raise Refusal("Cycles does not bake now; is something rendered or baked already?")
        side = self.image.size[0]
        pixels = np.empty(side * side * 4, dtype=np.float32)
        self.image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(-1, 4)
        texels = np.flatnonzero(pixels[:, 0] >= 0.5)
        found = pixels[texels]
        faces = np.rint(found[:, 0]).astype(np.int32) - 1
        weights = np.column_stack([1 - found[:, 1] - found[:, 2], found[:, 1], found[:, 2]])
        return Places(side, texels, faces, weights)


def _emit_places(material: bpy.types.Material, image: bpy.types.Image) -> None:
    """Have a material emit the number of the triangle and two weights as red, green and blue."""
    if material.node_tree is None:  # before Blender 5, where setting it is deprecated
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    face, corner = (tree.nodes.new("ShaderNodeAttribute") for _ in range(2))
    face.attribute_name, corner.attribute_name = FACE, CORNER
    apart, together = (tree.nodes.new(f"ShaderNode{each}XYZ") for each in ("Separate", "Combine"))
    emission = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(corner.outputs["Vector"], apart.inputs[0])
    tree.links.new(face.outputs["Fac"], together.inputs[0])
    tree.links.new(apart.outputs[0], together.inputs[1])
    tree.links.new(apart.outputs[1], together.inputs[2])
    tree.links.new(together.outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    tree.nodes.active = texture  # which is where Cycles bakes to
