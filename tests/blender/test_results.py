"""What the user made is never taken for a result; what is written is whole or not there."""

from __future__ import annotations

from importlib import import_module
from typing import ClassVar

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import object_of
from conftest import MODULE
from contents import contents, differences
from shapes import icosphere
from spectral_tv.bands.settings import Settings
from spectral_tv.refusal import Refusal

VERTICES, FACES = icosphere(3)
CAP = VERTICES[:, 2] > 0.5
flow = bpy.ops.spectral_tv.flow_attribute
FEW = {"steps": 4}


@pytest.fixture
def sphere():
    """A unit sphere with a vertex group, a float attribute and a shape key, each of its cap."""
    obj = object_of("Sphere", VERTICES, FACES)
    mesh = obj.data
    obj.vertex_groups.new(name="Cap").add(np.flatnonzero(CAP).tolist(), 1, "REPLACE")
    mesh.attributes.new("Mask", "FLOAT", "POINT").data.foreach_set("value", CAP.astype(np.float32))
    obj.shape_key_add(name="Basis")
    lift = obj.shape_key_add(name="Lift", from_mix=False)
    for vertex in np.flatnonzero(CAP).tolist():
        lift.data[vertex].co.z += 0.5
    yield obj
    bpy.data.batch_remove([*bpy.data.texts, *bpy.data.images])


def told(capfd) -> str:
    return capfd.readouterr().out


class Group:
    """Vertex groups, as the three kinds of results are handled below."""

    source: ClassVar = {"kind": "GROUP", "source": "Cap"}
    result = "Cap Flow"

    @staticmethod
    def all(obj):
        return obj.vertex_groups

    @staticmethod
    def new(obj, name):
        group = obj.vertex_groups.new(name=name)
        group.add([0, 1], 0.25, "REPLACE")
        return group

    @staticmethod
    def values(obj, name):
        index = obj.vertex_groups[name].index
        return [sum(m.weight for m in v.groups if m.group == index) for v in obj.data.vertices]

    @staticmethod
    def change(obj, name):
        obj.vertex_groups[name].add([5], 0.75, "REPLACE")

    @staticmethod
    def lock(obj, name):
        obj.vertex_groups[name].lock_weight = True


class Attribute:
    """Float attributes."""

    source: ClassVar = {"kind": "ATTRIBUTE", "source": "Mask"}
    result = "Mask Flow"

    @staticmethod
    def all(obj):
        return obj.data.attributes

    @staticmethod
    def new(obj, name):
        attribute = obj.data.attributes.new(name, "FLOAT", "POINT")
        attribute.data[0].value = 0.25
        return attribute

    @staticmethod
    def values(obj, name):
        return [point.value for point in obj.data.attributes[name].data]

    @staticmethod
    def change(obj, name):
        obj.data.attributes[name].data[5].value = 0.75


class Key:
    """Shape keys."""

    source: ClassVar = {"kind": "KEY", "source": "Lift"}
    result = "Lift Flow"

    @staticmethod
    def all(obj):
        return obj.data.shape_keys.key_blocks

    @staticmethod
    def new(obj, name):
        key = obj.shape_key_add(name=name, from_mix=False)
        key.data[0].co.z += 0.25
        return key

    @staticmethod
    def values(obj, name):
        return [tuple(point.co) for point in obj.data.shape_keys.key_blocks[name].data]

    @staticmethod
    def change(obj, name):
        obj.data.shape_keys.key_blocks[name].data[5].co.x += 0.01

    @staticmethod
    def lock(obj, name):
        obj.data.shape_keys.key_blocks[name].lock_shape = True


each_kind = pytest.mark.parametrize("kind", [Group, Attribute, Key])


@each_kind
def test_a_renamed_result_is_written_over(sphere, kind):
    flow(**kind.source, size=5, **FEW)
    kind.all(sphere)[kind.result].name = "Soft"
    before, names = kind.values(sphere, "Soft"), set(kind.all(sphere).keys())
    flow(**kind.source, size=50, **FEW)
    assert set(kind.all(sphere).keys()) == names
    assert kind.values(sphere, "Soft") != before


@each_kind
def test_another_thing_with_the_name_of_a_result_is_left_alone(sphere, kind):
    flow(**kind.source, size=5, **FEW)
    kind.all(sphere)[kind.result].name = "Soft"
    kind.new(sphere, kind.result)
    soft, own = (kind.values(sphere, name) for name in ("Soft", kind.result))
    flow(**kind.source, size=50, **FEW)
    assert kind.values(sphere, kind.result) == own
    assert kind.values(sphere, "Soft") != soft


