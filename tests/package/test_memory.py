"""Memory is estimated before work starts, and work that does not fit is refused."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import spectral_tv
from own_process import output
from shapes import icosphere

TESTS = Path(__file__).resolve().parents[1]
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="reads and sets what Linux has")

# What every process begins with: a wavy grid of `side` by `side` vertices, and readings in bytes.
START = f"""
import resource, sys
sys.path.insert(0, {str(TESTS)!r})
import numpy as np, spectral_tv
from shapes import grid

def reading(name):
    lines = open("/proc/self/status").read().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(name + ":"))

def surface(side):
    vertices, triangles = grid(side, side)
    wave = 0.1 * np.sin(9 * vertices[:, 0]) * np.cos(7 * vertices[:, 1])
    return spectral_tv.Mesh(vertices + wave[:, np.newaxis] * [0, 0, 1], triangles)
"""


def run(code: str) -> str:
    """The output of a process of its own, whose peak is not this one's."""
    return output(START + code, timeout=600)


@LINUX
@pytest.mark.bare
def test_memory_is_given_back_after_long_work():
    output = run("""
import time
mesh = surface(300)
before = reading("VmRSS")
for _ in range(2):
    spectral_tv.decompose(mesh, "m1", steps=60)
    time.sleep(0.5)  # the thread frees after it has answered
print(reading("VmHWM") - before, reading("VmRSS") - before)
""")
    most, left = map(float, output.split())
    assert left < 0.25 * most


@LINUX
@pytest.mark.bare
@pytest.mark.parametrize("side", [100, 180])
@pytest.mark.parametrize(
    "settings",
    [
        {"method": "m1", "steps": 8},
        {"method": "m1", "steps": 64},
        {"method": "m1", "steps": 64, "solver": "multigrid"},
        {"method": "m1", "steps": 8, "scheme": "exact"},
        {"method": "m2", "steps": 32},
        {"method": "m3", "steps": 32},
        {"method": "naive", "steps": 32},
        {"method": "heat", "steps": 32},
        {"method": "lb", "eigenpairs": 100},
        {"method": "displacement"},
    ],
    ids=lambda settings: "-".join(map(str, settings.values())),
)
def test_the_estimate_is_within_a_factor_of_two_of_the_peak(side, settings):
    output = run(f"""
mesh = surface({side})
estimate = spectral_tv.estimate(mesh, **{settings!r})
open("/proc/self/clear_refs", "w").write("5")  # the peak starts from what is held now
before = reading("VmRSS")
split = spectral_tv.decompose(mesh, **{settings!r})
print(estimate.bytes / (reading("VmHWM") - before))
""")
    assert 0.5 < float(output) < 2


@LINUX
@pytest.mark.bare
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            "spectral_tv.decompose(mesh, steps=5000)",
            "decomposing 10000 vertices takes about 1.2 GB",
        ),
        ("spectral_tv.start_decompose(mesh, steps=5000).result()", "take fewer steps"),
        ("spectral_tv.decompose(mesh, 'lb', eigenpairs=9000)", "take fewer eigenpairs"),
        ("spectral_tv.eigenpairs(mesh, 9000)", "finding 9000 eigenpairs on 10000 vertices"),
        ("spectral_tv.flow(mesh, mesh.vertices, np.linspace(0, 1, 5000))", "take fewer steps"),
        ("spectral_tv.decompose_image(np.eye(100), steps=20_000)", "take fewer steps"),
        ("split.bands(np.linspace(0, 1, 5000))", "an array of 4999 states or bands"),
        ("split.flow.bands(np.linspace(0, 1, 5000))", "take them in parts"),
        ("spectral_tv.deform(surface(600), [0, 9], [[0, 0, 0], [1, 1, 1]])", "fewer vertices"),
        ("spectral_tv.conformal_flow(mesh, 1e-3, steps=5000)", "a conformal flow of 5000 steps"),
        (
            "spectral_tv.eigenset_test(surface(600), np.arange(600**2) < 9000)",
            "testing a set of 360000 vertices",
        ),
        ("spectral_tv.cosegment([split] * 100, 2)", "segmenting 1000000 vertices"),
        (
            "spectral_tv.caricature([mesh], (1e-4, 1e-3), steps=5000)",
            "exaggerating shapes of 10000",
        ),
        ("spectral_tv.accuracy(mesh, steps=[500])", "a flow of 4000 steps on 10000 vertices"),
        ("spectral_tv.decompose_image(np.eye(600))", "an image of 600 × 600 pixels takes about"),
        (
            "deformer.solve_sequence([targets] * 3000)",
            "deforming 10000 vertices 3000 times takes about 726 MB",
        ),
        ("deformer.start_solve_sequence([targets] * 3000).result()", "take fewer at a time"),
        (
            "poser.solve_sequence([targets] * 3000)",
            "posing 10000 vertices 3000 times takes about 1.7 GB",
        ),
        (
            "spectral_tv.pose(surface(600), [0, 9], [[0, 0, 0], [1, 1, 1]])",
            "posing 360000 vertices takes about 1.8 GB",
        ),
    ],
)
@pytest.mark.parametrize(("limit", "used"), [("AS", "VmSize"), ("DATA", "VmData")])
def test_what_does_not_fit_is_a_memory_error_and_leaves_the_process_alive(
    call, message, limit, used
):
    output = run(f"""
mesh = surface(100)
split = spectral_tv.decompose(mesh, steps=8)
deformer = spectral_tv.Deformer(mesh, [0, 9])
poser = spectral_tv.Poser(mesh, [0, 9])
targets = mesh.vertices[[0, 9]] + [[0, 0, 0], [0, 0, 1]]
room = reading("{used}") + 400 * 10**6
resource.setrlimit(resource.RLIMIT_{limit}, (room, room))
try:
    {call}
except MemoryError as error:
    print(error)
again = spectral_tv.decompose(mesh, steps=8)
assert (again.residual == split.residual).all()
""")
    assert message in output
    assert "are available" in output


