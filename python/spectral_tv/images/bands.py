"""From a picture to its flow, and from the flow to bands and filtered pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import spectral_tv
from spectral_tv.bands.filtering import FILTERED, Curve, filter_values
from spectral_tv.dataclass import dataclass
from spectral_tv.images.flows import Request, Still, contrast_of
from spectral_tv.images.pixels import Pixels
from spectral_tv.images.settings import Settings
from spectral_tv.later import np
from spectral_tv.notes import note

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Prepared:
    """A picture, what of it is to flow, what of that is asked for, and the multiples of its bands
    that a filter adds."""

    pixels: Pixels
    request: Request
    settings: Settings
    values: Sequence[float]

    def filtered(self, flow: spectral_tv.Flow | Still) -> Pixels:
        """The picture with its bands kept, removed or amplified."""
        bands = self.request.bands(flow, self.settings.bands)
        return self.pixels.changed(np.tensordot(self.values, bands, axes=1))

    def filtered_bands(self, flow: spectral_tv.Flow | Still) -> NDArray[np.float64]:
        """What is left of the bands alone, as it is in what is stored, (H, W, C)."""
        gains = 1 + np.array(self.values)
        bands = self.request.bands(flow, self.settings.bands)
        return self.pixels.stored_change(np.tensordot(gains, bands, axes=1))

    def parts(
        self, flow: spectral_tv.Flow | Still
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The bands (K, H, W, C) and the rest (H, W, 3), which add up to the stored picture.

        If luminance is filtered, the bands are grey, and the rest has the colors.
        """
        changes = self.request.bands(flow, self.settings.bands)
        bands = np.stack([self.pixels.stored_change(each) for each in changes])
        return bands, self.pixels.stored[..., :3] - bands.sum(axis=0)


def prepare(pixels: Pixels, settings: Settings, curve: Curve | None = None) -> Prepared:
    """Find what is to flow, and the filter; ``curve`` is that of the settings, if they name it.

    Raises Refusal or spectral_tv.MeshError if the picture and the choice do not go together.
    """
    settings.check(curve)
    pixels.require_finite()
    values = pixels.luminance if settings.channels == "LUMINANCE" else pixels.colors
    contrast = contrast_of(values, pixels.visible) or 1.0
    # In the plane a disc of the radius r that stands out by h is gone at h r/2.
    finest, largest = (contrast * size / 4 for size in (settings.finest, settings.largest))
    request = Request(
        values=values,
        visible=pixels.visible,
        times=spectral_tv.graded_times(finest, largest, settings.steps),
        metric=settings.metric.lower(),
        height=settings.height,
        scheme="exact" if settings.exact else "extrapolated",
    )
    _tell(request)
    gains = filter_values(settings, curve) if FILTERED.holds(settings) else []
    return Prepared(pixels, request, settings, gains)


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
