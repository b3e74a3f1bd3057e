"""Files are written whole or not at all, and what was there before outlives every failure."""

from __future__ import annotations

import errno
import os
import stat
import sys
import threading
from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import empty
from disks import disk, protect
from spectral_tv.files import checks, whole
from spectral_tv.files.whole import NotWritten, ensure_writable, written


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def write(target: Path, text: str) -> None:
    with written(target) as path:
        path.write_text(text)


def write_pair(target: Path, text: str) -> None:
    """A file that needs another one beside it, and says which."""
    with written(target, with_others=True) as path:
        path.write_text(text)
        path.with_suffix(".bin").write_text(text)
        (path.parent / f"{path.stem}_more").mkdir()
        (path.parent / f"{path.stem}_more" / "picture").write_text(text)


def content(folder: Path) -> dict[str, str]:
    """All files under a folder."""
    return {
        str(path.relative_to(folder)): path.read_text()
        for path in folder.rglob("*")
        if path.is_file()
    }


def pair(text: str) -> dict[str, str]:
    return {"a.txt": text, "a.bin": text, "a_more/picture": text}


def test_permissions_are_those_of_new_files_or_of_the_former_one(tmp_path: Path):
    target = tmp_path / "a.txt"
    former = os.umask(0o027)
    try:
        write(target, "1")
        assert stat.S_IMODE(target.stat().st_mode) == 0o640
        target.chmod(0o604)
        write(target, "2")
        assert stat.S_IMODE(target.stat().st_mode) == 0o604
    finally:
        os.umask(former)
    assert content(tmp_path) == {"a.txt": "2"}


def test_a_link_stays_a_link(tmp_path: Path):
    real, link = tmp_path / "real" / "a.txt", tmp_path / "link.txt"
    real.parent.mkdir()
    link.symlink_to(real)
    for text in ("1", "2"):  # at first it leads nowhere
        write(link, text)
        assert link.is_symlink()
        assert content(real.parent) == {"a.txt": text}


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("folder", "it is a folder"),
        ("pipe", "it is no file"),
        ("circle", os.strerror(errno.ELOOP)),
        ("n" * 256, os.strerror(errno.ENAMETOOLONG)),
        ("nowhere/a.txt", "there is no folder"),
        ("file/a.txt", os.strerror(errno.ENOTDIR)),
        ("null\0.txt", "embedded null"),
        ("protected", "it is read-only"),
    ],
)
def test_names_that_cannot_be_written_are_refused(tmp_path: Path, name, reason):
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "circle").symlink_to("circle")
    for other in ("file", "protected"):
        (tmp_path / other).write_text("before")
    (tmp_path / "protected").chmod(0o444)
    there = sorted(tmp_path.iterdir())
    for attempt in (ensure_writable, lambda target: write(target, "1")):
        with pytest.raises(NotWritten, match=reason) as error:
            attempt(tmp_path / name)
        assert str(tmp_path) in str(error.value)
    assert sorted(tmp_path.iterdir()) == there
    assert (tmp_path / "protected").read_text() == "before"


def test_the_longest_name_can_be_written(tmp_path: Path):
    name = "n" * 251 + ".txt"
    write(tmp_path / name, "1")
    assert content(tmp_path) == {name: "1"}


def test_a_disk_that_can_only_be_read_is_told_at_once(tmp_path: Path):
    with disk(tmp_path / "disk", 100) as place:
        write(place / "a.txt", "1")
        protect(place)
        with pytest.raises(NotWritten, match="it is read-only"):
            ensure_writable(place / "a.txt")
        with pytest.raises(NotWritten, match=os.strerror(errno.EROFS)):
            write(place / "b.txt", "2")
        assert content(place) == {"a.txt": "1"}


def test_a_full_disk_keeps_what_was_there(tmp_path: Path):
    with disk(tmp_path / "disk", 100) as place:
        write_pair(place / "a.txt", "1")
        for attempt in (write, write_pair):
            with pytest.raises(NotWritten, match=os.strerror(errno.ENOSPC)):
                attempt(place / "a.txt", "2" * 200_000)
            assert content(place) == pair("1")


def test_what_is_not_whole_is_not_put_in_place(tmp_path: Path):
    target = tmp_path / "a.stl"
    target.write_bytes(b"before")
    with (
        pytest.raises(NotWritten, match=r"a.stl cannot be written: it was cut short"),
        written(target) as path,
    ):
        path.write_bytes(bytes(80) + b"\2\0\0\0" + bytes(50))
    with pytest.raises(NotWritten, match="nothing was written"), written(target):
        pass
    assert content(tmp_path) == {"a.stl": "before"}


def test_a_file_with_parts_that_did_not_fit_is_not_put_in_place(tmp_path: Path):
    """Some writers go on after a part failed: the file is as long as it should be."""
    with disk(tmp_path / "disk", 40) as place:
        with pytest.raises(NotWritten, match="it has holes"), written(place / "a.txt") as path:
            path.write_bytes(bytes(20_000))
            os.truncate(path, 200_000)
            (place / "rest").write_bytes(bytes(16_000))
        assert list(content(place)) == ["rest"]


def test_the_files_of_others_are_not_overwritten(tmp_path: Path):
    (tmp_path / "wood.png").write_text("another picture")
    target = tmp_path / "a.txt"
    with (
        pytest.raises(NotWritten, match="another file of that name"),
        written(target, with_others=True) as path,
    ):
        path.write_text("1")
        path.with_name("a.bin").write_text("1")
        path.with_name("wood.png").write_text("this one")
    assert content(tmp_path) == {"wood.png": "another picture"}


