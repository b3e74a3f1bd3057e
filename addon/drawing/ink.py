"""Letters and colors for pictures that are drawn pixel by pixel."""

from __future__ import annotations

import colorsys

from spectral_tv.later import np

HEIGHT = 5
# Hues of the first and the last of several curves or bands.
HUES = (0.57, 0.06)
LETTERS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ.-+_:/"
# Of every letter five rows of 3 pixels from the top, as octal digits.
_ROWS = (
    "75557262277174771717557117471774757711227575775717"
    "25755656563444365556746477464434553557557222711152"
    "55655444475775565555255526564425563656553421672222"
    "5555755552557755525555222712470000200700027200000702020"
    "11244"
)
_GLYPHS = {letter: _ROWS[5 * place : 5 * place + 5] for place, letter in enumerate(LETTERS)}


def mask(text: str, pixel: int) -> np.ndarray:
    """Where ink goes, from the bottom up: 5 rows and 4 columns a letter, ``pixel`` wide each."""
    image = np.zeros((HEIGHT, max(4 * len(text) - 1, 0)), dtype=bool)
    for place, letter in enumerate(text.upper()):
        for row, bits in enumerate(_GLYPHS.get(letter, "00000")):
            for column in range(3):
                image[HEIGHT - 1 - row, 4 * place + column] = int(bits) >> (2 - column) & 1
    return np.kron(image, np.ones((pixel, pixel), dtype=bool))


def color(number: int, count: int) -> tuple[float, ...]:
    """RGBA of one of several, counted from 0."""
    hue = HUES[0] + (HUES[1] - HUES[0]) * number / max(count - 1, 1)
    return (*colorsys.hsv_to_rgb(hue, 0.6, 0.8), 1.0)
