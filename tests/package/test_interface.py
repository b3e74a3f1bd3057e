"""Shapes, names and documentation of the package."""

from __future__ import annotations

import inspect
import re
import tomllib
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest
import spectral_tv
from shapes import icosphere


def test_shapes_of_everything():
    vertices, triangles = icosphere(2)
    mesh = spectral_tv.Mesh(vertices, triangles)
    assert mesh.vertex_areas.shape == (162,)
    assert mesh.face_areas.shape == (320,)
    assert mesh.area == pytest.approx(4 * np.pi, rel=0.05)
    assert mesh.face_areas.sum() == pytest.approx(mesh.area)
    assert mesh.vertex_areas.sum() == pytest.approx(mesh.area)

    split = spectral_tv.decompose(mesh, steps=7)
    assert split.times.shape == (8,)
    assert split.spectrum.shape == (6,)
    assert split.residual.shape == (162, 3)
    assert split.band_edges(3).shape == (4,)
    assert split.bands(split.band_edges(3)).shape == (3, 162, 3)
    assert split.filter(np.ones(6)).shape == (162, 3)
    assert split.flow.states.shape == (8, 162, 3)

    for values, shape in ((vertices[:, 0], (4, 162)), (vertices[:, :2], (4, 162, 2))):
        flow = spectral_tv.flow(mesh, values, [0, 0.1, 0.2, 0.3])
        assert flow.states.shape == shape
        assert flow.total_variation.shape == (4,)
        assert flow.gap.shape == (3,)
        np.testing.assert_array_equal(flow.states[0], values)
    assert spectral_tv.conformal_flow(mesh, 0.1, 2).shape == (162, 3)
    assert isinstance(spectral_tv.total_variation(mesh, vertices), float)


def test_default_times_follow_the_area():
    """One filter then means the same on every size."""
    vertices, triangles = icosphere(2)
    ends = {"m1": 3e-3, "m2": 1e-2, "m3": 1e-3}
    for size in (1.0, 10.0):
        mesh = spectral_tv.Mesh(size * vertices, triangles)
        for method, end in ends.items():
            times = spectral_tv.decompose(mesh, method, steps=5).times
            assert times[-1] == pytest.approx(end * mesh.area)


def test_default_times_are_graded_times():
    mesh = spectral_tv.Mesh(*icosphere(2))
    for method in ("m1", "m2", "m3", "naive", "heat"):
        finest, largest = (scale * mesh.area for scale in spectral_tv.default_scales(method))
        times = spectral_tv.graded_times(finest, largest, steps=5)
        np.testing.assert_allclose(spectral_tv.decompose(mesh, method, steps=5).times, times)
    steps = np.diff(spectral_tv.graded_times(1e-3, 1.0, 100))
    np.testing.assert_allclose(steps[1:] / steps[:-1], 1001 ** (1 / 100))
    for finest, largest in ((0, 1), (1, 1), (2, 1), (np.nan, 1), (1, np.inf)):
        with pytest.raises(spectral_tv.MeshError, match="finest scale"):
            spectral_tv.graded_times(finest, largest)
    with pytest.raises(spectral_tv.MeshError, match="method must be"):
        spectral_tv.default_scales("m4")


def test_the_default_base_is_smoothed_for_the_default_time():
    mesh = spectral_tv.Mesh(*icosphere(2))
    time = spectral_tv.default_base_time() * mesh.area
    for method in ("m3", "displacement"):
        found, given = (
            spectral_tv.decompose(mesh, method, steps=4, **arguments).residual
            for arguments in ({}, {"base_time": time})
        )
        np.testing.assert_array_equal(found, given)


def test_components_are_in_the_band_whose_edges_hold_their_time():
    mesh = spectral_tv.Mesh(*icosphere(2))
    # The flow by eigenpairs is linear between its times.
    split = spectral_tv.decompose(mesh, "lb", times=[0, 1e-3, 2e-3, 4e-3, 8e-3])
    alone = split.bands([0, 1.5e-3, 3e-3, 1])
    # An edge that equals a time belongs to the band above it.
    np.testing.assert_allclose(split.bands([1e-3, 2e-3])[0], alone[0], atol=1e-15)
    np.testing.assert_allclose(split.bands([2e-3, 4e-3])[0], alone[1], atol=1e-15)
    np.testing.assert_allclose(split.bands([5e-3, 7e-3])[0], 0)


