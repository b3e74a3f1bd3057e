"""Decompose a mesh in headless Blender: a .blend with the bands, and a picture of the filters.

python -m tools.demo [MESH] [--up Y|Z] [--azimuth DEGREES] [--output DIRECTORY]
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

from spectral_tv.files.whole import written

ROOT = Path(__file__).resolve().parents[2]
# Installed extensions of the demo stay apart from the user's own Blender.
RESOURCES = tempfile.TemporaryDirectory(prefix="spectral_tv_demo_")
os.environ["BLENDER_USER_RESOURCES"] = RESOURCES.name

import bpy  # noqa: E402  (reads the variable above)
from tqdm import tqdm  # noqa: E402

from .contact_sheet import Sheet, render  # noqa: E402
from .creature import creature  # noqa: E402
from .importing import import_mesh  # noqa: E402
from .shapes import band, coordinates  # noqa: E402

BANDS = 5
# Method, heading, and the gain at which its bands are shown.
METHODS = (
    ("M1", "M1  Shape spectral TV", 3.0),
    ("M2", "M2  Conformalized 3-Laplace", 1.5),
    ("M3", "M3  Directional TV", 3.0),
)


def main() -> None:
    """Run the demo."""
    arguments = parse()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    install_extension()
    if arguments.mesh is None:
        obj = creature()
        bpy.context.scene.collection.objects.link(obj)
        bpy.context.view_layer.objects.active = obj
    else:
        obj = import_mesh(arguments.mesh, arguments.up)
    arguments.output.mkdir(parents=True, exist_ok=True)
    name = arguments.mesh.stem if arguments.mesh else "creature"
    blend, picture = (arguments.output / f"{name}{suffix}" for suffix in (".blend", ".png"))

    for method, _, _ in tqdm(METHODS, desc="Decomposing", unit=" methods"):
        bpy.ops.spectral_tv.decompose(method=method, bands=BANDS)
    with written(blend) as path:
        bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True, copy=True)
    with written(picture) as path, tqdm(total=100, desc="Rendering  ", unit=" %") as bar:
        sheets = [sheet(obj, *method) for method in METHODS]
        render(
            obj,
            sheets,
            path,
            cell=arguments.cell,
            azimuth=arguments.azimuth,
            progress=lambda fraction: bar.update(round(100 * fraction) - bar.n),
        )
    print(f"{blend}\n{picture}")


def parse() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="make demo", description=__doc__)
    parser.add_argument("mesh", type=Path, nargs="?", help="a file that Blender imports")
    parser.add_argument("--up", choices=("Y", "Z"), help="the upward axis of a .ply or .stl")
    parser.add_argument("--azimuth", type=float, default=25.0, help="degrees to turn the view by")
    parser.add_argument("--cell", type=int, default=280, help="pixels of a cell of the picture")
    parser.add_argument("--output", type=Path, default=ROOT / "demo")
    return parser.parse_args()


def install_extension() -> None:
    """Install and enable the built zip, as a user would."""
    zips = sorted((ROOT / "dist").glob("spectral_tv-*.zip"))
    if not zips:
        sys.exit("dist/ holds no extension; run: make extension")
    bpy.ops.extensions.package_install_files(
        filepath=str(zips[-1]), repo="user_default", enable_on_install=True
    )


def sheet(obj: bpy.types.Object, method: str, title: str, gain: float) -> Sheet:
    """Lay out the filters of one method: each band amplified, and each removed."""
    basis = coordinates(obj, "Basis")
    bands = [band(obj, method, number) - basis for number in range(1, BANDS + 1)]
    amplified = [
        (f"Band {number} × {gain:g}", basis + (gain - 1) * offset)
        for number, offset in enumerate(bands, start=1)
    ]
    removed = [(f"Without band {number}", basis - offset) for number, offset in enumerate(bands, 1)]
    low_pass = basis - sum(bands)
    return title, [[("Original", basis), *amplified], [("Low-pass", low_pass), *removed]]


if __name__ == "__main__":
    main()
    sys.stdout.flush()
