"""Write the recipe for conda-forge by what an sdist says, and have rattler-build evaluate it.

python -m tools.release.conda SDIST DIRECTORY [URL]

URL is where the sdist is published; without it the recipe takes the file. conda-forge's packages
are not needed for that, so nothing is built.
"""

from __future__ import annotations

import hashlib
import re
import sys
import tarfile
import tomllib
from email.parser import Parser
from pathlib import Path

from rattler_build import PlatformConfig, RenderConfig, Stage0Recipe, VariantConfig

TEMPLATE = Path(__file__).parent / "conda" / "recipe.yaml"
# A system, and where conda-forge builds for it.
PLATFORMS = {
    "linux-64": "linux-64",
    "linux-aarch64": "linux-64",
    "osx-64": "osx-64",
    "osx-arm64": "osx-64",
    "win-64": "win-64",
}
# What conda-forge pins, as far as it changes what is asked for.
PINS = """
python: ["3.11.* *_cpython", "3.12.* *_cpython", "3.13.* *_cp313"]
c_stdlib: [stdlib]
"""


def main(sdist: Path, directory: Path, url: str = "") -> None:
    """Write recipe.yaml into a directory, and say what it asks for on each platform."""
    text, licences = filled(sdist, url or sdist.resolve().as_uri())
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "recipe.yaml").write_text(text, encoding="utf-8")
    recipe = Stage0Recipe.from_file(directory / "recipe.yaml")
    for platform, builder in PLATFORMS.items():
        systems = PlatformConfig(
            target_platform=platform, build_platform=builder, host_platform=platform
        )
        variants = recipe.render(VariantConfig.from_yaml(PINS), RenderConfig(platform=systems))
        if len(variants) != PINS.count("3.1"):
            sys.exit(f"conda.py: {len(variants)} variants on {platform}")
        for variant in variants:
            missing = set(variant.recipe.about.to_dict()["license_file"]) - licences
            if missing:
                sys.exit(f"conda.py: {sdist.name} has no {missing}")
        asked = variants[0].recipe.requirements.to_dict()
        print(f"{platform}: {len(variants)} variants, the first by {asked}")


def filled(sdist: Path, url: str) -> tuple[str, set[str]]:
    """The recipe's text, and the names of the files at the top of the sdist."""
    with tarfile.open(sdist) as archive:
        top = sdist.name.removesuffix(".tar.gz")

        def read(name: str) -> str:
            file = archive.extractfile(f"{top}/{name}")
            assert file is not None
            return file.read().decode()

        names = {name.removeprefix(f"{top}/") for name in archive.getnames()}
        about = Parser().parsestr(read("PKG-INFO"))
        tools = tomllib.loads(read("pyproject.toml"))["build-system"]["requires"]
    needed = [each for each in about.get_all("Requires-Dist", []) if ";" not in each]
    if len(tools) != 1 or len(needed) != 1:
        sys.exit(f"conda.py: the recipe does not know of all of {tools} and {needed}")
    values = {
        "VERSION": about["Version"],
        "SUMMARY": about["Summary"],
        "LICENSE": about["License-Expression"],
        "URL": url,
        "SHA256": hashlib.sha256(sdist.read_bytes()).hexdigest(),
        "MATURIN": _spaced(tools[0]),
        "NUMPY": _spaced(needed[0]),
    }
    text = re.sub("@([A-Z0-9]+)@", lambda found: values[found[1]], TEMPLATE.read_text("utf-8"))
    return text, names


def _spaced(requirement: str) -> str:
    """The same as conda writes it: a space after the name."""
    return re.sub(r"^([\w-]+)\s*", r"\1 ", requirement)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), *sys.argv[3:])
