"""Figure 16: the error of the bands with too few steps. All-pass filters are exact here."""

from __future__ import annotations

import numpy as np
import spectral_tv

from .colors import colors
from .gallery import Gallery

STEPS = (4, 8, 16, 32)
REFINED = 128
# Of the colors, as powers of ten.
SCALE = (-4.5, -2.0)


def make(gallery: Gallery) -> None:
    """The error of the flow against a refined one, beside that of the all-pass."""
    for name, shape in gallery.subjects("armadillo"):
        mesh = shape.mesh
        size = mesh.area**0.5
        moment = 3e-4 * mesh.area
        refined = spectral_tv.decompose(mesh, "m1", steps=REFINED)
        names, painted = [], []
        for steps in STEPS:
            stride = REFINED // steps
            split = spectral_tv.decompose(mesh, "m1", refined.times[::stride])
            # Both flows are compared at a time that both have.
            k = np.abs(split.times - moment).argmin()
            offset = split.flow.states[k] - refined.flow.states[k * stride]
            error = np.linalg.norm(offset, axis=1) / size
            all_pass = np.abs(split.filter(np.ones(steps - 1)) - shape.vertices).max() / size
            painted.append(colors(np.log10(np.maximum(error, 1e-9)), *SCALE))
            names.append(f"{steps} steps: {error.mean():.0e}, all-pass {all_pass:.0e}")
        shots = shape.painted(painted, cell=210)
        title = "M1: mean error of the flow at one moment, in sizes of the shape"
        gallery.save("accuracy", [(title, [list(zip(names, shots, strict=True))])], name, cell=210)
