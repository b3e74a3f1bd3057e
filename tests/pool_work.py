"""Work for processes of any kind: they import it by name, and find it beside what they import."""

from __future__ import annotations

import hashlib
import pickle

import numpy as np
import spectral_tv
from shapes import bumpy_sphere


def everything() -> dict[str, str]:
    """What every entry point of the package gives for a small sphere, as digests of the bits."""
    vertices, triangles = bumpy_sphere(2)
    mesh = spectral_tv.Mesh(vertices, triangles)
    split = spectral_tv.decompose(mesh, "m1", steps=6)
    ends = np.flatnonzero(np.abs(vertices[:, 2]) > 0.7)
    targets = vertices[ends] + np.where(vertices[ends, 2:] > 0, 1, 0) * [0.4, 0.1, 0.2]
    times = spectral_tv.graded_times(1e-4, 1e-1, 6)
    deformer = spectral_tv.Deformer(mesh, ends)
    bodies = np.where(vertices[ends, 2] > 0, 0, -1)
    poser = spectral_tv.Poser(mesh, ends, bodies=bodies)
    upper = vertices[:, 2] > 0.3
    soup = vertices[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3)
    found: dict[str, object] = {
        "areas": mesh.vertex_areas,
        "open edges": mesh.findings.open_edges,
        "states": split.flow.states,
        "bands": split.bands(split.band_edges(3)),
        "filtered": split.filter(np.linspace(0, 2, 5)),
        "spectrum": split.flow.spectrum,
        "mean": split.flow.mean(upper),
        "flow": spectral_tv.flow(mesh, vertices[:, 2], times).residual,
        "heat": spectral_tv.flow(mesh, vertices, times, "heat").residual,
        "exact": spectral_tv.decompose(mesh, "naive", steps=3, scheme="exact").residual,
        "image": spectral_tv.decompose_image(vertices[:144, 2].reshape(12, 12), steps=5).residual,
        "accuracy": spectral_tv.accuracy(mesh, steps=[4], bands=2, refinement=2).bands,
        "eigenpairs": spectral_tv.eigenpairs(mesh, 5),
        "caricature": spectral_tv.caricature([mesh], (1e-4, 1e-2), steps=5),
        "segments": spectral_tv.cosegment([split], 3),
        "conformal": spectral_tv.conformal_flow(mesh, 0.01, 3),
        "variation": spectral_tv.total_variation(mesh, vertices),
        "eigenset": spectral_tv.eigenset_test(mesh, upper).values,
        "solved": deformer.solve(targets).vertices,
        "dragged": deformer.drag(targets + np.array([0, 0, 0.1])).vertices,
        "sequence": deformer.solve_sequence([targets, targets * 1.1])[1].vertices,
        "pose": spectral_tv.pose(mesh, ends, targets).rotations,
        "posed": poser.solve(targets).vertices,
        "pose dragged": poser.drag(targets + np.array([0, 0, 0.1])).vertices,
        "poses": poser.solve_sequence([targets, targets * 1.1])[1].rotations,
        "folds": spectral_tv.folds(mesh, 2 * vertices[:, [1, 0, 2]]).flipped,
        "safe": spectral_tv.safe_displacement(mesh, 2 * vertices[:, [1, 0, 2]]).displacement,
        "crossing": spectral_tv.self_intersections(mesh, vertices[:, [1, 0, 2]]),
        "bytes": spectral_tv.estimate(mesh).bytes,
        "mesh": spectral_tv.Mesh(vertices, triangles),
        "welded": spectral_tv.Mesh(*soup, weld=0.0),
        "decomposition": split,
        "deformer": deformer,
        "poser": poser,
        "again": pickle.loads(pickle.dumps(split)).residual,
        "job": spectral_tv.start_decompose(mesh, "heat", steps=5).result().residual,
    }
    for method in ("m1", "m2", "m3", "lb", "displacement"):
        for solver in ("cholesky", "single", "multigrid"):
            again = spectral_tv.decompose(mesh, method, steps=5, solver=solver)
            found[f"{method} by {solver}"] = again.residual
    for algorithm in ("paper", "harmonic", "biharmonic", "arap"):
        found[algorithm] = spectral_tv.deform(mesh, ends, targets, algorithm=algorithm).vertices
    return {name: digest(value) for name, value in found.items()}


def digest(value: object) -> str:
    """Whether two values have the same bits."""
    return hashlib.sha256(pickle.dumps(value, 5)).hexdigest()


def filtered(split: spectral_tv.Decomposition, gain: float) -> np.ndarray:
    """A decomposition that came from another process, filtered."""
    return split.filter(np.full(len(split.spectrum), gain))


def number_of_everything(_: object = None) -> int:
    """How many threads this process uses, once all has been at work."""
    everything()
    return spectral_tv.threads()