@each_kind
def test_one_in_the_place_of_a_deleted_result_is_left_alone(sphere, kind):
    flow(**kind.source, size=5, **FEW)
    found = kind.all(sphere)[kind.result]
    sphere.shape_key_remove(found) if kind is Key else kind.all(sphere).remove(found)
    kind.new(sphere, kind.result)
    own = kind.values(sphere, kind.result)
    flow(**kind.source, size=50, **FEW)
    assert kind.values(sphere, kind.result) == own
    assert f"{kind.result}.001" in kind.all(sphere)


@each_kind
def test_a_result_that_was_changed_is_kept_and_that_is_told(sphere, kind, capfd):
    flow(**kind.source, size=5, **FEW)
    kind.change(sphere, kind.result)
    own = kind.values(sphere, kind.result)
    told(capfd)
    flow(**kind.source, size=50, **FEW)
    said = told(capfd)
    assert f"{kind.result!r} was changed since, and is kept" in said
    assert f"written as '{kind.result}.001'" in said
    assert kind.values(sphere, kind.result) == own
    # From now on the new one is the result, and the other is nobody's.
    flow(**kind.source, size=20, **FEW)
    assert "changed" not in told(capfd)
    assert f"{kind.result}.002" not in kind.all(sphere)


@pytest.mark.parametrize("kind", [Group, Key])
def test_a_locked_result_is_kept_and_that_is_told(sphere, kind, capfd):
    flow(**kind.source, size=5, **FEW)
    kind.lock(sphere, kind.result)
    own = kind.values(sphere, kind.result)
    flow(**kind.source, size=50, **FEW)
    assert f"{kind.result!r} is locked, and is kept" in told(capfd)
    assert kind.values(sphere, kind.result) == own


def copy_key(obj, name, new_name):
    key = obj.shape_key_add(name=new_name, from_mix=False)
    for point, co in zip(key.data, Key.values(obj, name), strict=True):
        point.co = co
    return key


def test_of_copies_the_one_with_the_name_is_the_result(sphere):
    flow(**Key.source, size=5, **FEW)
    copy_key(sphere, "Lift Flow", "Keep")
    own = Key.values(sphere, "Keep")
    flow(**Key.source, size=50, **FEW)
    assert Key.values(sphere, "Keep") == own != Key.values(sphere, "Lift Flow")


def test_of_renamed_copies_neither_is_the_result(sphere):
    flow(**Key.source, size=5, **FEW)
    copy_key(sphere, "Lift Flow", "Keep")
    sphere.data.shape_keys.key_blocks["Lift Flow"].name = "Keep too"
    own = Key.values(sphere, "Keep")
    flow(**Key.source, size=50, **FEW)
    assert Key.values(sphere, "Keep") == Key.values(sphere, "Keep too") == own
    assert Key.values(sphere, "Lift Flow") != own


def test_bands_that_were_changed_outlive_fewer_bands(sphere, capfd):
    flow(**Attribute.source, result="BANDS", bands=4, steps=8)
    Attribute.change(sphere, "Mask Band 4")
    Attribute.new(sphere, "Mask Band 9")
    own = Attribute.values(sphere, "Mask Band 4")
    flow(**Attribute.source, result="BANDS", bands=2, steps=8)
    names = {each.name for each in sphere.data.attributes if each.name.startswith("Mask")}
    assert names == {"Mask", "Mask Rest", *(f"Mask Band {band}" for band in (1, 2, 4, 9))}
    assert Attribute.values(sphere, "Mask Band 4") == own
    assert "'Mask Band 4' was changed since, and is kept" in told(capfd)


def test_a_result_of_a_sculpted_mesh_is_known_again(sphere):
    """Where Basis is moved Blender moves all keys along, which rounds them."""
    flow(**Key.source, size=5, **FEW)
    bpy.ops.object.mode_set(mode="EDIT")
    sphere.active_shape_key_index = 0
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.translate(value=(0.1, 0.23, 0.37))
    bpy.ops.object.mode_set(mode="OBJECT")
    flow(**Key.source, size=50, **FEW)
    names = [key.name for key in sphere.data.shape_keys.key_blocks]
    assert names == ["Basis", "Lift", "Lift Flow"]


def test_a_duplicated_object_has_results_of_its_own(sphere):
    flow(**Attribute.source, size=5, **FEW)
    twin = sphere.copy()
    twin.data = sphere.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    before = Attribute.values(sphere, "Mask Flow")
    bpy.context.view_layer.objects.active = twin
    flow(**Attribute.source, size=50, **FEW)
    assert "Mask Flow.001" not in twin.data.attributes
    assert Attribute.values(twin, "Mask Flow") != before == Attribute.values(sphere, "Mask Flow")


