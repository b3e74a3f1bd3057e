"""Changes to copies of meshes that make exporters write all that a format can hold."""

from collections.abc import Callable

import bpy
import numpy as np
from spectral_tv.files.srgb import decoded, encoded
from spectral_tv.means import means

from ..scene.arrays import corner_vertices, numbers
from .contents import color_layers, own_attributes
from .formats import FORMATS

# Types that the exporter of glTF knows.
GLTF_TYPES = {"FLOAT", "INT", "INT8", "BOOLEAN", "FLOAT_VECTOR", "FLOAT2", "QUATERNION"}


def dress_of(suffix: str) -> Callable[[bpy.types.Mesh], None] | None:
    """What to do to copies of meshes for files of this suffix; None if nothing."""
    return DRESSES.get(suffix)


def _for_gltf(mesh: bpy.types.Mesh) -> None:
    """Custom attributes have names that begin with a line, in capitals."""
    taken = set()
    for name in [attribute.name for attribute in own_attributes(mesh)]:
        attribute = mesh.attributes[name]
        if (
            attribute.data_type not in GLTF_TYPES
            or attribute.domain not in FORMATS[".glb"].attributes
        ):
            mesh.attributes.remove(attribute)
            continue
        wanted = "_" + name.upper().removeprefix("_")
        while wanted in taken:
            wanted += "_"
        taken.add(wanted)
        attribute.name = wanted


def _with_bytes(mesh: bpy.types.Mesh) -> None:
    """Colors are written where they are bytes on face corners."""
    for name in [layer.name for layer in color_layers(mesh)]:
        layer = mesh.color_attributes[name]
        values = (
            _colors(layer) if layer.domain == "CORNER" else _colors(layer)[corner_vertices(mesh)]
        )
        _replace(mesh, name, "BYTE_COLOR", "CORNER", values)


def _for_ply(mesh: bpy.types.Mesh) -> None:
    """The colors are bytes of vertices, and the exporter cuts them off where it should round."""
    _keep_one(mesh)
    layers = color_layers(mesh)
    if not layers:
        return
    (layer,) = layers
    values = _on_vertices(mesh, layer)
    levels = np.round(255 * np.column_stack([encoded(values[:, :3].clip(0, 1)), values[:, 3]]))
    shifted = (levels + 0.25) / 255
    values = np.column_stack([decoded(shifted[:, :3]), shifted[:, 3]])
    _replace(mesh, layer.name, "FLOAT_COLOR", "POINT", values)


def _keep_one(mesh: bpy.types.Mesh) -> None:
    """Only the active colors are written."""
    for name in [layer.name for layer in color_layers(mesh)][1:]:
        mesh.color_attributes.remove(mesh.color_attributes[name])


DRESSES: dict[str, Callable[[bpy.types.Mesh], None]] = {
    ".glb": _for_gltf,
    ".gltf": _for_gltf,
    ".abc": _with_bytes,
    ".dae": _with_bytes,
    ".ply": _for_ply,
    ".obj": _keep_one,
}


def _colors(layer: bpy.types.Attribute) -> np.ndarray:
    """The colors of a layer, linear, (N, 4)."""
    flat = numbers(layer.data, "color", 4, dtype=np.float32)
    return flat.reshape(-1, 4).astype(np.float64)


def _on_vertices(mesh: bpy.types.Mesh, layer: bpy.types.Attribute) -> np.ndarray:
    """Colors of vertices: where corners have them, their means."""
    values = _colors(layer)
    if layer.domain == "POINT":
        return values
    corners = corner_vertices(mesh)
    found = np.ones((len(mesh.vertices), 4))
    found[corners] = means(corners, values, len(found))[corners]
    return found


def _replace(mesh: bpy.types.Mesh, name: str, kind: str, domain: str, values: np.ndarray) -> None:
    """Give a color layer another type and place, and values."""
    is_active = mesh.color_attributes.active_color_name == name
    mesh.color_attributes.remove(mesh.color_attributes[name])
    layer = mesh.color_attributes.new(name, kind, domain)
    layer.data.foreach_set("color", values.astype(np.float32).ravel())
    if is_active:
        mesh.color_attributes.active_color_name = name
        mesh.color_attributes.render_color_index = mesh.color_attributes.find(name)
