"""``decompose --shape multires``: the levels of a sculpt are filtered, and stay levels."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import band_values, decompose, empty, load, meshes
from deform_scene import evaluated
from sculpted_head import LEVELS, at_rest, levels, sculpted_head

SMOOTH = ["--shape", "multires", "--gain", "1=0", "--gain", "2=0.5"]


@pytest.fixture
def file(tmp_path: Path):
    empty()
    sculpted_head()
    bpy.ops.mesh.primitive_uv_sphere_add()
    bpy.context.object.name = "Eye"
    path = tmp_path / "head.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    yield path
    empty()


def test_a_blend_has_the_filtered_levels_and_the_work_object(file, tmp_path: Path, capfd):
    before = [at_rest(bpy.data.objects["Head"], level) for level in range(4)]
    assert decompose(file, tmp_path / "out.blend", *SMOOTH) == 0
    told = capfd.readouterr()
    told = told.out + told.err
    assert "left as they are, without Multiresolution: Eye" in told
    assert "the bands are on 'Head Work', which is hidden" in told
    load(tmp_path / "out.blend")
    head, work = bpy.data.objects["Head"], bpy.data.objects["Head Work"]
    assert levels(head) == LEVELS and not head.hide_get() and work.hide_get()
    assert band_values(work) == [-1, -0.5, 0]
    now = [at_rest(head, level) for level in range(4)]
    assert [len(each) for each in now] == [len(each) for each in before]
    np.testing.assert_array_equal(now[0], before[0])
    assert np.abs(now[3] - before[3]).max() > 1e-2
    work.hide_set(False)
    np.testing.assert_allclose(now[3], evaluated(work), atol=1e-5)
    bpy.context.view_layer.objects.active = work
    work.data.shape_keys.key_blocks[1].value = work.data.shape_keys.key_blocks[2].value = 0
    assert bpy.ops.spectral_tv.write_back() == {"FINISHED"}
    np.testing.assert_allclose(at_rest(head, 3), before[3], atol=1e-5)


def test_other_files_have_what_is_shown_of_the_sculpt(file, tmp_path: Path, capfd):
    assert decompose(file, tmp_path / "out.obj", *SMOOTH, "--object", "Head") == 0
    assert "Head is written as it is shown, at level 1 of 3" in "".join(capfd.readouterr())
    load(tmp_path / "out.obj")
    (head,) = meshes()
    assert len(head.data.vertices) == 2012


def test_what_has_no_levels_is_refused(file, tmp_path: Path, capfd):
    target = tmp_path / "out.blend"
    assert decompose(file, target, *SMOOTH, "--object", "Eye") == 1
    assert "the object has no Multiresolution modifier" in "".join(capfd.readouterr())
    assert decompose(file, target, "--shape", "multires", "--frames", "all") == 2
    assert "--shape multires is at rest" in "".join(capfd.readouterr())
    assert not target.exists()
