"""Estimates of the time and the memory of decompositions."""

import spectral_tv

from ..job.estimates import Needs, total
from ..options.declaring import keywords
from .settings import Settings


def of_meshes(settings: Settings, *counts: int) -> Needs:
    """What decomposing meshes of so many vertices takes."""
    arguments = {**settings.method_arguments(None, None), **keywords(settings)}
    arguments["steps"] = settings.steps
    found = [spectral_tv.estimate(count, **arguments) for count in counts]
    return total(found, is_least=settings.is_adaptive)


def of_accuracy(method: str, count: int, steps: int) -> Needs:
    """What measuring the accuracy takes, on so many vertices."""
    # A flow with eight times as many steps; of all, half and a quarter of them two kinds.
    return of_meshes(Settings(method=method, steps=11 * steps), count)
