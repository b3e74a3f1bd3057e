"""What the library computes of given meshes, to be compared between platforms.

    python results.py meshes FILE           write the meshes
    python results.py compute MESHES FILE   write what is computed of them
    python results.py compare FILE FILE…    say how far each other file is from the first

The meshes come from a file, as NumPy's sines differ between platforms. A difference is that of the
largest entries, relative to the largest entry. More than TOLERANCE is a failure. TOLERANCES has the
results with another bound: the eigenset test of the dumbbell magnifies rounding. On one platform it
changes by 2e-10 if the last bit of some coordinates changes.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

TOLERANCE = 1e-10
TOLERANCES = {"eigenset": 1e-9}


def meshes(file: str) -> None:
    """Write meshes of different topology: closed, with borders, with a narrow place."""
    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))
    from shapes import bumpy_sphere, cylinder_open, dumbbell, torus  # noqa: PLC0415

    shapes = {
        "bumpy_sphere": bumpy_sphere(4),
        "cylinder_open": cylinder_open(),
        "dumbbell": dumbbell(),
        "torus": torus(2.0, 0.7, 60, 30),
    }
    arrays: dict[str, NDArray[Any]] = {}
    for name, (vertices, triangles) in shapes.items():
        arrays[f"{name} vertices"], arrays[f"{name} triangles"] = vertices, triangles
    np.savez(file, **arrays)


def compute(source: str, file: str) -> None:
    """Run every method, flow, deformation, segmentation and test on the meshes."""
    import spectral_tv  # noqa: PLC0415

    print(sys.version, np.__version__, spectral_tv.__file__, sep="\n")
    arrays = np.load(source)
    names = sorted({key.split()[0] for key in arrays})
    results: dict[str, NDArray[Any]] = {}
    for name in names:
        vertices = arrays[f"{name} vertices"]
        mesh = spectral_tv.Mesh(vertices, arrays[f"{name} triangles"])
        splits = {m: spectral_tv.decompose(mesh, m) for m in ("naive", "m1", "m2", "m3", "heat")}
        for method, split in splits.items():
            results[f"{name} {method} bands"] = split.bands(split.band_edges(5))
            results[f"{name} {method} residual"] = split.residual
        times = 1e-3 * mesh.area * np.arange(5)
        for exact in (False, True):
            flow = spectral_tv.flow(mesh, vertices[:, 2], times, exact=exact)
            results[f"{name} flow {'exact' if exact else 'steps'}"] = flow.states
        results[f"{name} conformal flow"] = spectral_tv.conformal_flow(mesh, 0.01 * mesh.area)
        height = vertices[:, 2]
        low = np.flatnonzero(height < np.quantile(height, 0.1))
        high = np.flatnonzero(height > np.quantile(height, 0.9))
        targets = np.vstack([vertices[low], vertices[high] + [0.3, 0.0, 0.5]])
        held = np.concatenate([low, high])
        for algorithm in ("convex", "paper", "arap"):
            moved = spectral_tv.deform(mesh, held, targets, algorithm=algorithm)
            results[f"{name} deformation {algorithm}"] = moved.vertices
        (labels,) = spectral_tv.cosegment([splits["m2"]], segments=4)
        results[f"{name} segments"] = labels
        members = height > np.quantile(height, 0.7)
        results[f"{name} eigenset"] = spectral_tv.eigenset_test(mesh, members).values
    np.savez(file, **results)


def compare(first: str, *others: str) -> None:
    """Print the largest difference of every kind of result, and fail if one is too large."""
    failed = False
    expected = np.load(first)
    for other in others:
        found = np.load(other)
        assert set(found) == set(expected), f"{other} holds other results than {first}"
        worst: dict[str, float] = {}
        for key, values in expected.items():
            kind = key.split(maxsplit=1)[1]
            difference = np.abs(found[key] - values).max() / np.abs(values).max()
            worst[kind] = max(worst.get(kind, 0.0), float(difference))
        for kind, difference in worst.items():
            is_right = difference <= TOLERANCES.get(kind, TOLERANCE)
            failed |= not is_right
            verdict = "" if is_right else "  too much"
            print(f"{Path(other).stem:18} {kind:24} {difference:.1e}{verdict}")
    sys.exit(failed)


if __name__ == "__main__":
    verb, *arguments = sys.argv[1:]
    verbs: dict[str, Callable[..., None]]
    verbs = {"meshes": meshes, "compute": compute, "compare": compare}
    verbs[verb](*arguments)