# Names.


def test_groups_and_attributes_do_not_take_each_others_names(sphere):
    Group.new(sphere, "Mask Flow")
    Attribute.new(sphere, "Cap Flow")
    flow(**Attribute.source, size=5, **FEW)
    flow(**Group.source, size=5, **FEW)
    assert "Mask Flow.001" in sphere.data.attributes and "Mask Flow" not in sphere.data.attributes
    assert "Cap Flow.001" in sphere.vertex_groups and "Cap Flow" not in sphere.vertex_groups
    flow(**Attribute.source, result="BANDS", bands=2, steps=8)
    assert {"Mask Band 1", "Mask Band 2", "Mask Rest"} <= set(sphere.data.attributes.keys())


@each_kind
@pytest.mark.parametrize("letter", ["x", "é", "形", "🙂"])
def test_long_names_keep_what_the_result_is(sphere, kind, letter):
    """Cut between letters, however many bytes one has."""
    source = letter * (63 // len(letter.encode()))
    kind.all(sphere)[kind.source["source"]].name = source
    for _ in range(2):
        flow(kind=kind.source["kind"], source=source, size=5, **FEW)
    flow(kind=kind.source["kind"], source=source, result="BANDS", bands=2, steps=8)
    bands = kind if kind is Key else Attribute
    flowed, one, two, rest = (
        [each.name for each in all_of if each.name.startswith(letter) and each.name.endswith(end)]
        for end, all_of in (
            (" Flow", kind.all(sphere)),
            *((each, bands.all(sphere)) for each in (" Band 1", " Band 2", " Rest")),
        )
    )
    assert len(flowed) == len(one) == len(two) == len(rest) == 1
    for name in (*flowed, *one, *two, *rest):
        assert len(name.encode()) <= 63 and set(name.split(" ")[0]) == {letter}


def test_bands_of_a_mesh_with_a_long_name_are_numbered(sphere):
    sphere.name = "s" * 63
    for name in ("A" * 63, "B" * 63):
        sphere.shape_key_add(name=name)
    bpy.ops.spectral_tv.measure_accuracy(bands=2, steps=8)
    assert sphere.data.spectral_tv.accuracy is not None


# What fails.


def test_what_fails_leaves_nothing_behind(sphere):
    whole = import_module(f"{MODULE}.scene.whole").whole
    sphere.vertex_groups.active_index = 0
    before = contents()
    with pytest.raises(ZeroDivisionError), whole(sphere):
        Group.new(sphere, "New")
        Attribute.new(sphere, "Newer")
        Key.new(sphere, "Newest")
        bpy.data.texts.new("Text")
        bpy.data.images.new("Image", 4, 4)
        sphere.vertex_groups.active_index = 1
        sphere.active_shape_key_index = 2
        raise ZeroDivisionError
    assert differences(before, contents()) == []
    sphere.shape_key_clear()
    with pytest.raises(ZeroDivisionError), whole(sphere):
        sphere.shape_key_add(name="Basis")
        raise ZeroDivisionError
    assert sphere.data.shape_keys is None


def test_keys_are_added_all_or_none(sphere):
    """Bands are worked out one by one, and any may not fit into the memory."""
    add = import_module(f"{MODULE}.scene.shape_keys").add_displacements

    def displacements():
        yield np.zeros_like(VERTICES)
        raise MemoryError

    before = contents()
    with pytest.raises(MemoryError):
        add(sphere, ["One", "Two"], displacements())
    assert differences(before, contents()) == []


@pytest.mark.parametrize("name", ["material_index", "sharp_edge", "uv_seam"])
def test_a_name_that_blender_refuses_is_told_and_nothing_is_written(sphere, name):
    """Some attributes can be of one type alone; of another they would end some versions."""
    results = import_module(f"{MODULE}.scene.results")
    pieces = {
        label: results.Piece("ATTRIBUTE", np.zeros(len(VERTICES)), "FLOAT")
        for label in ("fine", name)
    }
    before = contents()
    with pytest.raises(Refusal, match=name):
        results.write(sphere, "TEST", "", pieces, wanted=lambda _source, label: (label, ""))
    assert differences(before, contents()) == []


# Segments.


def face_sets(obj, name=".sculpt_face_set") -> np.ndarray:
    values = np.empty(len(obj.data.polygons), dtype=np.int32)
    obj.data.attributes[name].data.foreach_get("value", values)
    return values


def test_segments_leave_own_groups_and_colors_alone(sphere):
    sphere.select_set(True)
    for name in ("Segment 2", "Segment 11"):
        Group.new(sphere, name)
    sphere.data.color_attributes.new("Segment", "BYTE_COLOR", "CORNER")
    own = [Group.values(sphere, name) for name in ("Segment 2", "Segment 11")]
    for segments in (3, 2):
        bpy.ops.spectral_tv.cosegment(segments=segments, steps=8)
    assert [Group.values(sphere, name) for name in ("Segment 2", "Segment 11")] == own
    assert [group.name for group in sphere.vertex_groups] == [
        "Cap", "Segment 2", "Segment 11", "Segment 1", "Segment 2.001",
    ]  # fmt: skip
    assert sphere.data.color_attributes["Segment"].domain == "CORNER"
    assert sphere.data.color_attributes.active_color.name == "Segment.001"


def test_own_face_sets_are_kept_as_an_attribute(sphere, capfd):
    sphere.select_set(True)
    own = np.arange(len(FACES), dtype=np.int32) % 12
    sphere.data.attributes.new(".sculpt_face_set", "INT", "FACE").data.foreach_set("value", own)
    for segments in (3, 2):
        bpy.ops.spectral_tv.cosegment(segments=segments, steps=8, outputs={"FACE_SETS"})
    assert set(face_sets(sphere)) == {1, 2}
    np.testing.assert_array_equal(face_sets(sphere, "Face Sets"), own)
    assert told(capfd).count("12 face sets were replaced; the attribute 'Face Sets' keeps") == 1
    assert "Face Sets.001" not in sphere.data.attributes


# Texts and images.


def plot(obj) -> None:
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.plot_values(kind="GROUP", source="Cap", groups="Cap", steps=4)


def test_texts_and_images_that_were_changed_are_kept(sphere, capfd):
    plot(sphere)
    kept = sphere.data.spectral_tv
    text, image = kept.table, kept.picture
    text.write("mine")
    image.pixels[0] = 0.75
    mine = text.as_string()
    plot(sphere)
    said = told(capfd)
    assert "the text 'Cap Values.csv' was changed since, and is kept" in said
    assert "the image 'Cap Values' was changed since, and is kept" in said
    assert text.as_string() == mine and text.use_fake_user and image.use_fake_user
    assert kept.table.name == "Cap Values.csv.001" and kept.picture != image


def test_texts_keep_the_names_that_the_user_gave(sphere):
    plot(sphere)
    kept = sphere.data.spectral_tv
    kept.table.name, text = "Mine", kept.table
    plot(sphere)
    assert kept.table == text and text.name == "Mine"


def test_a_duplicated_mesh_writes_texts_and_images_of_its_own(sphere):
    plot(sphere)
    kept = sphere.data.spectral_tv
    text, image, table = kept.table, kept.picture, kept.table.as_string()
    copied = text.copy()
    twin = sphere.copy()
    twin.data = sphere.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    for vertex in twin.data.vertices:
        vertex.co.z *= 3
    for key in twin.data.shape_keys.key_blocks:
        for point in key.data:
            point.co.z *= 3
    plot(twin)
    assert (kept.table, kept.picture) == (text, image) and text.as_string() == table
    assert twin.data.spectral_tv.table.as_string() != table
    assert copied.as_string() == table
    plot(sphere)
    assert kept.table == text


def test_an_own_text_is_no_table_of_errors(sphere):
    own = bpy.data.texts.new("Sphere Accuracy.csv")
    own.write("mine")
    for _ in range(2):
        bpy.ops.spectral_tv.measure_accuracy(bands=2, steps=8)
    assert own.as_string() == "mine" and own.name == "Sphere Accuracy.csv"
    assert [text.name for text in bpy.data.texts] == [own.name, "Sphere Accuracy.csv.001"]


def test_a_decomposition_that_fails_leaves_the_bands_that_were_there(sphere):
    bands = import_module(f"{MODULE}.bands.bands")
    adding = import_module(f"{MODULE}.bands.adding")
    whole = import_module(f"{MODULE}.scene.whole").whole
    bpy.ops.spectral_tv.decompose(bands=2, steps=6)
    before = contents()
    chosen = Settings(bands=3, steps=6, into="ADD")
    surface, arguments = bands.prepare(sphere, chosen)
    split = spectral_tv.decompose(surface.mesh, **arguments)
    with pytest.raises(ZeroDivisionError), whole(sphere):
        adding.add_bands([adding.Part(sphere, surface, arguments, split)], chosen)
        raise ZeroDivisionError
    assert differences(before, contents()) == []
