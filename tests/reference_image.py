"""Spectral TV of images by finite differences and a primal-dual solver, independent of meshes.

The total variation is that of Chambolle 2004: Σ √(dx² + dy²) with forward differences, which are 0
across the border. Every implicit step is a problem of Rudin, Osher and Fatemi, solved by the
accelerated algorithm of Chambolle and Pock 2011.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# The squared norm of the gradient operator is below that.
NORM_SQUARED = 8.0


def gradient(u: Array) -> Array:
    """Forward differences of u (H, W, C) down and to the right, (2, H, W, C)."""
    g = np.zeros((2, *u.shape))
    g[0, :-1] = u[1:] - u[:-1]
    g[1, :, :-1] = u[:, 1:] - u[:, :-1]
    return g


def divergence(z: Array) -> Array:
    """The negative adjoint of `gradient`."""
    down, right = z
    d = np.zeros_like(down)
    d[:-1] += down[:-1]
    d[1:] -= down[:-1]
    d[:, :-1] += right[:, :-1]
    d[:, 1:] -= right[:, :-1]
    return d


def total_variation(u: Array) -> float:
    """Σ |∇u|, all channels together."""
    return float(np.sqrt((gradient(u) ** 2).sum(axis=(0, 3))).sum())


def rof(f: Array, tau: float, tolerance: float = 1e-4, most: int = 4000) -> Array:
    """Minimise ½‖u − f‖² + τ TV(u) for f (H, W, C), to a gap relative to τ TV(f)."""
    # In units of τ: ½‖u − f‖²/τ + TV(u), which is 1/τ-strongly convex.
    dual_step, primal_step = 1.0 / np.sqrt(NORM_SQUARED), 1.0 / np.sqrt(NORM_SQUARED)
    u, z = f.copy(), np.zeros((2, *f.shape))
    bar = u
    scale = max(tau * total_variation(f), 1e-300)
    for iteration in range(most):
        z = z + dual_step * gradient(bar)
        z /= np.maximum(1.0, np.sqrt((z**2).sum(axis=(0, 3), keepdims=True)))
        before = u
        u = (u + primal_step * divergence(z) + primal_step / tau * f) / (1.0 + primal_step / tau)
        theta = 1.0 / np.sqrt(1.0 + 2.0 * primal_step / tau)
        primal_step *= theta
        dual_step /= theta
        bar = u + theta * (u - before)
        if iteration % 20 == 19:
            best = f + tau * divergence(z)
            dual = 0.5 * ((f**2).sum() - (best**2).sum())
            primal = 0.5 * ((u - f) ** 2).sum() + tau * total_variation(u)
            if primal - dual <= tolerance * scale:
                break
    return u


def flow(f: Array, times: Array) -> Array:
    """States (N+1, H, W, C) of the TV flow of f (H, W, C), by implicit steps."""
    states = [f]
    for step in np.diff(times):
        states.append(rof(states[-1], float(step)))
    return np.stack(states)
