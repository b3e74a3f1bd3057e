"""Which tables and plots are results: what the user made, changed or copied is kept."""

from __future__ import annotations

import bpy
import kinds_of_results
from kinds_of_results import told

sphere = kinds_of_results.sphere


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
