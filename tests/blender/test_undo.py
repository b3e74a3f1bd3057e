"""Undo takes back what an operator did, all of it and nothing else; redo gives the same again."""

from __future__ import annotations

from tempfile import TemporaryDirectory

import bpy
import numpy as np
import pytest
from ball import ball
from contents import contents
from deform_scene import constrain, dumbbell_object, empty, handle

SMALL = {"bands": 3, "steps": 8}
RESET = {"preset": "RESET"}


def banded() -> bpy.types.Object:
    obj = ball("Banded")
    bpy.ops.spectral_tv.decompose(**SMALL)
    obj.data.shape_keys.key_blocks[2].value = 0.5
    return obj


def as_attributes() -> None:
    """The same with bands that are attributes."""
    banded()
    bpy.ops.spectral_tv.convert_bands(to="ATTRIBUTES")
    bpy.ops.spectral_tv.fill_mask(band=1, source="GROUP", group="Cap")


def masked() -> None:
    """The same with a mask, and a group that is not one."""
    banded()
    bpy.ops.spectral_tv.fill_mask(band=1, source="GROUP", group="Cap")


def segmented() -> None:
    ball("Ball")
    bpy.ops.spectral_tv.cosegment(segments=3, steps=8)


def twice() -> None:
    """A ball with two decompositions, both with a filter."""
    banded()
    bpy.ops.spectral_tv.decompose(method="M2", **SMALL)
    bpy.context.object.data.shape_keys.key_blocks[5].value = 0.5


def subdivided() -> None:
    banded().modifiers.new("Subdivision", "SUBSURF")


def pair() -> None:
    """Two selected balls with bands, the active one with a filter."""
    for name in ("Other", "Banded"):
        obj = ball(name)
        bpy.ops.spectral_tv.decompose(**SMALL)
    obj.data.shape_keys.key_blocks[1].value = 2


def dressed() -> None:
    """A selected ball with bands, the active one, in a larger ball."""
    shirt = ball("Shirt")
    for vertex in shirt.data.vertices:
        vertex.co *= 1.05
    banded()


def with_bones() -> None:
    """A ball with bands and a filter, the active one, and a selected armature."""
    bpy.ops.object.armature_add()
    banded().data.shape_keys.key_blocks[3].value = 1


def held() -> bpy.types.Object:
    """A dumbbell that has been pulled at."""
    obj = dumbbell_object()
    constrain(obj, "Feet", "PIN")
    constrain(obj, "Head", "OBJECT", target=empty((0, 0, 2)))
    handle(obj).location.x = 0.5
    obj.spectral_tv.active = 1
    bpy.context.view_layer.update()
    return obj


def posed() -> None:
    """The same, with pieces that turn."""
    held().spectral_tv.algorithm = "POSE"


def rigged() -> None:
    """The same, with an armature that was made of it, and another pose."""
    posed()
    obj = bpy.context.object
    bpy.ops.spectral_tv.deform()
    bpy.ops.spectral_tv.rig_from_pose()
    handle(obj).location.y = 0.5


def plotted() -> None:
    ball("Ball")
    bpy.ops.spectral_tv.plot_values(kind="GROUP", source="Cap", steps=4)


def torn() -> None:
    """A ball with a vertex nowhere, which was refused."""
    ball("Torn").data.vertices[5].co.x = float("nan")
    with pytest.raises(RuntimeError, match="vertex 5"):
        bpy.ops.spectral_tv.decompose(**SMALL)


def unwrapped() -> None:
    """A ball with bands and UVs."""
    banded().data.uv_layers.new()


def sculpted() -> bpy.types.Object:
    """A cube with two levels of Multiresolution."""
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    obj.modifiers.new("Multires", "MULTIRES")
    for _ in range(2):
        bpy.ops.object.multires_subdivide(modifier="Multires", mode="CATMULL_CLARK")
    return obj


def worked_on() -> None:
    """The work object of the same, filtered."""
    sculpted()
    bpy.ops.spectral_tv.decompose(shape="MULTIRES", **SMALL)
    bpy.context.object.data.shape_keys.key_blocks[3].value = 1


def photo() -> None:
    """An image of noise, and no object."""
    image = bpy.data.images.new("Photo", 16, 12)
    image.pixels.foreach_set(np.random.default_rng(0).random(16 * 12 * 4).astype(np.float32))
    image.pack()


