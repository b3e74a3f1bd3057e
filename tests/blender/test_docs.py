"""Every Python example of the docs runs as it is."""

from __future__ import annotations

import os
import re
from pathlib import Path

import bpy
import pytest

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
# Whose examples need files, and are tried elsewhere.
OTHER = "many_files.md"
EXAMPLES = {
    f"{page.name}-{number}": source
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
    if page.name != OTHER
    for number, source in enumerate(BLOCK.findall(page.read_text(encoding="utf-8")), start=1)
}
# Those that need what Blender lacks.
NEEDS = {"scripting.md-24": "trimesh", "scripting.md-28": "matplotlib"}
# What an example leaves behind.
FILES = {
    "README.md-1": ["monkey.blend"],
    "scripting.md-1": ["stylize.json", "stylized.blend"],
    "scripting.md-2": ["deviation.json", "clean.blend"],
    "scripting.md-3": ["smooth.blend"],
    "scripting.md-4": ["safe.blend"],
    "scripting.md-7": ["masked.blend"],
    "scripting.md-8": ["swelling.blend", *(f"frames/{frame:04}.png" for frame in range(1, 5))],
    "scripting.md-9": ["bent.pc2"],
    "scripting.md-11": ["ear.blend"],
    "scripting.md-12": ["mask.blend", "mask.csv"],
    "scripting.md-13": ["smooth.png"],
    "scripting.md-17": ["vectors.exr", "normals.png"],
    "scripting.md-24": ["smooth.ply"],
    "scripting.md-27": ["splits.pickle"],
    "scripting.md-28": ["spectrum.png"],
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_example_runs(name, tmp_path: Path, monkeypatch):
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    monkeypatch.chdir(tmp_path)
    os.unsetenv("PWD")  # Blender 4.2 sets it where it writes .usdz, and goes by it
    bpy.ops.object.select_all(action="DESELECT")
    bpy.context.scene.cycles.use_denoising = False  # some builds have no denoiser
    exec(compile(EXAMPLES[name], name, "exec"), {"__name__": "__main__"})
    for file in FILES.get(name, []):
        assert (tmp_path / file).stat().st_size > 0


def test_every_page_with_files_is_there():
    assert {*FILES, *NEEDS} <= set(EXAMPLES)
