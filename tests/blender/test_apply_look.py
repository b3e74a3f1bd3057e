"""bpy.ops.spectral_tv.apply_look: the mix of the bands as the shape itself."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import ball
from command_line_files import load, meshes, run, write_monkey
from contents import contents, differences
from deform_scene import coordinates, evaluated, key_positions
from rigged_body import add_face_keys, add_rig, poses


@pytest.fixture
def body():
    """A rigged, subdivided ball with a UV map, face keys, one of them driven, and bands."""
    obj = ball("Body")
    mesh = obj.data
    mesh.uv_layers.new(name="UV").data.foreach_set("uv", np.arange(2.0 * len(mesh.loops)) % 1)
    add_face_keys(obj)
    add_rig(obj)
    bpy.ops.spectral_tv.decompose(bands=3, steps=8, shape="BASIS")
    bands = [key for key in mesh.shape_keys.key_blocks if "Band" in key.name]
    bands[0].value, bands[1].value, bands[2].value = 1.5, -0.4, 0.7
    bands[2].vertex_group = "Cap"
    return obj


def test_what_is_seen_stays_on_every_frame_and_the_bands_go(body):
    before, seen = contents(), poses(body)
    names = [key.name for key in body.data.shape_keys.key_blocks if "Band" not in key.name]
    moves = {name: key_positions(body, name) - key_positions(body, "Basis") for name in names}
    assert bpy.ops.spectral_tv.apply_look() == {"FINISHED"}
    for one, other in zip(poses(body), seen, strict=True):
        np.testing.assert_allclose(one, other, atol=2e-6)
    assert body.data.shape_keys.key_blocks.keys() == names
    for name, move in moves.items():
        found = key_positions(body, name) - key_positions(body, "Basis")
        np.testing.assert_allclose(found, move, atol=1e-6)
    shape = coordinates(body.data.vertices)
    np.testing.assert_array_equal(shape, key_positions(body, "Basis"))
    smile = body.data.shape_keys.key_blocks["Smile"]
    assert body.data.shape_keys.key_blocks["Pout"].relative_key == smile
    assert len(body.data.shape_keys.animation_data.drivers) == 1
    changed = {name.split(":")[0] for name in differences(before, contents())}
    assert changed <= {"mesh Body", "object Body"}
    assert {"Bone", "Cap"} <= {*body.vertex_groups.keys()}
    with pytest.raises(RuntimeError, match="has no bands"):
        bpy.ops.spectral_tv.apply_look()
    assert bpy.ops.spectral_tv.decompose(bands=2, steps=8) == {"FINISHED"}


def test_a_copy_leaves_the_object_as_it_was(body):
    before, seen = contents(), poses(body)
    bpy.ops.spectral_tv.apply_look(place="COPY")
    copy = bpy.context.active_object
    assert copy.name == "Body Look" and body.hide_get() and body.data != copy.data
    assert body.hide_render and not copy.hide_render
    for one, other in zip(poses(copy), seen, strict=True):
        np.testing.assert_allclose(one, other, atol=2e-6)
    after = contents()
    assert not differences(before, {name: after[name] for name in before})


def test_without_other_keys_blender_can_apply_modifiers_again():
    obj = ball("Ball")
    obj.modifiers.new("Subdivision", "SUBSURF")
    bpy.ops.spectral_tv.decompose(bands=2, steps=8)
    obj.data.shape_keys.key_blocks[1].value = 1
    seen = evaluated(obj)
    bpy.ops.spectral_tv.apply_look()
    assert obj.data.shape_keys is None
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    np.testing.assert_allclose(coordinates(obj.data.vertices), seen, atol=2e-6)


def test_bands_that_do_nothing_are_refused(body):
    for key in body.data.shape_keys.key_blocks:
        if "Band" in key.name:
            key.mute = True
    before = contents()
    with pytest.raises(RuntimeError, match="the bands change nothing at their present values"):
        bpy.ops.spectral_tv.apply_look()
    body.show_only_shape_key = True
    with pytest.raises(RuntimeError, match="shows one shape key alone"):
        bpy.ops.spectral_tv.apply_look()
    body.show_only_shape_key = False
    assert not differences(before, contents())


@pytest.mark.parametrize("verb", ["recipe", "decompose"])
def test_the_command_line_writes_looks_without_bands(verb, tmp_path, capfd):
    source = write_monkey(tmp_path / "monkey.ply")
    own = {
        "recipe": ["--recipe", "Exaggerate Skin", "--strength", "2"],
        "decompose": ["--bands", "3", "--gain", "1=5", "--gain", "2=4", "--gain", "3=3", "--safe"],
    }[verb]
    shapes = []
    for name, more in (("dialled.blend", []), ("applied.blend", ["--apply"])):
        target = tmp_path / name
        assert run([verb, str(source), "-o", str(target), *own, *more]) == 0
        load(target)
        shapes.append(evaluated(meshes()[0]))
        assert (meshes()[0].data.shape_keys is None) == bool(more)
    np.testing.assert_allclose(shapes[1], shapes[0], atol=2e-6)
    assert "became the shape of 'monkey'" in capfd.readouterr().err
    assert run([verb, str(source), "-o", str(target), *own, "--apply", "--frames", "1-2"]) == 2
    assert "--apply is not for --frames" in capfd.readouterr().err