# For every operator what there is before, and its arguments.
# For what is written beside the file's contents.
FOLDER = TemporaryDirectory(prefix="spectral_tv_tests_")
CASES = {
    "add_curve": (banded, {}),
    "apply_look": (banded, {}),
    "apply_modifier": (subdivided, {}),
    "apply_curve": (banded, {}),
    "bake": (banded, {}),
    "bake_filter": (banded, {"frame_end": 2, "filepath": f"{FOLDER.name}/cache.pc2"}),
    "bake_map": (unwrapped, {"size": 16, "filepath": f"{FOLDER.name}/map.exr", "material": True}),
    "bake_safe": (banded, {}),
    "bake_deformation": (held, {"frame_end": 3}),
    "blur_mask": (masked, {"radius": 10}),
    "caricature": (lambda: (ball("One"), ball("Two")), {"bands": 3, "steps": 8, "last": 3}),
    "carry_along": (dressed, {}),
    "choose_mask": (banded, {"group": "Cap"}),
    "constraint_add": (dumbbell_object, {"kind": "OBJECT"}),
    "constraint_remove": (held, {}),
    "constraint_rest": (held, {}),
    "convert_bands": (banded, {"to": "ATTRIBUTES"}),
    "copy_filter": (pair, {}),
    "copy_mask": (masked, {}),
    "cosegment": (lambda: ball("Ball"), {"segments": 3, "steps": 8}),
    "cut": (banded, {"bands": 2}),
    "decompose": (lambda: ball("Ball"), SMALL),
    "deform": (held, {}),
    "fill_mask": (banded, {"source": "GROUP", "group": "Cap"}),
    "filter": (banded, {}),
    "filter_image": (photo, {"image": "Photo", "result": "BANDS", **SMALL}),
    "flow_attribute": (lambda: ball("Ball"), {"kind": "GROUP", "source": "Cap", "steps": 4}),
    "hold_and_pull": (
        dumbbell_object,
        {
            "held": [{"name": "", "point": (0, 0, -2.468), "radius": 0.5}],
            "pulled": [{"name": "", "point": (0, 0, 2.468), "radius": 0.5}],
        },
    ),
    "invert_mask": (masked, {}),
    "keyframe": (banded, {}),
    "limit_movement": (banded, {"limit": 0.001}),
    "measure_accuracy": (banded, {"bands": 2, "steps": 8}),
    "measure_deviation": (banded, {}),
    "measure_thickness": (lambda: ball("Ball"), {}),
    "own_mask": (lambda: masked() or bpy.ops.spectral_tv.choose_mask(group="Cap"), {}),
    "paint_mask": (banded, {}),
    "pick_size": (lambda: ball("Ball"), {"option": "largest", "size": 0.4}),
    "plot_values": (lambda: ball("Ball"), {"kind": "GROUP", "source": "Cap", "steps": 4}),
    "recipe": (lambda: ball("Ball"), {"recipe": "Caricature"}),
    "refit_armature": (with_bones, {}),
    "remove_decomposition": (twice, {"name": "Shape Detail"}),
    "remove_mask": (masked, {}),
    "rig_from_pose": (posed, {}),
    "select_faulty": (torn, {}),
    "show_original": (banded, {}),
    "solo": (banded, {"band": 2}),
    "split_segments": (segmented, {}),
    "switch_decomposition": (twice, {"name": "Shape Detail"}),
    "take_bands": (pair, {"first": 1, "last": 2}),
    "take_settings": (banded, {}),
    "test_eigenset": (lambda: ball("Ball"), {"group": "Cap"}),
    "widen_sliders": (banded, {}),
    "work_object": (sculpted, {}),
    "write_back": (worked_on, {}),
    "write_heights": (banded, {}),
}
# Those that change nothing in the file.
WITHOUT_STEP = {
    "cancel",
    "count_folds",
    "export_values",
    "recipe_export",
    "recipe_import",
    "recipe_preset",
}
# What can be done in a window alone; tests/window does it.
IN_WINDOWS = {"cancel", "deform_live"}


@pytest.fixture(autouse=True)
def _nothing_left():
    yield
    bpy.data.batch_remove([*bpy.data.images, *bpy.data.texts, *bpy.data.node_groups])


def test_every_operator_has_its_case():
    operators = set(dir(bpy.ops.spectral_tv))
    assert operators == CASES.keys() | WITHOUT_STEP | IN_WINDOWS
    for name in operators:
        options = getattr(bpy.ops.spectral_tv, name).bl_options
        assert ("UNDO" in options) == (name not in WITHOUT_STEP), name


def run(name: str, arguments: dict) -> None:
    """Run an operator as a button does, which makes its own step of undo."""
    operator = getattr(bpy.ops.spectral_tv, name)
    assert operator("EXEC_DEFAULT", True, **arguments) == {"FINISHED"}


@pytest.mark.parametrize("name", CASES)
def test_one_step_takes_all_of_it_back(name):
    one_step_takes_all_back(name, *CASES[name])


