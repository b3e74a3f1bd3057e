"""Maps over UVs: what UVs they need, where they are written, and that nothing else changes."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest
from conftest import MODULE
from contents import contents
from map_scene import DISPLACEMENTS, bake, refused, sphere_with_uvs, values_of

files = import_module(f"{MODULE}.maps.files")

pytestmark = pytest.mark.usefixtures("no_images")


# UVs that are not what maps need.


def move_uvs(obj, move) -> None:
    layer = obj.data.uv_layers[0].uv
    uvs = np.array([each.vector for each in layer])
    layer.foreach_set("vector", move(uvs).astype(np.float32).ravel())


def test_uvs_outside_the_square_are_refused(tmp_path):
    obj, path = sphere_with_uvs(), str(tmp_path / "map.exr")
    move_uvs(obj, lambda uvs: uvs + np.array([0.5, 0]))
    refused(r"triangles have UVs outside 0 to 1.*UDIM", filepath=path)
    move_uvs(obj, lambda uvs: uvs * np.nan)
    refused(r"triangles have UVs outside 0 to 1", filepath=path)
    move_uvs(obj, lambda uvs: np.full_like(uvs, 0.5))
    refused("no area", filepath=path)
    assert not list(tmp_path.iterdir())


def test_uvs_that_overlap_are_told(tmp_path, capfd):
    obj = sphere_with_uvs()
    bake(tmp_path / "map.exr", size=128)
    assert "of the UV map overlaps" not in capfd.readouterr().out
    move_uvs(obj, lambda uvs: np.where(uvs > 0.5, 1 - uvs, uvs))  # folded twice
    bake(tmp_path / "map.exr", size=128)
    assert "about 75% of the area of the UV map overlaps" in capfd.readouterr().out


def test_the_uv_map_of_renders_is_taken(tmp_path):
    obj = sphere_with_uvs()
    before = bake(tmp_path / "map.exr", kind="TANGENT")
    other = obj.data.uv_layers.new(name="Other")
    obj.data.uv_layers.active = other
    other.uv.foreach_set("vector", np.zeros(2 * len(obj.data.loops), dtype=np.float32))
    np.testing.assert_array_equal(bake(tmp_path / "map.exr", kind="TANGENT"), before)
    other.active_render = True
    refused("no area", filepath=str(tmp_path / "map.exr"))


def test_few_texels_and_flat_faces_are_told(tmp_path, capfd):
    obj = sphere_with_uvs()
    bake(tmp_path / "map.exr", size=32)
    assert "for 1986 vertices: the finest detail is not in the map" in capfd.readouterr().out
    obj.data.shade_flat()
    bake(tmp_path / "map.exr")
    out = capfd.readouterr().out
    assert "100% of the faces that have the UVs are shaded flat" in out and "finest" not in out


# Files, and what there is besides.


def test_a_file_that_cannot_be_written_is_refused(tmp_path, capfd):
    sphere_with_uvs()
    (tmp_path / "locked.exr").touch(0o444)
    for name, kind, match in (
        ("", "OBJECT", "save the .blend first"),
        ("//map.exr", "OBJECT", "save the .blend first"),
        (str(tmp_path / "nowhere" / "map.exr"), "OBJECT", "there is no folder"),
        (str(tmp_path / "map.jpg"), "NORMAL", "a map is an .exr, or a .png"),
        (str(tmp_path / "map.png"), "OBJECT", "which no .png holds"),
        (str(tmp_path / "locked.exr"), "OBJECT", "read-only"),
    ):
        refused(match, filepath=name, kind=kind)
    assert [each.name for each in tmp_path.iterdir()] == ["locked.exr"]
    bake(tmp_path / "map.exr")
    assert "written over" not in capfd.readouterr().out
    bake(tmp_path / "map.exr")
    assert "map.exr was written over" in capfd.readouterr().out


def test_it_lies_beside_the_blend_if_no_file_is_named(tmp_path):
    obj = sphere_with_uvs()
    obj.name = "A/B"
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "head.blend"))
    try:
        bpy.ops.spectral_tv.bake_map(size=16)
        bpy.ops.spectral_tv.bake_map(size=16, source="BAND", band=2, kind="TANGENT")
        bpy.ops.spectral_tv.bake_map(size=16, kind="NORMAL", filepath="//n.png", material=True)
        names = {each.name for each in tmp_path.iterdir()}
        assert names >= {
            "head_A_B_look_displacement.exr", "head_A_B_band_2_vector_tangent.exr", "n.png"
        }  # fmt: skip
        assert bpy.data.images["n.png"].filepath == "//n.png"
    finally:
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        bpy.context.scene.cycles.use_denoising = False


def everything() -> dict:
    """All that the user has, and how renders and bakes are set."""
    scene = bpy.context.scene
    kinds = [
        name
        for name in dir(bpy.data)
        if isinstance(getattr(bpy.data, name), bpy.types.bpy_prop_collection)
    ]
    return {
        **contents(),
        **{name: getattr(bpy.data, name).keys() for name in kinds},
        "selected": [obj.name for obj in bpy.context.selected_objects],
        "active": bpy.context.object.name,
        "scene": (scene.name, scene.render.engine, scene.cycles.samples, scene.cycles.device),
        "bake": [
            (name, getattr(scene.render.bake, name))
            for name in dict(scene.render.bake.bl_rna.properties)
            if name not in ("rna_type", "image_settings")
        ],
        "slots": [[slot.name for slot in obj.material_slots] for obj in bpy.data.objects],
    }


def test_nothing_changes_but_the_file(pair, tmp_path, monkeypatch):
    scene = bpy.context.scene
    scene.render.engine, scene.render.bake.margin = "BLENDER_WORKBENCH", 3
    scene.render.bake.use_selected_to_active = True
    pair[1].data.materials.append(bpy.data.materials.new("Own"))
    before = everything()
    path = str(tmp_path / "map.exr")
    for kind in (*DISPLACEMENTS, "NORMAL"):
        for source in ("LOOK", "BAND"):
            bpy.ops.spectral_tv.bake_map(
                size=32, kind=kind, source=source, onto="OTHER", filepath=path
            )
            assert everything() == before
    refused("within", onto="OTHER", distance=1e-6, filepath=path)
    assert everything() == before
    texels = import_module(f"{MODULE}.maps.texels")
    monkeypatch.setattr(texels, "MOST_FACES", 1000)  # the second of two bakes is refused
    refused("up to 1000 triangles", onto="OTHER", filepath=path)
    assert everything() == before
    (tmp_path / "map.exr").unlink()
    monkeypatch.undo()
    monkeypatch.setitem(files.FORMATS, ".exr", ("OPEN_EXR", "32", -1.0))  # no file is exact enough
    refused("cannot be written: it holds other values", onto="OTHER", filepath=path)
    assert everything() == before and not list(tmp_path.iterdir())


@pytest.mark.parametrize("kind", [*DISPLACEMENTS, "NORMAL"])
def test_the_material_leaves_those_of_the_mesh(kind, pair, tmp_path, capfd):
    low = pair[1]
    own = bpy.data.materials.new("Own")
    low.data.materials.append(own)
    bake(tmp_path / "map.exr", kind=kind, onto="OTHER", material=True)
    (slot,) = low.material_slots
    assert (
        slot.link == "OBJECT" and slot.material.name == "Low Map" and low.data.materials[0] == own
    )
    out = capfd.readouterr().out
    assert "in the place of Own; Link: Data" in out
    assert ("A Subdivision modifier gives it more" in out) == (kind != "NORMAL")
    (node,) = (each for each in slot.material.node_tree.nodes if each.type == "TEX_IMAGE")
    assert node.image.colorspace_settings.is_data
    assert Path(bpy.path.abspath(node.image.filepath)).resolve() == tmp_path / "map.exr"
    # Again: the image is that of the file by now.
    again = bake(tmp_path / "map.exr", kind=kind, onto="OTHER", material=True, size=64)
    assert tuple(node.image.size) == (64, 64) and len(bpy.data.images) == 1
    flat = np.empty(64 * 64 * 4, dtype=np.float32)
    node.image.pixels.foreach_get(flat)
    np.testing.assert_array_equal(flat.reshape(64, 64, 4)[..., :3], again.astype(np.float32))
    assert values_of(tmp_path / "map.exr").shape == (64, 64, 3)


def test_bands_at_rest_and_numbers_that_there_are_not_are_refused(tmp_path):
    obj, path = sphere_with_uvs(), str(tmp_path / "map.exr")
    refused("it has no band 9", source="BAND", band=9, filepath=path)
    bpy.ops.spectral_tv.show_original()
    refused("original is shown", filepath=path)
    bpy.ops.spectral_tv.show_original()
    bpy.ops.spectral_tv.filter(preset="RESET")
    refused("change nothing at their present values", filepath=path)
    obj.shape_key_remove(obj.data.shape_keys.key_blocks[2])
    refused("band 2 was deleted", source="BAND", band=2, filepath=path)
