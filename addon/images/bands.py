"""From a picture to its flow, and from the flow to bands and filtered pictures."""

from dataclasses import dataclass

import numpy as np
import spectral_tv
from spectral_tv.notes import note

from ..bands.filtering import filter_values
from .flows import Request, Still, contrast_of
from .pixels import Pixels
from .settings import Settings


@dataclass(frozen=True)
class Prepared:
    """A picture, what of it is to flow, and what of that is asked for."""

    pixels: Pixels
    request: Request
    settings: Settings

    def filtered(self, flow: spectral_tv.Flow | Still) -> Pixels:
        """The picture with its bands kept, removed or amplified."""
        bands = self.request.bands(flow, self.settings.bands)
        return self.pixels.changed(np.tensordot(filter_values(self.settings), bands, axes=1))

    def filtered_bands(self, flow: spectral_tv.Flow | Still) -> np.ndarray:
        """What is left of the bands alone, as it is in what is stored, (H, W, C)."""
        gains = 1 + np.array(filter_values(self.settings))
        bands = self.request.bands(flow, self.settings.bands)
        return self.pixels.stored_change(np.tensordot(gains, bands, axes=1))

    def parts(self, flow: spectral_tv.Flow | Still) -> tuple[np.ndarray, np.ndarray]:
        """The bands (K, H, W, C) and the rest (H, W, 3), which add up to the stored picture.

        If luminance is filtered, the bands are grey, and the rest has the colors.
        """
        changes = self.request.bands(flow, self.settings.bands)
        bands = np.stack([self.pixels.stored_change(each) for each in changes])
        return bands, self.pixels.stored[..., :3] - bands.sum(axis=0)


def prepare(pixels: Pixels, settings: Settings) -> Prepared:
    """Find what is to flow.

    Raises Refusal or spectral_tv.MeshError if the picture and the choice do not go together.
    """
    settings.check()
    pixels.require_finite()
    values = pixels.luminance if settings.channels == "LUMINANCE" else pixels.colors
    contrast = contrast_of(values, pixels.visible) or 1.0
    # In the plane a disc of the radius r that stands out by h is gone at h r/2.
    ends = [contrast * size / 4 for size in (settings.finest, settings.largest)]
    request = Request(
        values=values,
        visible=pixels.visible,
        times=spectral_tv.graded_times(*ends, settings.steps),
        metric=settings.metric.lower(),
        height=settings.height,
        scheme="exact" if settings.exact else "extrapolated",
    )
    _tell(request)
    return Prepared(pixels, request, settings)


def _tell(request: Request) -> None:
    """Note what of a picture cannot be filtered as one would expect."""
    if not request.visible.any():
        note("all of it is transparent: there is nothing to filter")
    elif request.contrast == 0:
        which = "its pixels" if request.visible.all() else "its pixels that can be seen"
        note(f"all of {which} are the same: there is nothing to filter")
    elif request.is_still:
        note("no four pixels that can be seen make a square: there is nothing to filter")
    elif request.metric == "surface" and request.values.shape[2] > 1 and not request.visible.all():
        note("as parts are transparent, the relief is of what its colors differ in most")
