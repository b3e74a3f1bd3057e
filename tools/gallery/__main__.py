"""Make the figures of the paper: python -m tools.gallery [FIGURE …] [--meshes FOLDER].

Pictures of generated shapes go to docs/gallery, those of a folder's meshes to its folder meshes.
"""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

import bpy
from tqdm import tqdm

from .gallery import Gallery

ROOT = Path(__file__).resolve().parents[2]
FIGURES = (
    "sinc_sleeve",
    "sinc_height",
    "sinc_filters",
    "sphere_caps",
    "torus_sets",
    "meteorite",
    "looks",
    "looks_table",
    "bands",
    "conformal_flows",
    "limbs",
    "caricature",
    "perturbation",
    "deformations",
    "poses",
    "displacement",
    "accuracy",
    "clouds",
    "segments",
)


def main() -> None:
    """Make the figures asked for, or all."""
    parser = argparse.ArgumentParser(prog="make gallery", description=__doc__)
    parser.add_argument("figures", nargs="*", metavar="FIGURE", help=", ".join(FIGURES))
    parser.add_argument("--meshes", type=Path, help="a folder with armadillo.ply and the like")
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "gallery")
    arguments = parser.parse_args()
    unknown = set(arguments.figures) - set(FIGURES)
    if unknown:
        parser.error(f"there is no figure {min(unknown)}; there are {', '.join(FIGURES)}")
    if arguments.meshes is not None and not arguments.meshes.is_dir():
        parser.error(f"there is no folder {arguments.meshes}")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    gallery = Gallery(arguments.output, arguments.meshes)
    for name in (bar := tqdm(arguments.figures or FIGURES, unit=" figures")):
        bar.set_description(name)
        import_module(f"{__package__}.{name}").make(gallery)


if __name__ == "__main__":
    main()