def test_interrupted_at_any_moment_there_is_all_of_it_or_what_was_before(tmp_path: Path):
    """Ctrl-C is let in at every line in turn that the writing goes through."""
    code = {whole.__file__}
    for attempt, before, after in (
        (write, {"a.txt": "1"}, {"a.txt": "2"}),
        (write_pair, pair("1"), pair("2")),
    ):
        for moment in range(1000):
            folder = tmp_path / f"{attempt.__name__}{moment}"
            folder.mkdir()
            attempt(folder / "a.txt", "1")
            left = moment

            def interrupt(frame, event, _argument):
                nonlocal left
                if frame.f_code.co_filename not in code:
                    return None
                if event == "line":
                    left -= 1
                    if left == 0:
                        raise KeyboardInterrupt
                return interrupt

            tracing = sys.gettrace()
            sys.settrace(interrupt)
            try:
                attempt(folder / "a.txt", "2")
                ended = True
            except KeyboardInterrupt:
                ended = False
            finally:
                sys.settrace(tracing)
            assert content(folder) in ((after,) if ended else (before, after)), moment
            if ended and left > 0:
                break
        assert moment > 20


def test_two_at_once_leave_the_files_of_one(tmp_path: Path):
    target = tmp_path / "a.txt"

    def repeat(text: str) -> None:
        for _ in range(50):
            write_pair(target, text)

    threads = [threading.Thread(target=repeat, args=(text,)) for text in "12"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert content(tmp_path) in (pair("1"), pair("2"))


def scene_files(folder: Path) -> None:
    """A textured ball in all formats that this Blender writes, but for OBJ."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2)
    material = bpy.data.materials.new("Ball")
    bpy.context.object.data.materials.append(material)
    if material.node_tree is None:  # before Blender 5
        material.use_nodes = True
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.new("Texture", 8, 8)
    texture.image.pack()
    shader = material.node_tree.nodes["Principled BSDF"]
    material.node_tree.links.new(texture.outputs[0], shader.inputs[0])
    for module, operator, names, options in (
        (bpy.ops.wm, "ply_export", "ball.ply", {}),
        (bpy.ops.wm, "ply_export", "text.ply", {"ascii_format": True}),
        (bpy.ops.wm, "stl_export", "ball.stl", {}),
        (bpy.ops.wm, "stl_export", "text.stl", {"ascii_format": True}),
        (bpy.ops.wm, "usd_export", "ball.usdc", {}),
        (bpy.ops.wm, "usd_export", "ball.usdz", {}),
        (bpy.ops.wm, "alembic_export", "ball.abc", {"end": 1}),
        (bpy.ops.wm, "collada_export", "ball.dae", {}),
        (bpy.ops.wm, "save_as_mainfile", "ball.blend", {"copy": True, "compress": False}),
        (bpy.ops.wm, "save_as_mainfile", "packed.blend", {"copy": True, "compress": True}),
        (bpy.ops.export_scene, "gltf", "ball.glb", {}),
        (bpy.ops.export_scene, "gltf", "ball.gltf", {"export_format": "GLTF_SEPARATE"}),
        (bpy.ops.export_scene, "fbx", "ball.fbx", {}),
    ):
        if operator in dir(module):
            getattr(module, operator)(filepath=str(folder / names), **options)


def pictures(folder: Path) -> None:
    """A picture of noise in all formats that the command line writes."""
    image = bpy.data.images.new("Noise", 40, 30)
    values = np.random.default_rng(0).random(40 * 30 * 4)
    image.pixels.foreach_set(values.astype(np.float32))
    scene = bpy.context.scene
    settings = scene.render.image_settings
    for suffix, kind, changes in (
        (".png", "PNG", [{"color_depth": "8"}, {"color_depth": "16"}]),
        (".jpg", "JPEG", [{}]),
        (".tif", "TIFF", [{"tiff_codec": codec} for codec in ("NONE", "DEFLATE", "LZW")]),
        (".webp", "WEBP", [{}]),
        (".bmp", "BMP", [{}]),
        (".tga", "TARGA", [{}]),
        (".exr", "OPEN_EXR", [{"exr_codec": codec} for codec in ("NONE", "ZIP", "PIZ", "DWAA")]),
        (".exr", "OPEN_EXR", [{"color_depth": "16"}]),
    ):
        settings.file_format = kind
        for number, change in enumerate(changes):
            for name, value in change.items():
                setattr(settings, name, value)
            image.save_render(str(folder / f"{kind}{number}{len(changes)}{suffix}"), scene=scene)


def is_torn(path: Path) -> bool:
    try:
        checks.check(path)
    except checks.Torn:
        return True
    return False


@pytest.mark.parametrize("make", [scene_files, pictures])
def test_a_file_that_is_cut_short_anywhere_is_told(tmp_path: Path, make):
    make(tmp_path)
    tested = [path for path in tmp_path.iterdir() if path.suffix in checks.CHECKS]
    assert len(tested) > 9
    for path in tested:
        checks.check(path)
        data = path.read_bytes()
        # The last bytes of some say nothing: the end of a line, of a comment.
        spare = {".stl": 3, ".gltf": 2, ".tga": 600}.get(path.suffix, 1)
        ends = np.linspace(0, len(data) - spare, 200).astype(int)
        for end in {*ends.tolist(), *range(len(data) - spare - 40, len(data) - spare)}:
            path.write_bytes(data[:end])
            assert is_torn(path), f"{path.name}: {end} of {len(data)} bytes"
        path.write_bytes(data)
