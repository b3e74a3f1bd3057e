"""Build the installable extension zip from addon/ and a wheel.

    python tools/extension.py WHEEL [--output DIRECTORY]

The version comes from Cargo.toml; zipping and validation are done by Blender's own tool, which
the bpy package carries.
"""

import argparse
import importlib.util
import json
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def main() -> None:
    """Build the zip and print its path."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("wheel", type=Path)
    parser.add_argument("--output", type=Path, default=ROOT / "dist")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as directory:
        source = stage(Path(directory) / "spectral_tv", arguments.wheel)
        zipped = arguments.output / f"spectral_tv-{version()}.zip"
        blender_extension_tool(
            "build", "--source-dir", str(source), "--output-filepath", str(zipped)
        )
        blender_extension_tool("validate", str(zipped))
    print(zipped)


def version() -> str:
    """Return the version of the project, which stands in Cargo.toml alone."""
    cargo = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))
    return cargo["workspace"]["package"]["version"]


def stage(target: Path, wheel: Path) -> Path:
    """Lay the extension out in ``target``: the add-on, the licence, the wheel, the manifest."""
    shutil.copytree(ROOT / "addon", target, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "LICENSE", target)
    (target / "wheels").mkdir()
    shutil.copy(wheel, target / "wheels")
    manifest = target / "blender_manifest.toml"
    added = {"version": version(), "wheels": [f"./wheels/{wheel.name}"]}
    # JSON strings and lists of strings are valid TOML.
    lines = "".join(f"{name} = {json.dumps(value)}\n" for name, value in added.items())
    text = manifest.read_text(encoding="utf-8").split("\n", 1)[1]
    manifest.write_text(lines + text, encoding="utf-8")
    return target


def blender_extension_tool(*arguments: str) -> None:
    """Run Blender's command-line tool for extensions."""
    package = importlib.util.find_spec("bpy")
    if package is None or package.origin is None:
        sys.exit("bpy is not installed; run make from the repository's root")
    tools = Path(package.origin).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    subprocess.run([sys.executable, str(next(tools)), *arguments], check=True)


if __name__ == "__main__":
    main()