@pytest.mark.parametrize("name", ["apply_look", "decompose", "filter"])
def test_one_step_takes_what_is_done_to_several_decompositions_back(name):
    arguments = {"decompose": {"method": "M2", "bands": 2, "steps": 9}, "filter": RESET}
    one_step_takes_all_back(name, twice, arguments.get(name, {}))


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("apply_look", {}),
        ("convert_bands", {"to": "KEYS"}),
        ("copy_mask", {}),
        ("cut", {"bands": 2}),
        ("decompose", {"method": "M2", **SMALL}),
        ("filter", {}),
        ("keyframe", {}),
        ("remove_decomposition", {}),
        ("solo", {"band": 2}),
        ("widen_sliders", {}),
        ("write_heights", {}),
    ],
)
def test_one_step_takes_back_what_is_done_to_attributes(name, arguments):
    one_step_takes_all_back(name, as_attributes, arguments)


def other_vertices() -> None:
    """A ball with bands, and the active one without, of other vertices, part of which is far."""
    banded()
    finer = ball("Finer", 3)
    for vertex in finer.data.vertices[:40]:
        vertex.co *= 2


def test_one_step_takes_bands_of_another_topology_back():
    one_step_takes_all_back("take_bands", other_vertices, {"first": 1, "last": 3})


@pytest.mark.parametrize("name", ["deform", "bake_deformation"])
def test_one_step_takes_poses_back(name):
    one_step_takes_all_back(name, posed, CASES[name][1])


def test_one_step_takes_a_rig_in_the_place_of_another_back():
    one_step_takes_all_back("rig_from_pose", rigged, {})


def one_step_takes_all_back(name: str, prepare, arguments: dict) -> None:
    prepare()
    bpy.ops.ed.undo_push(message="before")
    before = contents()
    run(name, arguments)
    after = contents()
    if name != "test_eigenset":
        assert after != before
    for _ in range(2):
        bpy.ops.ed.undo()
        assert contents() == before
        bpy.ops.ed.redo()
        assert contents() == after
    bpy.ops.ed.undo()
    run(name, arguments)  # as Adjust Last Operation does
    assert contents() == after


@pytest.mark.parametrize("name", ["deform", "bake_deformation", "constraint_rest"])
def test_hidden_handles_are_followed_in_the_same_step(name):
    """What moves them meanwhile is gone."""
    held()
    handle(bpy.context.object).hide_viewport = True
    bpy.ops.ed.undo_push(message="before")
    before = contents()
    run(name, CASES[name][1])
    after = contents()
    assert after != before and len(bpy.data.objects) == 2
    bpy.ops.ed.undo()
    assert contents() == before
    bpy.ops.ed.redo()
    assert contents() == after


def test_constraints_made_in_edit_mode_are_undone_there():
    body = dumbbell_object()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.ed.undo_push(message="before")
    before = contents()
    run("constraint_add", {"kind": "OBJECT"})
    after = contents()
    assert len(after[f"object {body.name}"]["groups"]) == 3
    bpy.ops.ed.undo()
    assert contents() == before
    bpy.ops.ed.redo()
    assert contents() == after
    assert bpy.context.object.mode == "EDIT"


def test_a_refused_operator_leaves_nothing_and_takes_no_step():
    banded()
    bpy.ops.ed.undo_push(message="before")
    bpy.context.object.data.shape_keys.key_blocks[1].value = 0.75
    bpy.ops.ed.undo_push(message="value")
    before = contents()
    for name, arguments in (
        ("decompose", {"bands": 9, "steps": 8}),
        ("cut", {"bands": 30}),
        ("take_bands", {}),
        ("copy_filter", {}),
        ("paint_mask", {"band": 9}),
        ("blur_mask", {}),
        ("fill_mask", {"source": "GROUP", "group": "Nothing"}),
        ("split_segments", {}),
        ("flow_attribute", {"kind": "KEY", "source": "Nothing"}),
        ("measure_accuracy", {"bands": 9, "steps": 8}),
        ("cosegment", {"outputs": set()}),
        ("test_eigenset", {"group": "Nothing"}),
        (
            "plot_values",
            {"kind": "GROUP", "source": "Cap", "steps": 4, "filepath": "/nowhere/values.csv"},
        ),
    ):
        try:
            status = getattr(bpy.ops.spectral_tv, name)("EXEC_DEFAULT", True, **arguments)
        except RuntimeError:
            status = {"CANCELLED"}
        assert status == {"CANCELLED"}, name
        assert contents() == before, name
    bpy.ops.ed.undo()
    assert bpy.context.object.data.shape_keys.key_blocks[1].value == 0
