"""The values of a picture that are filtered, and the picture that they become.

Values are as they are in the file: encoded for displays, or proportional to light if the picture is
scene-linear. If colors are stored multiplied by alpha, they are divided by it first. The result is
the stored picture plus the changes. So what does not change stays as it is, to the last bit.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Of red, green and blue in luminance (ITU-R BT.709).
LUMINANCE = (0.2126, 0.7152, 0.0722)
# From this opacity on, a color is what a surface has rather than what it emits.
MOSTLY = 0.5
# What rounding may make of a color, relative to it.
ROUNDING = 1e-3


@dataclass(frozen=True)
class Pixels:
    """A picture from the bottom up: ``stored`` (H, W, 4) float32, red, green, blue and alpha."""

    stored: NDArray[np.float32]
    # As Blender names it.
    space: str
    # Whether alpha is how opaque a pixel is, rather than nothing or a channel like the others.
    has_alpha: bool
    # Whether colors are stored multiplied by alpha.
    is_associated: bool

    @cached_property
    def visible(self) -> NDArray[np.bool_]:
        """The pixels whose colors mean something, (H, W).

        That is not so where alpha is 0. Nor where light is added without covering what is behind,
        as by fire: there a color multiplied by alpha exceeds by far what alpha shows elsewhere.
        """
        alpha = self.stored[..., 3]
        if not self.has_alpha:
            return np.ones(alpha.shape, dtype=bool)
        visible = alpha > 0
        solid = alpha >= MOSTLY
        if self.is_associated and solid.any():
            brightest = (self.stored[solid, :3] / alpha[solid, None]).max(axis=0)
            limit = np.maximum(brightest, 1) * (1 + ROUNDING) * alpha[..., None]
            visible &= (self.stored[..., :3] <= limit).all(axis=2)
        return visible

    @cached_property
    def colors(self) -> NDArray[np.float64]:
        """Not multiplied by alpha, (H, W, C) float64; C is 1 if all channels are alike.

        As they are stored where they mean nothing.
        """
        colors = self.stored[..., :3].astype(np.float64)
        if self.is_associated and self.has_alpha:
            colors[self.visible] /= self.stored[self.visible, 3:]
        if (self.stored[..., :3] == self.stored[..., :1]).all():
            return colors[..., :1]
        return colors

    @property
    def luminance(self) -> NDArray[np.float64]:
        """Of colors, (H, W, 1)."""
        if self.colors.shape[2] != len(LUMINANCE):
            return self.colors
        return (self.colors @ LUMINANCE)[..., np.newaxis]

    def require_finite(self) -> None:
        """Raise Refusal if a value that means something is not finite."""
        wanted = slice(None) if self.has_alpha else slice(3)
        broken = ~np.isfinite(self.stored[..., wanted]).all(axis=2)
        if self.has_alpha:
            broken &= self.stored[..., 3] != 0
        places = np.argwhere(broken)
        if len(places):
            row, column = places[0]
            others = f", nor are {len(places) - 1} others" if len(places) > 1 else ""
            raise Refusal(
                f"the pixel at {column}, {row} from the lower left is not a finite number{others}"
            )

    def stored_change(self, change: NDArray[np.float64]) -> NDArray[np.float64]:
        """What a change of the colors (H, W, C) is in what is stored."""
        if self.is_associated and self.has_alpha:
            return change * self.stored[..., 3:]
        return change

    def changed(self, change: NDArray[np.float64]) -> Pixels:
        """The same with its colors changed by (H, W, C)."""
        stored = self.stored.copy()
        stored[..., :3] += self.stored_change(change)
        return replace(self, stored=stored)

    def associated(self, is_associated: bool) -> Pixels:
        """The same with its colors multiplied by alpha, or not.

        Colors under alpha 0 stay if they come to be divided by it, and else become 0.
        """
        if not self.has_alpha or is_associated == self.is_associated:
            return replace(self, is_associated=is_associated)
        stored = self.stored.astype(np.float64)
        alpha = stored[..., 3:]
        stored[..., :3] *= alpha if is_associated else 1 / np.where(alpha == 0, 1, alpha)
        return replace(self, stored=stored.astype(np.float32), is_associated=is_associated)
