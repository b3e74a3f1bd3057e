"""Figure 17: an image by spectral TV and by spectral ATV."""

from __future__ import annotations

import numpy as np
import spectral_tv

from .gallery import Gallery
from .page import Shape, picture
from .shapes import lattice

SIDE, HEIGHT = 160, 40.0


def make(gallery: Gallery) -> None:
    """Low-pass and band-stop in both metrics, and the image as a surface."""
    image = clouds()
    y, x = np.mgrid[:SIDE, :SIDE]
    relief = np.stack([x, y, HEIGHT * image], axis=-1).reshape(-1, 3).astype(float)
    surface = Shape(relief, lattice(SIDE, SIDE, (False, False)), azimuth=20, elevation=55)
    shots = [picture(image, 210), surface.positions([relief], cell=210)[0]]
    rows = []
    for metric, label, first in (("flat", "TV", "The image"), ("surface", "ATV", "As a surface")):
        flow = spectral_tv.decompose_image(image, metric, steps=48, height=HEIGHT)
        bands = flow.bands(flow.band_edges(6))
        low = flow.residual + bands[4:].sum(axis=0)
        stop = low + bands[:2].sum(axis=0)
        row = [(first, shots.pop(0))]
        row += [
            (f"{label}, low-pass", picture(low, 210)),
            (f"{label}, band-stop", picture(stop, 210)),
        ]
        rows.append(row)
    gallery.save("clouds", [("Spectral TV and ATV of an image", rows)], cell=210)


def clouds() -> np.ndarray:
    """Heaped clouds on a sky, (H, W) in [0, 1], from the bottom up: round billows on billows."""
    rng = np.random.default_rng(3)
    y, x = np.mgrid[:SIDE, :SIDE] / SIDE
    sky = 0.22 + 0.2 * (1 - y)
    image = sky.copy()
    centres = [(0.3, 0.35, 0.17), (0.68, 0.5, 0.2), (0.5, 0.28, 0.15), (0.85, 0.22, 0.12)]
    for cx, cy, size in centres:
        for generation, count in enumerate((4, 14, 40)):
            for _ in range(count):
                angle, far = rng.uniform(0, 2 * np.pi), size * rng.uniform(0.3, 1) ** 0.5
                px, py = cx + 1.3 * far * np.cos(angle), cy + 0.7 * far * abs(np.sin(angle))
                radius = size * 0.5 ** (1 + 0.6 * generation) * rng.uniform(0.7, 1.2)
                gap = np.hypot(x - px, y - py) / radius
                dome = np.sqrt(np.clip(1 - gap**2, 0, 1))
                lit = (
                    0.55 + 0.4 * dome * (0.5 + 0.5 * (y - py) / radius) + 0.12 * rng.uniform(-1, 1)
                )
                cover = np.clip((1 - gap) * 12, 0, 1) * (0.75 if generation else 1)
                image += cover * (lit - image)
    return np.clip(image, 0, 1)
