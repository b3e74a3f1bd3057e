"""How a picture is split, and which results are written; sizes are in pixels."""

from typing import Any

from spectral_tv.bands.filtering import FilterSettings
from spectral_tv.dataclass import dataclass
from spectral_tv.options.declaring import Only, choice, number, switch

RESULTS = (
    ("FILTER", "Filtered", "The image with its bands kept, removed or amplified"),
    ("BANDS", "Bands", "Every band as an image, and the rest; they add up to the image"),
)
METRICS = (
    ("FLAT", "Flat", "Along the plane of the image: spectral TV"),
    (
        "SURFACE",
        "Surface",
        "Along the image seen as a relief: adaptive spectral TV, where strong edges stay longer",
    ),
)
CHANNELS = (
    ("ALL", "All", "Red, green and blue together; alpha stays"),
    ("LUMINANCE", "Luminance", "The brightness alone; what it changes is added to all channels"),
)
SIZE = (
    "A spot of this width is gone that stands out by the whole range of the values, and sooner the "
    "less it does"
)


def _size(label: str, text: str, default: float, least: float, most: float, digits: int) -> Any:
    return number(
        label, text, default, least, None, soft_most=most, unit="PIXEL", digits=digits,
        place="sizes"
    )  # fmt: skip


@dataclass(frozen=True)
class Settings(FilterSettings):
    """What is split along what, and what is written."""

    result: str = choice("Write", "What is written", RESULTS, place="what", argument="")
    channels: str = choice("Channels", "What is split", CHANNELS, place="what", argument="")
    metric: str = choice("Distances", "Along what they are", METRICS, place="what")
    height: float = number(
        "Height",
        "How high the relief is from the darkest to the brightest value", 32, 0.01, None,
        soft_most=200, unit="PIXEL", applies=Only("metric", ["SURFACE"]), place="what"
    )  # fmt: skip
    finest: float = _size("Finest", f"Where the first band ends, about. {SIZE}", 0.1, 0.001, 10, 2)
    largest: float = _size(
        "Largest",
        f"Where the last band ends. {SIZE}. What is larger stays in the rest", 64, 0.01, 1000, 1
    )  # fmt: skip
    exact: bool = switch(
        "Exact",
        "Follow Total Variation exactly: spots fade in a straight line until they are gone. Slower",
        place="exact",
    )
