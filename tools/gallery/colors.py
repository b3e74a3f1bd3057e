"""Values and labels as colors."""

from __future__ import annotations

import numpy as np

# From low to high, sRGB: dark blue over green to yellow, even in lightness.
SEQUENTIAL = np.array(
    [(48, 34, 92), (46, 88, 148), (38, 140, 142), (108, 190, 104), (250, 226, 84)]
)  # fmt: skip
# Of segments, sRGB.
DISTINCT = np.array(
    [(86, 132, 190), (226, 136, 70), (98, 170, 104), (204, 92, 98), (146, 120, 190), (226, 196, 92)]
)  # fmt: skip


def colors(values: np.ndarray, low: float, high: float) -> np.ndarray:
    """Linear colors (V, 3) of values (V,) on the scale from ``low`` to ``high``."""
    share = np.clip((values - low) / (high - low), 0, 1) * (len(SEQUENTIAL) - 1)
    places = np.arange(len(SEQUENTIAL))
    encoded = np.column_stack([np.interp(share, places, column) for column in SEQUENTIAL.T])
    return _linear(encoded)


def labels(numbers: np.ndarray) -> np.ndarray:
    """Linear colors (V, 3) of labels from 0."""
    return _linear(DISTINCT[numbers % len(DISTINCT)].astype(float))


def _linear(encoded: np.ndarray) -> np.ndarray:
    """SRGB from 0 to 255 as linear values from 0 to 1."""
    share = encoded / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
