"""A rigged character with a driven face and a sculpted head, and the facts that tools keep."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import bpy
import contents
import numpy as np
from conftest import MODULE
from deform_scene import coordinates, evaluated, group
from rigged_body import FRAMES, rigged_body
from sculpted_head import sculpted_head

_BANDS = import_module(f"{MODULE}.scene.attribute_band")
has_bands, attribute_bands = _BANDS.has_bands, _BANDS.attribute_bands
# What moves along with the shape, and what is chosen by hand.
SHAPE = ("attribute position", "attribute custom_normal")
SELECTED = ("attribute .select_vert", "attribute .select_edge", "attribute .select_poly")
# Relative to the size, and with what FBX and glTF make of numbers.
EXACT, ROUNDED = 1e-6, 2e-6
SUFFIXES = (".glb", ".fbx")


def character() -> bpy.types.Object:
    """The rigged body with keyframes of a face key, and one more of these: masked, and driven by a
    property and by a bone."""
    obj = rigged_body()
    pout = obj.data.shape_keys.key_blocks["Pout"]
    for frame, value in zip(FRAMES, (0.5, 0.0, 0.9), strict=True):
        pout.value = value
        pout.keyframe_insert("value", frame=frame)
    _dress(obj.data)
    obj.rotation_euler, obj.scale = (0.1, 0.2, 0.3), (1.0, 1.0, 1.2)
    _add_blink(obj)
    return obj


def head() -> bpy.types.Object:
    """The sculpted head with the last of these keys."""
    obj = sculpted_head()
    _add_blink(obj)
    return obj


def _dress(mesh: bpy.types.Mesh) -> None:
    """Normals of one's own, sharp and creased edges, seams, colors, face sets, a second UV map."""
    mesh.normals_split_custom_set([(0.1, 0.2, 1.0)] * len(mesh.loops))
    for edge in mesh.edges:
        edge.use_seam = edge.index % 7 == 0
    mesh.attributes.new("crease_edge", "FLOAT", "EDGE").data.foreach_set(
        "value", np.arange(len(mesh.edges), dtype=np.float32) % 2 / 4
    )
    colors = mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    colors.data.foreach_set("color", np.linspace(0, 1, 4 * len(mesh.vertices), dtype=np.float32))
    faces = np.arange(len(mesh.polygons), dtype=np.int32) % 3
    mesh.polygons.foreach_set("material_index", faces % 2)
    mesh.attributes.new(".sculpt_face_set", "INT", "FACE").data.foreach_set("value", faces + 1)
    mesh.uv_layers.new(name="Second")


def _add_blink(obj: bpy.types.Object) -> None:
    rig = obj.parent = bpy.data.objects["Rig"]
    for frame, value in zip(FRAMES, (0.0, 0.25, 0.75), strict=True):
        rig["blink"] = value
        rig.keyframe_insert('["blink"]', frame=frame)
    group(obj, "Lids", [vertex.index for vertex in obj.data.vertices if vertex.co.y < 0], 0.5)
    blink = obj.shape_key_add(name="Blink", from_mix=False)
    blink.vertex_group, blink.slider_min = "Lids", -0.5
    for point in blink.points:
        point.co.z *= 0.9
    driver = blink.driver_add("value").driver
    driver.expression = "shut + 0.25 * turn"
    shut, turn = driver.variables.new(), driver.variables.new()
    shut.name, turn.name, turn.type = "shut", "turn", "TRANSFORMS"
    shut.targets[0].id, shut.targets[0].data_path = rig, '["blink"]'
    turn.targets[0].id, turn.targets[0].bone_target = rig, "Bone"
    turn.targets[0].transform_type, turn.targets[0].transform_space = "ROT_X", "LOCAL_SPACE"
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = FRAMES[0], FRAMES[-1]
    bpy.context.scene.frame_set(FRAMES[0])


