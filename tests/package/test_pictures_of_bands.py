"""Spectra are drawn by Matplotlib, and meshes with sliders are shown by PyVista."""

from __future__ import annotations

import subprocess
import sys

import matplotlib as mpl
import numpy as np
import pytest
import pyvista
import spectral_tv
from shapes import icosphere

mpl.use("Agg")
from matplotlib import pyplot


@pytest.fixture(scope="module")
def split():
    vertices, triangles = icosphere(3)
    waves = 1 + 0.1 * np.sin(8 * vertices[:, :1])
    return spectral_tv.decompose(spectral_tv.Mesh(vertices * waves, triangles), steps=12)


@pytest.fixture
def axes():
    figure, made = pyplot.subplots()
    yield made
    pyplot.close(figure)


def test_the_mesh_of_a_decomposition_is_the_one_that_was_split(split):
    whole = split.residual + split.bands(split.band_edges(3)).sum(axis=0)
    assert np.allclose(split.mesh.vertices, whole, atol=1e-12)
    assert len(split.mesh.triangles) == 1280


@pytest.mark.parametrize("kind", ["decomposition", "flow"])
def test_plot_draws_the_spectrum_over_its_bands(split, axes, kind):
    drawn = split if kind == "decomposition" else split.flow
    edges = split.band_edges(3)
    assert drawn.plot(edges=edges, axes=axes) is axes
    (line,) = axes.lines
    assert np.array_equal(line.get_xdata(), drawn.times[1:-1])
    assert np.array_equal(line.get_ydata(), drawn.spectrum)
    left = [patch.get_x() for patch in axes.patches]
    assert np.allclose(left[1:], edges[1:-1])
    assert axes.get_xscale() == "log"  # as the times are graded
    assert [text.get_text() for text in axes.get_legend().texts] == ["band 1", "band 2", "band 3"]


def test_plot_draws_into_the_current_axes_five_bands(split, axes):
    pyplot.sca(axes)
    assert split.plot() is axes
    assert len(axes.patches) == 5


def test_even_times_are_drawn_evenly(axes):
    vertices, triangles = icosphere(2)
    times = np.linspace(0, 1, 5)
    split = spectral_tv.decompose(spectral_tv.Mesh(vertices, triangles), times=times)
    split.plot(axes=axes)
    assert axes.get_xscale() == "linear"
    assert len(axes.patches) == 3  # as many as there are components


def test_show_moves_the_mesh_by_the_values_of_its_sliders(split):
    plotter = pyvista.Plotter(off_screen=True, window_size=(300, 200))
    edges = split.band_edges(3)
    assert split.show(edges=edges, plotter=plotter) is plotter
    (surface,) = plotter.meshes
    shape, bands = split.mesh.vertices, split.bands(edges)
    assert np.array_equal(surface.points, shape)
    plotter.show(auto_close=False)
    before = plotter.screenshot(return_img=True)
    for band, value in ((0, -1.0), (2, 2.0)):
        slider = plotter.widgets.slider_widgets[band]
        slider.GetRepresentation().SetValue(value)
        slider.InvokeEvent("InteractionEvent")
    assert np.allclose(surface.points, shape - bands[0] + 2 * bands[2], atol=1e-12)
    plotter.render()
    after = plotter.screenshot(return_img=True)
    plotter.close()
    beside = np.abs(before.astype(int) - after)[:, 90:]  # the sliders
    assert (beside.max(axis=2) > 20).sum() > 100


def test_show_opens_a_window_of_its_own(split, monkeypatch):
    monkeypatch.setattr(pyvista, "OFF_SCREEN", True)
    seen = []
    monkeypatch.setattr(pyvista.Plotter, "show", lambda self: seen.append(self) or "shown")
    assert split.show() == "shown"
    (plotter,) = seen
    assert len(plotter.widgets.slider_widgets) == 5
    plotter.close()


@pytest.mark.parametrize("method", ["plot", "show"])
def test_edges_that_are_none_are_refused(split, method):
    for edges in ([1.0], [2.0, 1.0], [[1.0, 2.0]]):
        with pytest.raises(spectral_tv.MeshError, match="increasing"):
            getattr(split, method)(edges=edges)


def test_one_step_has_nothing_to_draw():
    vertices, triangles = icosphere(1)
    split = spectral_tv.decompose(spectral_tv.Mesh(vertices, triangles), times=[0.0, 0.1])
    with pytest.raises(spectral_tv.MeshError, match="no components"):
        split.plot()


def test_a_bar_follows_the_work(split, capsys):
    tell = spectral_tv.progress_bar("Bands")
    spectral_tv.decompose(split.mesh, steps=6, progress=tell)
    told = capsys.readouterr().err
    assert "Bands:   0%" in told
    assert "Bands: 100%" in told


@pytest.mark.parametrize(
    ("call", "library", "extra"),
    [
        ("split.plot()", "matplotlib", "plot"),
        ("split.show()", "pyvista", "pyvista"),
        ("spectral_tv.progress_bar()", "tqdm", "notebook"),
    ],
)
def test_what_is_missing_is_named(call, library, extra):
    program = f"""
import sys
sys.modules["{library}"] = None  # as if it were not installed
import spectral_tv
points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
split = spectral_tv.decompose(spectral_tv.Mesh(points, faces), steps=4)
try:
    {call}
except ImportError as error:
    print(error)
"""
    ran = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert library in ran.stdout
    assert f'pip install "spectral-tv[{extra}]"' in ran.stdout