@LINUX
@pytest.mark.bare
def test_a_thousand_frames_of_a_large_mesh_are_refused_before_the_first():
    output = run("""
mesh = surface(300)
ends = [0, 300**2 - 1]
deformer = spectral_tv.Deformer(mesh, ends)
room = reading("VmSize") + 10**9
resource.setrlimit(resource.RLIMIT_AS, (room, room))
try:
    deformer.solve_sequence([mesh.vertices[ends]] * 1000)
except MemoryError as error:
    print(error)
assert deformer.solve(mesh.vertices[ends] + 1).iterations == 0
""")
    assert "deforming 90000 vertices 1000 times takes about 2.2 GB of memory" in output


@LINUX
@pytest.mark.parametrize(("limit", "used"), [("AS", "VmSize"), ("DATA", "VmData")])
def test_a_limit_of_the_process_is_what_is_available(limit, used):
    output = run(f"""
spectral_tv.estimate(100)  # its threads have their addresses
room = reading("{used}") + 10**8
resource.setrlimit(resource.RLIMIT_{limit}, (room, room))
print(spectral_tv.estimate(100).available)
""")
    assert 5e7 < float(output) < 1.1e8


def test_an_estimate_is_of_a_mesh_or_of_its_number_of_vertices():
    mesh = spectral_tv.Mesh(*icosphere(3))
    for method in ("m1", "m2", "m3", "naive", "heat", "lb", "displacement"):
        one = spectral_tv.estimate(mesh, method)
        other = spectral_tv.estimate(len(mesh.vertices), method)
        assert one.bytes == other.bytes > 0
        assert one.seconds == other.seconds > 0
        assert one.fits
        assert one.available is not None
        assert one.available > 0
    times = np.linspace(0, 1, 33)
    assert spectral_tv.estimate(mesh, times=times).bytes == spectral_tv.estimate(mesh).bytes
    more = [spectral_tv.estimate(mesh, steps=steps).bytes for steps in (8, 16, 32)]
    assert more == sorted(set(more))
    least = spectral_tv.estimate(mesh, accuracy=0.1)
    assert least.bytes == spectral_tv.estimate(mesh, steps=36).bytes


def test_an_estimate_refuses_what_decompose_does():
    with pytest.raises(spectral_tv.MeshError, match="method must be"):
        spectral_tv.estimate(100, "m4")
    with pytest.raises(spectral_tv.MeshError, match="steps must be at most 1000000"):
        spectral_tv.estimate(100, steps=2**40)
    for mesh in (-1, 1.5, None, "mesh"):
        with pytest.raises(TypeError, match="mesh must be a Mesh or a number of vertices"):
            spectral_tv.estimate(mesh)