@dataclass
class Facts:
    """What of an object is to be kept; ``shape`` is its Basis, and bands are not in ``keys``."""

    shape: np.ndarray
    keys: dict[str, tuple[np.ndarray, tuple[Any, ...]]]
    drivers: list[tuple[Any, ...]]
    driven: list[dict[str, float]]
    poses: list[np.ndarray]
    places: list[np.ndarray]
    uvs: np.ndarray
    weights: dict[str, np.ndarray]
    attributes: dict[str, Any]
    chosen: tuple[Any, ...]
    exports: dict[str, dict[str, np.ndarray]]

    @classmethod
    def of(
        cls,
        obj: bpy.types.Object,
        folder: Path | None,
        like: Facts | None = None,
        neutral: bool = True,
    ) -> Facts:
        """Those of ``obj``; of the keys and groups that there were before, if it is ``like`` those.

        The other keys are at 0 and muted, if it shall be ``neutral``. It is exported to ``folder``,
        if there is one.
        """
        obj.hide_set(False)
        obj.hide_render = False
        all_keys = {} if obj.data.shape_keys is None else obj.data.shape_keys.key_blocks
        names = list(all_keys.keys() if like is None else like.keys)
        assert all(name in all_keys for name in names), (names, all_keys.keys())
        groups = list(obj.vertex_groups.keys() if like is None else like.weights)
        chosen = (
            obj.active_shape_key.name if names else "",
            obj.vertex_groups.active and obj.vertex_groups.active.name,
            obj.show_only_shape_key,
            obj.data.uv_layers.active.name,
            [
                (each.name, each.type, each.show_viewport)
                for each in obj.modifiers
                if not has_bands(each)
            ],
            [slot.material and slot.material.name for slot in obj.material_slots],
        )
        others = [key for key in all_keys.values() if key.name not in names] if neutral else []
        others += attribute_bands(obj) if neutral else []
        values = [(key.value, key.mute) for key in others]
        for key in others:  # some are keyframed
            key.value, key.mute = 0, True
        try:
            poses, places, driven = [], [], []
            for frame in FRAMES:
                bpy.context.scene.frame_set(frame)
                poses.append(evaluated(obj))
                places.append(np.array(obj.matrix_world))
                driven.append({name: all_keys[name].value for name in names})
            bpy.context.scene.frame_set(FRAMES[0])
            return cls(
                coordinates(all_keys[names[0]].points if names else obj.data.vertices),
                {name: _key(all_keys[name]) for name in names},
                sorted(_driver(each) for each in _drivers(obj, names)),
                driven,
                poses,
                places,
                _uvs(obj.data),
                {name: _weights(obj, name) for name in groups},
                _attributes(obj.data),
                chosen,
                {suffix: _exported(obj, folder, suffix, names) for suffix in SUFFIXES if folder},
            )
        finally:
            for key, (value, mute) in zip(others, values, strict=True):
                key.value, key.mute = value, mute


def assert_kept(before: Facts, now: Facts, moved: float | None = None) -> None:
    """All of it is as before. One that has ``moved`` has another Basis, from which its keys move
    the vertices as before; what is seen is the same to within this, relative to the size."""
    size = float(np.linalg.norm(np.ptp(before.poses[0], axis=0)))
    is_moved = moved is not None
    exact = (EXACT if moved is None else moved) * size
    if not is_moved:
        np.testing.assert_array_equal(now.shape, before.shape)
    for name, (moves, settings) in before.keys.items():
        assert now.keys[name][1] == settings, name
        atol = EXACT * size if is_moved else 0
        np.testing.assert_allclose(now.keys[name][0], moves, rtol=0, atol=atol, err_msg=name)
    assert now.drivers == before.drivers, (now.drivers, before.drivers)
    assert now.driven == before.driven, (now.driven, before.driven)
    for frame, one, other in zip(FRAMES, now.poses, before.poses, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=exact, err_msg=f"frame {frame}")
    np.testing.assert_allclose(now.places, before.places, rtol=0, atol=exact)
    np.testing.assert_array_equal(now.uvs, before.uvs)
    for name, weights in before.weights.items():
        np.testing.assert_array_equal(now.weights[name], weights, err_msg=name)
    for name, values in before.attributes.items():
        assert (is_moved and name in SHAPE) or now.attributes.get(name) == values, name
    assert now.chosen == before.chosen, (now.chosen, before.chosen)
    for suffix, parts in before.exports.items():
        assert now.exports[suffix].keys() == parts.keys()
        for name, part in parts.items():
            if is_moved and name.startswith(("Basis", "frame")):
                continue  # files have no masks
            found = now.exports[suffix][name]
            np.testing.assert_allclose(
                found, part, rtol=0, atol=ROUNDED * size, err_msg=f"{suffix}: {name}"
            )


