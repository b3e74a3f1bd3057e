"""The comparison methods of bpy.ops.spectral_tv.decompose: bands like all others."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
import spectral_tv
from command_line_files import QUICK, decompose, load, meshes, run, write_monkey

pytestmark = pytest.mark.once

NAMES = {
    "NAIVE": "Per Axis",
    "HEAT": "Heat",
    "LB": "Eigenfunctions",
    "DISPLACEMENT": "Displacement",
    "M2_P2": "M2 with P = 2",
    "M2_P1": "M2 with P = 1",
}


def shape(data) -> np.ndarray:
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


def offsets(obj) -> np.ndarray:
    basis, *keys = (shape(key.data) for key in obj.data.shape_keys.key_blocks)
    return np.array(keys) - basis


def surface(obj) -> spectral_tv.Mesh:
    obj.data.calc_loop_triangles()
    triangles = [list(triangle.vertices) for triangle in obj.data.loop_triangles]
    return spectral_tv.Mesh(shape(obj.data.vertices), triangles)


def expected(obj, method, count):
    """What the package says the bands are."""
    mesh = surface(obj)
    arguments = {
        "NAIVE": {"method": "naive", "steps": 8},
        "HEAT": {"method": "heat", "steps": 8},
        "LB": {"method": "lb", "steps": 8, "eigenpairs": 40},
        "DISPLACEMENT": {"method": "displacement", "base": "limbs"},
        "M2_P2": {"method": "m2", "p": 2, "steps": 8},
        "M2_P1": {"method": "m2", "p": 1, "steps": 8},
    }[method]
    split = spectral_tv.decompose(mesh, **arguments)
    return split.bands(split.band_edges(count))


@pytest.mark.parametrize("method", NAMES)
def test_bands_are_those_of_the_package(monkey, method):
    result = bpy.ops.spectral_tv.decompose(method=method, bands=3, steps=8, eigenpairs=40)
    assert result == {"FINISHED"}
    count = 1 if method == "DISPLACEMENT" else 3
    names = [key.name for key in monkey.data.shape_keys.key_blocks]
    assert names == ["Basis", *(f"{NAMES[method]} Band {band}" for band in range(1, count + 1))]
    found = offsets(monkey)
    np.testing.assert_allclose(found, expected(monkey, method, count), atol=1e-5)
    assert all(np.abs(band).max() > 1e-4 for band in found)


@pytest.mark.parametrize("method", NAMES)
def test_bands_are_dialled_masked_and_kept_in_the_file(monkey, method, tmp_path: Path):
    monkey.vertex_groups.new(name="half").add(range(500), 1.0, "REPLACE")
    bpy.ops.spectral_tv.decompose(
        method=method, bands=2, steps=6, eigenpairs=20, vertex_group="half"
    )
    bpy.ops.spectral_tv.filter(preset="EXAGGERATE", first=1, last=1, amount=0.5)
    path = tmp_path / "saved.blend"
    bpy.data.libraries.write(str(path), {monkey})
    kept, name = offsets(monkey), monkey.name
    bpy.data.batch_remove([monkey])
    with bpy.data.libraries.load(str(path)) as (_, target):
        target.objects = [name]
    obj = target.objects[0]
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    record = obj.data.spectral_tv.decompositions[-1]
    assert record.method == method
    keys = obj.data.shape_keys.key_blocks
    assert [band.key for band in record.bands] == [key.name for key in keys[1:]]
    assert keys[1].value == pytest.approx(0.5)
    assert keys[1].vertex_group == "half"
    np.testing.assert_array_equal(offsets(obj), kept)
    bpy.ops.spectral_tv.filter(preset="RESET")
    assert keys[1].value == 0


def test_one_undo_takes_all_of_it_back(monkey):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.spectral_tv.decompose(method="LB", bands=3, steps=8, eigenpairs=40)
    bpy.ops.ed.undo_push(message="after")
    name = monkey.name
    bpy.ops.ed.undo()
    assert bpy.data.objects[name].data.shape_keys is None
    bpy.ops.ed.redo()
    assert len(bpy.data.objects[name].data.shape_keys.key_blocks) == 4


def test_comparisons_stand_apart_in_the_menu():
    items = bpy.ops.spectral_tv.decompose.get_rna_type().properties["method"].enum_items
    names = [item.identifier for item in items]
    assert names == ["M1", "M2", "M3", *NAMES]
    headings = bpy.types.Scene.bl_rna.properties["spectral_tv"].fixed_type.properties["method"]
    everything = [(i.identifier, i.name) for i in headings.enum_items_static_ui]
    assert (
        everything.index(("", "For Comparison")) == everything.index(("M3", everything[3][1])) + 1
    )


def test_eigenfunctions_up_to_a_chosen_size(monkey):
    bpy.ops.spectral_tv.decompose(
        method="LB", bands=2, steps=8, eigenpairs=60, use_scales=True, finest=3, largest=20
    )
    record = monkey.data.spectral_tv.decompositions[-1]
    assert record.bands[-1].end / record.area == pytest.approx(0.2**2, rel=1e-4)


def test_displacement_has_the_bases_of_m3(monkey):
    bpy.ops.spectral_tv.decompose(method="DISPLACEMENT", base="FLAT")
    (band,) = offsets(monkey)
    assert np.abs(band[:, :2]).max() < 1e-6
    np.testing.assert_allclose(
        band[:, 2],
        shape(monkey.data.vertices)[:, 2] - shape(monkey.data.vertices)[:, 2].min(),
        atol=1e-5,
    )
    with pytest.raises(RuntimeError, match="no shape key 'Nothing'"):
        bpy.ops.spectral_tv.decompose(method="DISPLACEMENT", base="KEY", base_key="Nothing")
    with pytest.raises(RuntimeError, match="components, 1, not 3"):
        bpy.ops.spectral_tv.cut(bands=3)


def test_from_the_command_line(tmp_path: Path, capfd):
    source = write_monkey(tmp_path / "monkey.ply")
    target = tmp_path / "out.blend"
    for method, names in (("lb", 3), ("m2_p1", 3), ("displacement", 1)):
        arguments = ["--method", method, "--eigenpairs", "40", *QUICK, "--gain", "1=2"]
        assert run(["decompose", str(source), "-o", str(target), *arguments]) == 0
        load(target)
        keys = meshes()[0].data.shape_keys.key_blocks[1:]
        assert [key.name for key in keys] == [
            f"{NAMES[method.upper()]} Band {band}" for band in range(1, names + 1)
        ]
        assert keys[0].value == 1
    capfd.readouterr()
    for arguments, message in (
        (["--method", "displacement", "--gain", "2=0"], "no band 2 among 1"),
        (["--method", "lb", "--eigenpairs", "1"], "not a number from 2 to 10000"),
        (["--method", "lb", "--base", "flat"], "go with --method m3 or displacement"),
    ):
        assert run(["decompose", str(source), "-o", str(target), *arguments]) == 2
        assert message in capfd.readouterr().err
    # What is seen is the exaggerated shape.
    ply = tmp_path / "out.ply"
    assert decompose(source, ply, "--method", "displacement", "--gain", "1=2") == 0
