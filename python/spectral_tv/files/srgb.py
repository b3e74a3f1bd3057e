"""Values for displays, and the light that they stand for (IEC 61966-2-1)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from spectral_tv.later import np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def decoded(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Linear values of sRGB (IEC 61966-2-1)."""
    above = np.maximum(values, 0.04045)
    return np.where(values <= 0.04045, values / 12.92, ((above + 0.055) / 1.055) ** 2.4)


def encoded(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """SRGB (IEC 61966-2-1) of linear values."""
    above = np.maximum(values, 0.0031308)
    return np.where(values <= 0.0031308, 12.92 * values, 1.055 * above ** (1 / 2.4) - 0.055)