def _key(key: bpy.types.ShapeKey) -> tuple[np.ndarray, tuple[Any, ...]]:
    moves = coordinates(key.points) - coordinates(key.relative_key.points)
    settings = (
        key.relative_key.name, key.mute, key.vertex_group, key.slider_min, key.slider_max,
        key.interpolation, key.lock_shape,
    )  # fmt: skip
    return moves, settings


def _drivers(obj: bpy.types.Object, names: list[str]) -> list[bpy.types.FCurve]:
    keys = obj.data.shape_keys
    found = keys.animation_data.drivers if keys and keys.animation_data else ()
    return [each for each in found if each.data_path.split('"')[1] in names]


def _driver(curve: bpy.types.FCurve) -> tuple[Any, ...]:
    driver = curve.driver
    targets = [
        (variable.name, variable.type, each.id and each.id.name, each.data_path, each.bone_target,
         each.transform_type, each.transform_space)
        for variable in driver.variables for each in variable.targets
    ]  # fmt: skip
    return curve.data_path, driver.type, driver.expression, curve.mute, driver.is_valid, targets


def _uvs(mesh: bpy.types.Mesh) -> np.ndarray:
    flat = np.empty(2 * len(mesh.loops), dtype=np.float32)
    mesh.uv_layers.active.data.foreach_get("uv", flat)
    return flat.reshape(-1, 2)


def _weights(obj: bpy.types.Object, name: str) -> np.ndarray:
    index = obj.vertex_groups[name].index
    return np.array(
        [sum(g.weight for g in v.groups if g.group == index) for v in obj.data.vertices]
    )


def _attributes(mesh: bpy.types.Mesh) -> dict[str, Any]:
    """Those that are not 0 everywhere: Edit Mode removes some of the others, and adds some."""
    found = {
        name: values
        for name, values in contents.of_mesh(mesh).items()
        if name.startswith("attribute ") and name not in SELECTED and any(values)
    }
    color = mesh.color_attributes.default_color_name
    return {**found, "color of renders": color} if color else found


def _exported(
    obj: bpy.types.Object, folder: Path, suffix: str, names: list[str]
) -> dict[str, np.ndarray]:
    """What a file has of the object by corners, as its vertices may be split: its Basis, what keys
    of these names do, its UV map; and its poses, where the format has them."""
    path = folder / f"it{suffix}"
    for each in list(bpy.context.view_layer.objects):
        each.select_set(each in (obj, bpy.data.objects["Rig"]))
    if suffix == ".glb":
        bpy.ops.export_scene.gltf(filepath=str(path), use_selection=True)
    else:
        bpy.ops.export_scene.fbx(
            filepath=str(path), use_selection=True, use_mesh_modifiers=False, bake_anim=False
        )
    blocks = bpy.data.user_map()
    active = bpy.context.view_layer.objects.active
    try:
        if suffix == ".glb":
            bpy.ops.import_scene.gltf(filepath=str(path))
        else:
            bpy.ops.import_scene.fbx(filepath=str(path), use_anim=False)
        new = [each for each in bpy.data.objects if each not in blocks]
        (copy,) = [each for each in new if each.type == "MESH" and each.data.shape_keys]
        return _read(copy, names, is_posed=suffix == ".glb")
    finally:
        bpy.data.batch_remove([each for each in bpy.data.user_map() if each not in blocks])
        bpy.context.view_layer.objects.active = active
        bpy.context.scene.frame_set(FRAMES[0])


def _read(obj: bpy.types.Object, names: list[str], is_posed: bool) -> dict[str, np.ndarray]:
    mesh, keys = obj.data, obj.data.shape_keys.key_blocks
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    basis = coordinates(keys[0].points)
    found = {"Basis": basis[corners], "UV map": _uvs(mesh)}
    for name in names[1:]:
        found[name] = (coordinates(keys[name].points) - basis)[corners]
    for frame in FRAMES if is_posed else ():
        bpy.context.scene.frame_set(frame)
        found[f"frame {frame}"] = evaluated(obj)[corners]
    return found
