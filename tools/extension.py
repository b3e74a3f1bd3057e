"""Build the installable extension zip from addon/ and a wheel, or one per platform from several.

    python tools/extension.py WHEEL… [--split] [--output DIRECTORY] [--blender COMMAND]

The version comes from Cargo.toml; zipping and validation are done by Blender's own tool, that of
the command, or of the bpy package. The same files give the same zips.
"""

import argparse
import importlib.util
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

ROOT = Path(__file__).resolve().parent.parent

# Ours, and those of the crates in the wheels.
LICENCES = ("LICENSE", "THIRD_PARTY_LICENSES.txt")
# How wheels and Blender name systems and machines.
SYSTEMS = {"manylinux": "linux", "win": "windows", "macosx": "macos"}
MACHINES = {"x86_64": "x64", "amd64": "x64", "aarch64": "arm64", "arm64": "arm64"}


def main() -> None:
    """Build the zips and print their paths."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("wheels", type=Path, nargs="+", metavar="WHEEL")
    parser.add_argument("--split", action="store_true", help="name the platform even of one wheel")
    parser.add_argument("--output", type=Path, default=ROOT / "dist")
    parser.add_argument("--blender", help="the Blender that builds, a command line")
    arguments = parser.parse_args()
    tool = extension_tool(arguments.blender)
    arguments.output.mkdir(parents=True, exist_ok=True)
    split = arguments.split or len(arguments.wheels) > 1
    with tempfile.TemporaryDirectory() as directory:
        source = stage(Path(directory) / "spectral_tv", arguments.wheels, split=split)
        zips = Path(directory) / "zips"
        zips.mkdir()
        options = ["--split-platforms"] if split else []
        build = ["build", "--source-dir", str(source), "--output-dir", str(zips), *options]
        subprocess.run([*tool, *build], check=True)
        for zipped in sorted(zips.glob("*.zip")):
            subprocess.run([*tool, "validate", str(zipped)], check=True)
            print(settle(zipped, arguments.output / zipped.name))


def version() -> str:
    """Return the version of the project, which stands in Cargo.toml alone."""
    cargo = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))
    return cargo["workspace"]["package"]["version"]


def stage(target: Path, wheels: list[Path], *, split: bool) -> Path:
    """Lay the extension out in ``target``: the add-on, the licences, the wheels, the manifest."""
    shutil.copytree(ROOT / "addon", target, ignore=shutil.ignore_patterns("__pycache__"))
    for licences in LICENCES:
        shutil.copy(ROOT / licences, target)
    (target / "wheels").mkdir()
    for wheel in wheels:
        shutil.copy(wheel, target / "wheels")
    manifest = target / "blender_manifest.toml"
    added: dict[str, object] = {
        "version": version(),
        "wheels": [f"./wheels/{wheel.name}" for wheel in wheels],
    }
    if split:
        added["platforms"] = [blender_platform(wheel) for wheel in wheels]
    # JSON strings and lists of strings are valid TOML.
    lines = "".join(f"{name} = {json.dumps(value)}\n" for name, value in added.items())
    text = manifest.read_text(encoding="utf-8").split("\n", 1)[1]
    manifest.write_text(lines + text, encoding="utf-8")
    return target


def blender_platform(wheel: Path) -> str:
    """Return Blender's name of the platform that a wheel is for, such as ``linux-x64``."""
    tag = wheel.stem.rsplit("-", 1)[1]
    systems = [name for prefix, name in SYSTEMS.items() if tag.startswith(prefix)]
    machines = [name for suffix, name in MACHINES.items() if tag.endswith(suffix)]
    if not systems or not machines:
        sys.exit(f"{wheel}: Blender has no name for the platform {tag}")
    return f"{systems[0]}-{machines[0]}"


def extension_tool(blender: str | None) -> list[str]:
    """Return the command line of Blender's tool for extensions."""
    if blender is not None:
        return [*shlex.split(blender), "--command", "extension"]
    package = importlib.util.find_spec("bpy")
    if package is None or package.origin is None:
        sys.exit("bpy is not installed; run make from the repository's root")
    tools = Path(package.origin).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    return [sys.executable, str(next(tools))]


def settle(source: Path, target: Path) -> Path:
    """Copy a zip, its files sorted and of one time: that of SOURCE_DATE_EPOCH, or of 1980."""
    moment = time.gmtime(max(int(os.environ.get("SOURCE_DATE_EPOCH", "0")), 315532800))
    with ZipFile(source) as old, ZipFile(target, "w", ZIP_DEFLATED, compresslevel=9) as new:
        for entry in sorted(old.infolist(), key=lambda entry: entry.filename):
            settled = ZipInfo(entry.filename, moment[:6])
            settled.compress_type = entry.compress_type
            settled.external_attr = 0o644 << 16
            new.writestr(settled, old.read(entry))
    return target


if __name__ == "__main__":
    main()
