"""Writing functions beside the one they were made of: what is written again is replaced.

A mesh remembers what was written from which source, so that nothing else is ever overwritten.
"""

import bpy
import numpy as np
from bpy.props import CollectionProperty, PointerProperty, StringProperty

from ..scene.shape_keys import add_displacements, set_displacement
from .sources import TYPES, Source

BAND, REST = "Band", "Rest"
# Weights below that are taken out of a vertex group.
NOTHING = 1e-6
SCALARS = {1: "FLOAT", 2: "FLOAT2", 3: "FLOAT_VECTOR"}


class SpectralTVOutput(bpy.types.PropertyGroup):
    """One function that was written; its name is that of what was written."""

    kind: StringProperty(name="Kind", description="Of the source")
    source: StringProperty(name="Source")
    label: StringProperty(name="Label", description="What it is of the source")
    written: StringProperty(name="Written", description="As an attribute, a group or a key")


class SpectralTVMesh(bpy.types.PropertyGroup):
    """What a mesh remembers of flows on its attributes."""

    outputs: CollectionProperty(type=SpectralTVOutput)
    table: PointerProperty(type=bpy.types.Text, name="Table", description="Of values over time")
    picture: PointerProperty(type=bpy.types.Image, name="Picture", description="Of the same")
    accuracy: PointerProperty(type=bpy.types.Text, name="Accuracy", description="Of its bands")


def write(obj: bpy.types.Object, source: Source, results: dict[str, np.ndarray]) -> list[str]:
    """Write functions (V, C), by their labels, beside their source; returns their names.

    Bands of vertex groups become attributes, as weights cannot be negative; what else leaves
    [0, 1] there is cut off. Bands of an earlier run that are not written again are removed.
    """
    is_bands = REST in results
    written = "ATTRIBUTE" if source.kind == "GROUP" and is_bands else source.kind
    if is_bands:
        _remove_stale(obj, source, set(results))
    names = []
    for label, values in results.items():
        record = _record(obj, source, label, written)
        wanted = f"{source.name} {label}"
        name = record.name if record.name != source.name else ""
        if written == "GROUP":
            record.name = _write_group(obj, name, wanted, values[:, 0])
        elif written == "KEY":
            record.name = _write_key(obj, name, wanted, values)
        else:
            alpha = None
            if source.alpha is not None:
                alpha = np.ones(len(values)) if is_bands else source.alpha
            record.name = _write_attribute(obj.data, name, wanted, values, alpha)
        names.append(record.name)
    obj.data.update_tag()
    return names


def _records(obj: bpy.types.Object, source: Source) -> list[SpectralTVOutput]:
    outputs = obj.data.spectral_tv.outputs
    return [each for each in outputs if (each.kind, each.source) == (source.kind, source.name)]


def _record(obj: bpy.types.Object, source: Source, label: str, written: str) -> SpectralTVOutput:
    for record in _records(obj, source):
        if (record.label, record.written) == (label, written):
            return record
    record = obj.data.spectral_tv.outputs.add()
    record.kind, record.source = source.kind, source.name
    record.label, record.written = label, written
    return record


def _remove_stale(obj: bpy.types.Object, source: Source, labels: set[str]) -> None:
    """Remove the bands of an earlier run that have no successor among ``labels``."""
    stale = [
        (record.name, record.label, record.written)
        for record in _records(obj, source)
        if record.label.startswith(BAND) and record.label not in labels
    ]
    outputs = obj.data.spectral_tv.outputs
    for name, label, written in stale:
        if written == "KEY":
            keys = obj.data.shape_keys
            if keys is not None and name in keys.key_blocks:
                obj.shape_key_remove(keys.key_blocks[name])
        elif name in obj.data.attributes:
            obj.data.attributes.remove(obj.data.attributes[name])
        index = next(
            index
            for index, each in enumerate(outputs)
            if (each.kind, each.source, each.label, each.written)
            == (source.kind, source.name, label, written)
        )
        outputs.remove(index)


def _write_group(obj: bpy.types.Object, name: str, wanted: str, weights: np.ndarray) -> str:
    group = obj.vertex_groups.get(name) if name else None
    if group is None:
        active = obj.vertex_groups.active_index
        group = obj.vertex_groups.new(name=wanted)
        obj.vertex_groups.active_index = active
    weights = np.clip(weights, 0, 1)
    group.remove(np.flatnonzero(weights <= NOTHING).tolist())
    for vertex in np.flatnonzero(weights > NOTHING).tolist():
        group.add([vertex], float(weights[vertex]), "REPLACE")
    return group.name


def _write_key(obj: bpy.types.Object, name: str, wanted: str, displacement: np.ndarray) -> str:
    keys = obj.data.shape_keys  # none, where they were removed during the work
    key = keys.key_blocks.get(name) if keys is not None and name else None
    if key is None:
        (key,) = add_displacements(obj, [wanted], displacement[np.newaxis])
    else:
        set_displacement(obj, key, displacement)
    return key.name


def _write_attribute(
    mesh: bpy.types.Mesh, name: str, wanted: str, values: np.ndarray, alpha: np.ndarray | None
) -> str:
    data_type = SCALARS[values.shape[1]]
    if alpha is not None:
        data_type, values = "FLOAT_COLOR", np.column_stack([values, alpha])
    attribute = mesh.attributes.get(name) if name else None
    if attribute is not None and (attribute.data_type, attribute.domain) != (data_type, "POINT"):
        mesh.attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = mesh.attributes.new(wanted, data_type, "POINT")
    field, _, dtype = TYPES[data_type]
    attribute.data.foreach_set(field, values.astype(dtype).ravel())
    return attribute.name


CLASSES = (SpectralTVOutput, SpectralTVMesh)


def register() -> None:
    """Register the properties, on every mesh."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Mesh.spectral_tv = PointerProperty(type=SpectralTVMesh)


def unregister() -> None:
    """Unregister the properties; files keep what they hold."""
    del bpy.types.Mesh.spectral_tv
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
