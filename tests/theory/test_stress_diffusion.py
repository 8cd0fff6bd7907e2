"""Diffusion to a moving absorbing boundary against images, an integral equation and its own invariants."""

import numpy as np
import pytest
from scipy.special import erf
from scipy.stats import norm

from theory.persson.diffusion import diffuse

S = np.linspace(0, 1, 161) ** 3


def boundary(variance):
    return 0.5 * np.sqrt(0.3 + variance)


@pytest.mark.parametrize("pressure", [1e-4, 3])
def test_resting_boundary_is_the_method_of_images(pressure):
    result = diffuse(pressure, S, 0 * S, 300)
    # From the sixteenth node on the δ is wider than the first cells; the error of second order falls from there.
    later = S > 1e-3
    assert result.contact[later] == pytest.approx(erf(pressure / np.sqrt(2 * S[later])), rel=1e-3)
    assert result.contact[-1] == pytest.approx(erf(pressure / np.sqrt(2)), rel=5e-5)
    # Without tension the contact carries all; the pressure is a harmonic function of the scheme itself.
    assert result.contact_stress == pytest.approx(pressure, rel=1e-9)
    assert result.edge_stress == 0


@pytest.mark.parametrize(
    ("pressure", "stress", "expected"),
    [(0.3, boundary, 0.5419156), (0.6, lambda t: 1.2 - 0.9 * t, 0.7274151)],
)
def test_moving_boundary_agrees_with_the_integral_equation(pressure, stress, expected):
    """Of the first-passage density, Buonocore, Nobile and Ricciardi 1987, with 8000 trapezia."""
    result = diffuse(pressure, S, stress(S), 300)
    # First moment of the scheme: exact at any number of cells, but for the 1e-9 that a boundary moved closer takes.
    assert result.contact_stress + result.edge_stress == pytest.approx(pressure, abs=1e-8)
    assert result.edge_stress < 0
    # Richardson on both sides puts the integral equation within 1e-7 and the scheme within 2e-5.
    assert result.contact[-1] == pytest.approx(expected, rel=5e-5)


def test_bin_averages_hold_the_whole_area():
    result = diffuse(0.5, S, boundary(S), 300)
    edges = np.linspace(-3, 10, 201)
    densities = result.bin_averages(edges)
    assert np.all(densities >= 0)
    assert np.sum(densities * np.diff(edges)) == pytest.approx(result.contact[-1], rel=1e-12)
    assert np.all(densities[edges[1:] < -boundary(1.0)] == 0)
    lost = diffuse(-1.0, S, np.full(161, 0.5), 100)  # beyond the boundary at once
    assert not np.any(lost.contact)
    assert lost.edge_stress == -1.0
    assert not np.any(lost.density)


@pytest.mark.parametrize("pressure", [11.0, 1e7])
def test_contact_far_from_detaching_is_whole(pressure):
    for result in (diffuse(pressure, S, 0 * S, 300), diffuse(-pressure, S, 2 * pressure + S, 300)):
        mean = pressure if result.edges[0] > 0 else -pressure
        assert np.all(result.contact == 1)
        assert result.edge_stress == 0
        # The cells are differences of edges that lie up to 1e8 of their widths away: their rounding.
        assert result.contact_stress == pytest.approx(mean, rel=1e-10)
        density = norm.pdf(0.5 * (result.edges[1:] + result.edges[:-1]), mean)
        assert result.density == pytest.approx(density, abs=1e-3 * density.max())  # cells of 1/20: w²/24


def test_boundary_out_of_reach_is_moved_closer():
    for rise in (50, 5000):
        found = diffuse(0.1, S, 0.2 + rise * S, 300)
        assert found.edges[0] == pytest.approx(0.1 - 7, abs=0.1)
        assert found.contact_stress + found.edge_stress == pytest.approx(0.1, abs=1e-8)
