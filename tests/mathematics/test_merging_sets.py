"""Sets that merge, and boundaries that move to a bottleneck, under the flow of their indicator."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import SINC_NECK, SINC_NECK_RADIUS, sinc_surface, torus


def test_a_set_decays_at_two_rates_once_it_merges():
    """At λ = per/area before, at that of the union after (Brokman et al. 2024, Sec. 8).

    A sleeve at 1 inside a wider one at 0.5: what flows into the wider one flows out of it as
    well, so that it rests until the inner one has come down to it. Their boundaries are equally
    long, so the rate falls with the area alone. What they lose, the rest of the torus gains.
    """
    minor = 0.6
    vertices, triangles = torus(2.0, minor, 200, 48)
    mesh = spectral_tv.Mesh(vertices, triangles)
    around = np.abs(np.arctan2(vertices[:, 1], vertices[:, 0]))
    inner, outer = around < 0.5, (around >= 0.5) & (around < 1.3)
    perimeter = 2 * 2 * np.pi * minor
    area, merged = (mesh.vertex_areas[part].sum() for part in (inner, inner | outer))
    first, second = perimeter / area, perimeter / merged
    gain = perimeter / (mesh.area - merged)
    meeting = 0.5 / first
    extinction = meeting + (0.5 - gain * meeting) / (second + gain)
    times = np.linspace(0, meeting + 0.9 * (extinction - meeting), 61)
    flow = spectral_tv.flow(mesh, 1.0 * inner + 0.5 * outer, times, exact=True)
    value, around_it = flow.mean(inner), flow.mean(outer)
    before, after = times < 0.95 * meeting, times > 1.05 * meeting
    for when, rate in ((before, first), (after, second)):
        slope, start = np.polyfit(times[when], value[when], 1)
        assert -slope == pytest.approx(rate, rel=0.03)
        np.testing.assert_allclose(value[when], start + slope * times[when], atol=2e-3)
    np.testing.assert_allclose(around_it[before], 0.5, atol=5e-3)
    np.testing.assert_allclose(around_it[after], value[after], atol=5e-3)
    np.testing.assert_allclose(flow.mean(~(inner | outer)), gain * times, atol=5e-3)


SINC = sinc_surface()
HEIGHT = np.abs(SINC[0][:, 2])


def test_the_bulge_and_the_ends_of_the_sinc_are_eigensets():
    """Cut at their bottlenecks, whose perimeter is known."""
    mesh = spectral_tv.Mesh(*SINC)
    bulge, end = HEIGHT < SINC_NECK, SINC[0][:, 2] > SINC_NECK
    for members, necks in ((bulge, 2), (~bulge, 2), (end, 1)):
        found = spectral_tv.eigenset_test(mesh, members)
        perimeter = necks * 2 * np.pi * SINC_NECK_RADIUS
        assert found.is_eigenset
        assert found.perimeter == pytest.approx(perimeter, rel=0.03)
        area = mesh.vertex_areas[members].sum()
        assert found.rate == pytest.approx(perimeter / area, rel=0.05)


def test_a_sleeve_of_the_sinc_moves_to_the_bottlenecks():
    """First a new boundary appears there, then the old one goes, as in the paper's figure.

    In the end the bulge has one value and the ends have one, and the difference of them falls at
    per/|C| + per/|rest|.
    """
    mesh = spectral_tv.Mesh(*SINC)
    sleeve, bulge = HEIGHT < 3.0, HEIGHT < SINC_NECK
    found = spectral_tv.eigenset_test(mesh, sleeve)
    assert not found.is_eigenset and not found.minimal_perimeter
    assert np.abs(HEIGHT[found.superset].max() - SINC_NECK) < 0.3

    perimeter = 2 * 2 * np.pi * SINC_NECK_RADIUS
    inside, outside = (mesh.vertex_areas[part].sum() for part in (bulge, ~bulge))
    rate = perimeter / inside + perimeter / outside
    times = np.linspace(0, 1.1 / rate, 67)
    flow = spectral_tv.flow(mesh, sleeve.astype(float), times, exact=True)
    jump = flow.mean(bulge) - flow.mean(~bulge)
    # At rest between the old boundary and the new one, both of them are there.
    between = (HEIGHT > 3.4) & bulge
    early = (times > 0) & (flow.mean(sleeve) - flow.mean(between) > 0.05)
    assert early.any()
    assert (flow.mean(between)[early][1:] > flow.mean(~bulge)[early][1:] + 0.01).all()
    late = (times > times[early].max() * 1.1) & (jump > 0.05)
    assert late.sum() > 10
    slope, start = np.polyfit(times[late], jump[late], 1)
    assert -slope == pytest.approx(rate, rel=0.03)
    np.testing.assert_allclose(jump[late], start + slope * times[late], atol=5e-3)
    for part in (bulge & (HEIGHT < 4.3), ~bulge & (HEIGHT > 4.7)):
        assert np.ptp(flow.states[late][:, part], axis=1).max() < 0.03
