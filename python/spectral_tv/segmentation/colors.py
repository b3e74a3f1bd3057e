"""The colors of parts."""

import colorsys

# Hues a golden angle apart stay distinct however many there are.
GOLDEN = 0.618034


def color(label: int) -> tuple[float, float, float]:
    """The color of a part."""
    return colorsys.hsv_to_rgb((0.02 + GOLDEN * label) % 1, 0.65, 0.85 if label % 2 else 0.7)