def test_everything_public_is_documented():
    for name in spectral_tv.__all__:
        item = getattr(spectral_tv, name)
        if name == "__version__":
            continue
        if name.isupper():
            assert f"{name}[" in spectral_tv.__doc__
            continue
        assert item.__doc__, name
        assert not re.search(r"^ *\{\w+\}$", item.__doc__, re.MULTILINE), name
        if is_dataclass(item):
            for part in fields(item):
                assert f"{part.name} : " in item.__doc__ or not part.repr, part.name
        elif inspect.isclass(item) and not issubclass(item, Exception):
            for attribute, member in vars(item).items():
                if not attribute.startswith("_"):
                    assert member.__doc__, f"{name}.{attribute}"


def test_signatures_spell_out_options_with_the_defaults_of_the_library():
    parameters = inspect.signature(spectral_tv.decompose).parameters
    for name, default in spectral_tv.DEFAULTS.items():
        assert parameters[name].default == default, name
        assert name == "method" or f"\n{name} : " in spectral_tv.decompose.__doc__
    stepped = inspect.signature(spectral_tv.flow).parameters
    assert [*stepped][-3:] == ["scheme", "tolerance", "solver"]
    with pytest.raises(TypeError, match="unexpected keyword argument 'stepz'"):
        spectral_tv.decompose(spectral_tv.Mesh(*icosphere(1)), stepz=3)


def test_choices_are_documented_by_the_names_that_the_library_knows():
    mesh = spectral_tv.Mesh(*icosphere(1))
    takers = {
        "method": lambda **options: spectral_tv.decompose(mesh, **options),
        "scheme": lambda **options: spectral_tv.decompose(mesh, **options),
        "solver": lambda **options: spectral_tv.decompose(mesh, **options),
        "operator": lambda **options: spectral_tv.flow(mesh, mesh.vertices, [0, 1], **options),
        "algorithm": lambda **options: spectral_tv.deform(mesh, [0], [[0, 0, 0]], **options),
    }
    public = [getattr(spectral_tv, name) for name in spectral_tv.__all__]
    text = "".join(each.__doc__ for each in public if inspect.isfunction(each))
    for name, take in takers.items():
        with pytest.raises(spectral_tv.MeshError) as refused:
            take(**{name: "magic"})
        known = re.findall(r'"(\w+)"', str(refused.value))[:-1]
        assert f"{name} : {{" + ", ".join(f'"{each}"' for each in known) + "}\n" in text
    stepped = [name for name, facts in spectral_tv.METHODS.items() if facts.takes_steps]
    told = re.search(r"method : (.*)", spectral_tv.accuracy.__doc__)[1]
    assert set(re.findall(r'"(\w+)"', told)) == set(stepped)


def test_options_of_other_functions_are_refused():
    """They would be of no account."""
    mesh = spectral_tv.Mesh(*icosphere(1))
    calls = [
        lambda: spectral_tv.flow(mesh, mesh.vertices, [0, 0.1], accuracy=0.1),
        lambda: spectral_tv.start_flow(mesh, mesh.vertices, [0, 0.1], p=3),
        lambda: spectral_tv.accuracy(mesh, steps=[2], accuracy=0.1),
        lambda: spectral_tv.decompose_image(np.eye(4), base_time=None),
        lambda: spectral_tv.start_decompose(mesh, progress=print),
    ]
    for call in calls:
        with pytest.raises(TypeError, match="unexpected keyword argument"):
            call()


def test_facts_of_methods_are_those_that_decompose_goes_by():
    mesh = spectral_tv.Mesh(*icosphere(1))
    values = {"p": 2, "base": mesh.vertices / 2, "base_time": 0.1, "metric": "base"}
    values |= {"eigenpairs": 5, "accuracy": 0.5}
    for method, facts in spectral_tv.METHODS.items():
        for name, value in values.items():
            if name in facts.options:
                spectral_tv.decompose(mesh, method, steps=4, **{name: value})
                continue
            with pytest.raises(spectral_tv.MeshError, match=f"^{name} is an option of the method"):
                spectral_tv.decompose(mesh, method, steps=4, **{name: value})


def test_version_is_that_of_cargo():
    root = Path(__file__).resolve().parents[2]
    cargo = tomllib.loads((root / "Cargo.toml").read_text(encoding="utf-8"))
    assert spectral_tv.__version__ == cargo["workspace"]["package"]["version"]
