"""From an image to its flow, and from the flow to what is written."""

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
import spectral_tv

from ..filters.filtering import filter_values
from ..scene.objects import Refusal
from . import pixels

BAND, REST, FILTERED = "Band", "Rest", "Filtered"


@dataclass(frozen=True)
class Choice:
    """What the user chose; sizes are in pixels. See ImageProperties."""

    result: str
    metric: str
    height: float
    channels: str
    exact: bool
    finest: float
    largest: float
    bands: int
    steps: int
    preset: str
    first: int
    last: int
    amount: float
    gains: str
    keep_rest: bool


@dataclass(frozen=True)
class Prepared:
    """The pixels of an image, and the arguments of spectral_tv.decompose_image."""

    pixels: pixels.Pixels
    arguments: dict[str, Any]


def prepare(image: bpy.types.Image, choice: Choice) -> Prepared:
    """Read what is to be flowed.

    Raises Refusal or spectral_tv.MeshError if the image and the choice do not go together.
    """
    if choice.bands >= choice.steps:
        raise Refusal(f"{choice.bands} bands need more than {choice.steps} steps")
    if choice.finest >= choice.largest:
        raise Refusal("the finest size is not below the largest")
    if choice.result == "FILTER":
        filter_values(choice)  # refused now rather than after the work
    found = pixels.read(image)
    values = found.luminance if choice.channels == "LUMINANCE" else found.values
    contrast = float(np.linalg.norm(np.ptp(values, axis=(0, 1))))
    if contrast == 0:
        raise Refusal("all of its pixels are the same; there is nothing to flow")
    # In the plane a disc of the radius r that stands out by h is gone at h r/2.
    ends = [contrast * size / 4 for size in (choice.finest, choice.largest)]
    return Prepared(
        found,
        {
            "image": values,
            "metric": choice.metric.lower(),
            "times": spectral_tv.graded_times(*ends, choice.steps),
            "height": choice.height,
            "scheme": "exact" if choice.exact else "extrapolated",
        },
    )


def write(
    image: bpy.types.Image, prepared: Prepared, choice: Choice, flow: spectral_tv.Flow
) -> tuple[list[str], int]:
    """Write what was chosen as new images; returns their names, and how many pixels were cut off.

    Bands add up to the image with the rest. Of luminance they are grey, and the rest has the
    colours.
    """
    values = prepared.pixels.values
    bands = flow.bands(flow.band_edges(choice.bands))
    cut = 0
    if choice.result == "BANDS":
        for number, band in enumerate(bands, start=1):
            pixels.write(image, f"{BAND} {number}", band, is_signed=True)
        pixels.write(image, REST, values - bands.sum(axis=0), is_signed=True)
        labels = {REST, *(f"{BAND} {number}" for number in range(1, len(bands) + 1))}
    else:
        filtered = values + np.tensordot(filter_values(choice), bands, axes=1)
        if not choice.keep_rest:
            filtered = filtered - (values - bands.sum(axis=0))
        cut = pixels.write(image, FILTERED, filtered, is_signed=not choice.keep_rest)
        labels = {FILTERED}
    for former in pixels.results_of(image):  # bands of an earlier run
        label = former.spectral_tv.label
        if choice.result == "BANDS" and label.startswith(BAND) and label not in labels:
            bpy.data.images.remove(former)
    written = [i for i in pixels.results_of(image) if i.spectral_tv.label in labels]
    return [each.name for each in written], cut
