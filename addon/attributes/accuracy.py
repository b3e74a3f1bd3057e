"""The accuracy of a decomposition as a table, attributes and colors."""

import csv
import io
from itertools import chain

import bpy
import numpy as np
import spectral_tv
from spectral_tv.bands.settings import Settings
from spectral_tv.options.estimates import Needs

from ..scene import results
from ..scene.documents import keep_text
from ..scene.results import Piece
from ..scene.surface import Surface
from ..scene.whole import whole

# Of the heat map, from no error to the largest.
RAMP = ((0.05, 0.08, 0.35), (0.1, 0.5, 0.55), (0.95, 0.9, 0.3))
# What is written per vertex: the label, what of spectral_tv.Accuracy it is, and its short name.
ERRORS = (
    ("Error of Bands", "bands", "BANDS"),
    ("All-Pass Error", "all_pass", "ALL_PASS"),
    ("Paper's Error of Bands", "paper_bands", "PAPER_BANDS"),
    ("Paper's All-Pass Error", "paper_all_pass", "PAPER_ALL_PASS"),
)


def table(surface: Surface, result: spectral_tv.Accuracy) -> str:
    """Errors by number of steps as CSV, in percent.

    Distances are root mean squares over the surface relative to the object's size, errors of bands
    relative to the band.
    """
    mesh = surface.mesh
    areas = mesh.vertex_areas / mesh.vertex_areas.sum()

    def mean(distances: np.ndarray) -> np.ndarray:
        return 100 * np.sqrt((distances**2 @ areas) / mesh.area)

    bands = range(1, result.relative.shape[1] + 1)
    heads = [
        "Steps",
        *(label for label, _, _ in ERRORS),
        *(f"Band {band}" for band in bands),
        *(f"Paper's Band {band}" for band in bands),
    ]
    columns = [mean(getattr(result, name)) for _, name, _ in ERRORS]
    rows = zip(
        result.steps, *columns, 100 * result.relative, 100 * result.paper_relative, strict=True
    )
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(heads)
    for steps, *values, relative, paper in rows:
        writer.writerow([steps, *(f"{value:.3g}" for value in chain(values, relative, paper))])
    return stream.getvalue()


def summary(text: str) -> list[tuple[str, str, str]]:
    """The table in short: steps, the mean error of the bands, the paper's all-pass error."""
    rows = list(csv.DictReader(io.StringIO(text)))
    short = [("Steps", "Bands", "All-pass (paper)")]
    for row in rows:
        bands = [float(value) for name, value in row.items() if name.startswith("Band ")]
        all_pass = float(row["Paper's All-Pass Error"])
        short.append((row["Steps"], f"{sum(bands) / len(bands):.2g} %", f"{all_pass:.2g} %"))
    return short


def write(
    obj: bpy.types.Object, method: str, surface: Surface, result: spectral_tv.Accuracy, shown: str
) -> list[str]:
    """Write the errors of the most steps as attributes, in the unit of the scene; name them.

    The one that is ``shown`` is the active color attribute too. The table is kept as a text, in
    place of that of the last time.
    """
    most = int(np.argmax(result.steps))
    errors = {label: surface.to_vertices(getattr(result, name)[most]) for label, name, _ in ERRORS}
    pieces = {label: Piece("ATTRIBUTE", values, "FLOAT") for label, values in errors.items()}
    label = next(label for label, _, short in ERRORS if short == shown)
    colors = np.column_stack([heat_map(errors[label]), np.ones(len(surface.place))])
    pieces["Error Color"] = Piece("ATTRIBUTE", colors, "FLOAT_COLOR")
    told = table(surface, result)
    with whole(obj):
        keep_text(obj.data, "accuracy", f"{obj.name} Accuracy.csv", told)
        names = results.write(obj, "ACCURACY", method, pieces)
    obj.data.color_attributes.active_color = obj.data.color_attributes[names[-1]]
    return names


def needs(method: str, count: int, steps: int) -> Needs:
    """What measuring the accuracy takes, on so many vertices."""
    # A flow with eight times as many steps; of all, half and a quarter of them two kinds.
    return Settings(method=method, steps=11 * steps).needs(count)


def heat_map(values: np.ndarray) -> np.ndarray:
    """Colors (V, 3) of values (V,) from 0 to their largest."""
    shares = values / max(values.max(), np.finfo(float).tiny)
    stops = np.linspace(0, 1, len(RAMP))
    return np.column_stack(
        [np.interp(shares, stops, channel) for channel in zip(*RAMP, strict=True)]
    )
