"""Picture files, written and read without Blender: the values that are really in them.

Values are (H, W, C) from the top down, C being 1 for grey, 2 for grey and alpha, 3 for colors and
4 for colors and alpha.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import OpenEXR
import png
import tifffile
from numpy.typing import NDArray
from PIL import Image

Values = NDArray[np.generic]
MODES = {1: "L", 2: "LA", 3: "RGB", 4: "RGBA"}
DTYPES = {"8": np.uint8, "16": np.uint16, "half": np.float16, "float": np.float32}
EXR_NAMES = {1: ["Y"], 2: ["Y", "A"], 3: ["R", "G", "B"], 4: ["R", "G", "B", "A"]}


def values(channels: int, depth: str, associated: bool, side: tuple[int, int] = (12, 14)) -> Values:
    """Random values of a depth, with transparent and half transparent pixels; floats to beyond 1.

    Alpha is at least a quarter where it is not 0. Colors are multiplied by it if ``associated``.
    """
    rng = np.random.default_rng(channels)
    found = rng.random((*side, channels))
    if depth in ("half", "float"):
        found = 2.5 * found - (0.5 if channels % 2 else 0)
    if channels % 2 == 0:
        found[..., -1] = rng.choice([0, 0.25, 0.5, 1], size=side)
        if associated:
            found[..., :-1] *= found[..., -1:]
    if depth in ("8", "16"):
        return np.rint(found * np.iinfo(DTYPES[depth]).max).astype(DTYPES[depth])
    return found.astype(DTYPES[depth])


def write(path: Path, pixels: Values, associated: bool = False, **options: object) -> Path:
    """Write a file in the format of the suffix, in the depth that the values have."""
    channels = pixels.shape[2]
    if path.suffix == ".png":
        depth = 8 * pixels.dtype.itemsize
        writer = png.from_array(pixels.reshape(len(pixels), -1), f"{MODES[channels]};{depth}")
        writer.save(str(path))
    elif path.suffix == ".tif":
        tifffile.imwrite(
            path,
            pixels if channels > 1 else pixels[..., 0],
            photometric="rgb" if channels > 2 else "minisblack",
            planarconfig="contig" if channels > 1 else None,
            extrasamples=["assocalpha" if associated else "unassalpha"]
            if channels % 2 == 0
            else None,
            **options,
        )
    elif path.suffix == ".exr":
        header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **options}
        parts = {
            name: np.ascontiguousarray(pixels[..., index])
            for index, name in enumerate(EXR_NAMES[channels])
        }
        with OpenEXR.File(header, parts) as file:
            file.write(str(path))
    else:
        settings = {".webp": {"lossless": True, "exact": True}, ".jpg": {"quality": 95}}
        Image.fromarray(pixels[..., 0] if channels == 1 else pixels).save(
            path, **{**settings.get(path.suffix, {}), **options}
        )
    return path


def read(path: Path) -> Values:
    """Read the values of a file, as many channels as it has."""
    if path.suffix == ".png":
        width, height, rows, info = png.Reader(str(path)).read()
        dtype = np.uint16 if info["bitdepth"] == 16 else np.uint8
        flat = np.fromiter(itertools.chain.from_iterable(rows), dtype=dtype)
        return flat.reshape(height, width, info["planes"])
    if path.suffix == ".tif":
        found = tifffile.imread(path)
    elif path.suffix == ".exr":
        with OpenEXR.File(str(path), separate_channels=True) as file:
            parts = {name: channel.pixels for name, channel in file.channels().items()}
        found = np.stack([parts[name] for name in "YRGBA" if name in parts], axis=-1)
    else:
        found = np.asarray(Image.open(path))
    return found if found.ndim == 3 else found[..., np.newaxis]


def is_associated(path: Path) -> bool:
    """Whether a file has colors that are multiplied by alpha."""
    if path.suffix == ".exr":
        return True
    if path.suffix != ".tif":
        return False
    with tifffile.TiffFile(path) as file:
        return tifffile.EXTRASAMPLE.ASSOCALPHA in file.pages[0].extrasamples


def fractions(pixels: Values) -> NDArray[np.float64]:
    """Values as fractions of white, (H, W, 4): grey in all channels, alpha 1 if there is none."""
    scale = np.iinfo(pixels.dtype).max if pixels.dtype.kind == "u" else 1
    channels = pixels.shape[2]
    found = np.ones((*pixels.shape[:2], 4))
    found[..., :3] = pixels[..., : 3 if channels > 2 else 1] / scale
    if channels % 2 == 0:
        found[..., 3] = pixels[..., -1] / scale
    return found
