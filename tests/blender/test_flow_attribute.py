"""bpy.ops.spectral_tv.flow_attribute on groups, attributes, colors and shape keys."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import object_of
from shapes import icosphere

VERTICES, FACES = icosphere(4)
CAP = VERTICES[:, 2] > np.cos(1.0)
flow = bpy.ops.spectral_tv.flow_attribute


def link(vertices, faces):
    obj = object_of("Sphere", np.asarray(vertices), np.asarray(faces))
    return obj


@pytest.fixture
def sphere():
    """A unit sphere with the vertex group Cap."""
    obj = link(VERTICES, FACES)
    obj.vertex_groups.new(name="Cap").add(np.flatnonzero(CAP).tolist(), 1, "REPLACE")
    return obj


def weights(obj, name) -> np.ndarray:
    index = obj.vertex_groups[name].index
    return np.array(
        [sum(m.weight for m in v.groups if m.group == index) for v in obj.data.vertices]
    )


def attribute(obj, name, field="value", channels=1) -> np.ndarray:
    data = obj.data.attributes[name].data
    flat = np.empty(channels * len(data), dtype=np.float32)
    data.foreach_get(field, flat)
    return flat.reshape(-1, channels) if channels > 1 else flat


def add_attribute(obj, name, values, data_type="FLOAT", domain="POINT", field="value"):
    data = obj.data.attributes.new(name, data_type, domain).data
    data.foreach_set(field, np.ascontiguousarray(values, dtype=np.float32).ravel())


def offset(obj, name) -> np.ndarray:
    keys = obj.data.shape_keys
    return np.array([
        a.co - b.co
        for a, b in zip(keys.key_blocks[name].data, keys.reference_key.data, strict=True)
    ])  # fmt: skip


def test_a_cap_fades_in_place_and_is_gone_at_its_size(sphere):
    """Its jump ends at 1/λ(1 + β); a disc in the plane of that life has 47 % of √area as width."""
    before = weights(sphere, "Cap")
    jumps = {}
    for size in (11.9, 23.7, 60):
        assert flow(kind="GROUP", source="Cap", size=size) == {"FINISHED"}
        after = weights(sphere, "Cap Flow")
        inner, outer = VERTICES[:, 2] > np.cos(0.8), VERTICES[:, 2] < np.cos(1.2)
        assert np.ptp(after[inner]) < 0.02 and np.ptp(after[outer]) < 0.02
        jumps[size] = after[inner].mean() - after[outer].mean()
    assert jumps[11.9] == pytest.approx(0.75, abs=0.03)
    assert jumps[23.7] == pytest.approx(0.5, abs=0.05)
    assert jumps[60] == pytest.approx(0, abs=1e-3)
    np.testing.assert_array_equal(weights(sphere, "Cap"), before)
    assert [group.name for group in sphere.vertex_groups] == ["Cap", "Cap Flow"]
    assert sphere.vertex_groups.active.name == "Cap"


@pytest.mark.parametrize("law", ["TV", "HEAT"])
def test_bands_and_rest_add_up_to_the_attribute(sphere, law):
    values = np.column_stack([CAP, VERTICES[:, 0], 2 * np.sin(9 * VERTICES[:, 1])])
    add_attribute(sphere, "Wind", values, "FLOAT_VECTOR", field="vector")
    flow(source="Wind", result="BANDS", law=law, bands=4, steps=12)
    names = [*(f"Wind Band {number}" for number in range(1, 5)), "Wind Rest"]
    parts = [attribute(sphere, name, "vector", 3) for name in names]
    np.testing.assert_allclose(sum(parts), values, atol=1e-5)
    assert all(np.abs(part).max() > 1e-3 for part in parts)


def test_bands_of_a_group_are_attributes_as_they_are_signed(sphere):
    flow(kind="GROUP", source="Cap", result="BANDS", bands=2, steps=12)
    parts = [attribute(sphere, f"Cap {name}") for name in ("Band 1", "Band 2", "Rest")]
    np.testing.assert_allclose(sum(parts), CAP, atol=1e-5)
    assert [group.name for group in sphere.vertex_groups] == ["Cap"]


def test_groups_flow_on_edges_and_smooth_values_on_vertices(sphere):
    add_attribute(sphere, "Height", VERTICES[:, 2])
    found = {}
    for elements in ("AUTOMATIC", "EDGES", "VERTICES"):
        flow(kind="GROUP", source="Cap", elements=elements, size=10, steps=6)
        flow(source="Height", elements=elements, size=10, steps=6)
        found[elements] = weights(sphere, "Cap Flow"), attribute(sphere, "Height Flow")
    for each, same in ((0, "EDGES"), (1, "VERTICES")):
        other = {"EDGES": "VERTICES", "VERTICES": "EDGES"}[same]
        np.testing.assert_array_equal(found["AUTOMATIC"][each], found[same][each])
        assert np.abs(found["AUTOMATIC"][each] - found[other][each]).max() > 1e-3


def test_filters(sphere):
    spots = np.sin(9 * VERTICES[:, 0]) + VERTICES[:, 2]
    add_attribute(sphere, "Heat", spots)
    common = {"source": "Heat", "bands": 3, "steps": 12}
    flow(**common, result="BANDS")
    bands = [attribute(sphere, f"Heat Band {number}") for number in (1, 2, 3)]
    rest = attribute(sphere, "Heat Rest")

    def filtered(**options):
        flow(**common, result="FILTER", **options)
        return attribute(sphere, "Heat Filtered")

    close = {"atol": 1e-5}
    np.testing.assert_allclose(filtered(preset="GAINS", gains="1, 1 1"), spots, **close)
    expected = 2 * bands[0] - bands[2] + rest
    np.testing.assert_allclose(filtered(preset="GAINS", gains="2 0 -1"), expected, **close)
    low = filtered(preset="LOW_PASS", first=2, last=2)
    np.testing.assert_allclose(low, bands[1] + bands[2] + rest, **close)
    alone = filtered(preset="BAND_PASS", first=2, last=2, keep_rest=False)
    np.testing.assert_allclose(alone, bands[1], **close)


def test_a_filter_that_changes_nothing_says_so(sphere, capfd):
    common = {"kind": "GROUP", "source": "Cap", "result": "FILTER", "bands": 3, "steps": 8}
    flow(**common, preset="LOW_PASS", first=1)
    assert "Low-Pass changes nothing: no band is finer than band 1" in capfd.readouterr().out
    np.testing.assert_allclose(weights(sphere, "Cap Filtered"), CAP, atol=1e-5)
    flow(**common, preset="GAINS", gains="1 1 1")
    assert "the filter changes nothing: it keeps every band" in capfd.readouterr().out
    flow(**common, preset="LOW_PASS", first=1, keep_rest=False)
    assert "nothing" not in capfd.readouterr().out


def test_running_again_replaces_its_own_output_alone(sphere):
    add_attribute(sphere, "Heat", VERTICES[:, 0])
    mine = np.arange(len(VERTICES))
    add_attribute(sphere, "Heat Flow", mine)
    for size in (5, 50):
        flow(source="Heat", size=size)
    np.testing.assert_array_equal(attribute(sphere, "Heat Flow"), mine)
    assert np.ptp(attribute(sphere, "Heat Flow.001")) < 1
    for bands in (4, 2):
        flow(source="Heat", result="BANDS", bands=bands, steps=8)
    names = {a.name for a in sphere.data.attributes if a.name.startswith("Heat")}
    expected = {"Heat", "Heat Flow", "Heat Flow.001", "Heat Band 1", "Heat Band 2", "Heat Rest"}
    assert names == expected
    np.testing.assert_array_equal(attribute(sphere, "Heat"), VERTICES[:, 0].astype(np.float32))


def test_colors_flow_without_their_alpha(sphere):
    """Those of face corners are averaged at their vertices."""
    corners = np.array([loop.vertex_index for loop in sphere.data.loops])
    colors = np.column_stack([CAP, ~CAP, CAP, VERTICES[:, 2] / 2 + 0.5])
    add_attribute(sphere, "Paint", colors[corners], "FLOAT_COLOR", "CORNER", "color")
    flow(kind="COLOR", source="Paint", size=300)
    after = attribute(sphere, "Paint Flow", "color", 4)
    assert sphere.data.attributes["Paint Flow"].domain == "POINT"
    assert "Paint Flow" in sphere.data.color_attributes
    np.testing.assert_allclose(after[:, 3], colors[:, 3], atol=1e-6)
    np.testing.assert_allclose(np.ptp(after[:, :3], axis=0), 0, atol=1e-3)
    np.testing.assert_allclose(after[0, 0] + after[0, 1], 1, atol=1e-3)


def test_faces_give_their_vertices_the_mean_by_area(sphere):
    height = np.array([polygon.center.z for polygon in sphere.data.polygons])
    add_attribute(sphere, "Height", height, domain="FACE")
    flow(source="Height", size=0.01, steps=2)
    np.testing.assert_allclose(attribute(sphere, "Height Flow"), VERTICES[:, 2], atol=0.02)


@pytest.mark.parametrize("scale", [1, 10])
def test_shape_keys_flow_the_same_at_every_scale(sphere, scale):
    sphere.scale = [scale] * 3
    bpy.context.view_layer.update()
    sphere.shape_key_add(name="Basis")
    key = sphere.shape_key_add(name="Lift")
    for vertex in np.flatnonzero(CAP).tolist():
        key.data[vertex].co.z += 0.5
    before = offset(sphere, "Lift")
    flow(kind="KEY", source="Lift", size=23.7)
    flow(kind="KEY", source="Lift", result="BANDS", bands=2, steps=12)
    after = offset(sphere, "Lift Flow")
    top, bottom = VERTICES[:, 2].argmax(), VERTICES[:, 2].argmin()
    np.testing.assert_allclose(after[top] - after[bottom], [0, 0, 0.25], atol=0.03)
    parts = sum(offset(sphere, f"Lift {name}") for name in ("Band 1", "Band 2", "Rest"))
    np.testing.assert_allclose(parts, before, atol=1e-5)
    np.testing.assert_array_equal(offset(sphere, "Lift"), before)
    assert sphere.data.shape_keys.key_blocks["Lift Flow"].value == 0


def test_a_mask_of_a_flowed_key_is_told(sphere, capfd):
    sphere.shape_key_add(name="Basis")
    sphere.vertex_groups.new(name="Half")
    key = sphere.shape_key_add(name="Lift")
    key.data[0].co.z += 0.5
    key.vertex_group = "Half"
    flow(kind="KEY", source="Lift", steps=4)
    assert "'Lift' is limited to 'Half'; what comes of it is not" in capfd.readouterr().out


def test_torn_seams_stay_closed():
    faces = np.arange(3 * len(FACES)).reshape(-1, 3)
    obj = link(VERTICES[FACES].reshape(-1, 3), faces)
    add_attribute(obj, "Mask", CAP[FACES])
    flow(source="Mask", size=10)
    after = attribute(obj, "Mask Flow")
    one = np.zeros(len(VERTICES))
    one[FACES.ravel()] = after
    np.testing.assert_allclose(after, one[FACES.ravel()], atol=1e-6)
    assert after.min() > 0.02 and after.max() < 0.98


def test_refusals_say_why(sphere):
    mesh = sphere.data
    mesh.uv_layers.new(name="UV")
    add_attribute(sphere, "Even", np.full(len(VERTICES), 7))
    add_attribute(sphere, "Broken", np.where(np.arange(len(VERTICES)) == 5, np.nan, CAP))
    add_attribute(sphere, "Crease", np.zeros(len(mesh.edges)), domain="EDGE")
    refused = {
        "the same everywhere": {"source": "Even"},
        "not a finite number at vertex 5": {"source": "Broken"},
        "is on edges": {"source": "Crease"},
        "UV map": {"source": "UV"},
        "no attribute 'Nothing'": {"source": "Nothing"},
        "no color attribute 'Even'": {"source": "Even", "kind": "COLOR"},
        "no shape key 'Smile'": {"source": "Smile", "kind": "KEY"},
        "more than 4 steps": {"source": "Cap", "kind": "GROUP", "result": "BANDS", "steps": 4},
        "not below the largest": {
            "source": "Cap", "kind": "GROUP", "result": "BANDS", "finest": 50,
        },
        "as many gains": {
            "source": "Cap", "kind": "GROUP", "result": "FILTER", "preset": "GAINS", "gains": "1",
        },
    }  # fmt: skip
    count = len(mesh.attributes)
    for message, options in refused.items():
        with pytest.raises(RuntimeError, match=message):
            flow(**options)
    assert len(mesh.attributes) == count
