"""The accuracy of a decomposition: what is measured, and its table."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.bands.settings import Settings
from spectral_tv.later import csv, np
from spectral_tv.options.estimates import Needs
from spectral_tv.refusal import Refusal

if TYPE_CHECKING:
    from numpy.typing import NDArray

# What is written per vertex: the label, what of spectral_tv.Accuracy it is, and its short name.
ERRORS = (
    ("Error of Bands", "bands", "BANDS"),
    ("All-Pass Error", "all_pass", "ALL_PASS"),
    ("Paper's Error of Bands", "paper_bands", "PAPER_BANDS"),
    ("Paper's All-Pass Error", "paper_all_pass", "PAPER_ALL_PASS"),
)


def table(mesh: spectral_tv.Mesh, result: spectral_tv.Accuracy) -> str:
    """Errors by number of steps as CSV, in percent.

    Distances are root mean squares over the surface relative to the object's size, errors of bands
    relative to the band.
    """
    areas = mesh.vertex_areas / mesh.vertex_areas.sum()

    def mean(distances: NDArray[np.float64]) -> NDArray[np.float64]:
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


def told(text: str) -> str:
    """The same in a sentence."""
    rows = summary(text)[1:]
    return "; ".join(
        f"{steps} steps: bands {bands}, paper's all-pass {paper}" for steps, bands, paper in rows
    )


def measured(settings: Settings) -> Settings:
    """The settings that are measured: all their steps, and nothing limited.

    Raises Refusal if there is nothing to measure.
    """
    found = replace(settings, accuracy=0.0, vertex_group="")
    if not found.by.takes_steps:
        raise Refusal("this method takes no time steps, so there is nothing to measure")
    reason = found.complaint()
    if reason is not None:
        raise Refusal(reason)
    return found


def arguments(
    settings: Settings, mesh: spectral_tv.Mesh, base: NDArray[np.float64] | None
) -> Mapping[str, Any]:
    """The arguments of spectral_tv.accuracy after the mesh, of `measured` settings.

    ``base`` is as in Settings.arguments. Raises spectral_tv.MeshError if the scales make no sense.
    """
    found = settings.arguments(mesh, base)
    del found["times"]
    steps = {max(settings.steps // part, 2) for part in (1, 2, 4)}
    return {
        **found,
        "steps": sorted(steps),
        "bands": settings.bands,
        "scales": settings.scales(mesh.area),
        "keep_limbs": settings.limbs_kept,
    }


def needs(method: str, count: int, steps: int) -> Needs:
    """What measuring the accuracy takes, on so many vertices."""
    # A flow with eight times as many steps; of all, half and a quarter of them two kinds.
    return Settings(method=method, steps=11 * steps).needs(count)
