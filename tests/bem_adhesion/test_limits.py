"""Contacts against analytic solutions, adhesive ones in units of E* and the law's length."""

import numpy as np
import pytest
from scipy.optimize import brentq

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.solution import Outcome
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import Exponential, LennardJones104
from tests.bem_adhesion.rough_surfaces import CONTACT_MODULUS, solve
from theory import references as reference


class Sphere:
    """A periodic paraboloid of a Tabor parameter; ``cell`` is its period in JKR contact radii at pull-off."""

    def __init__(self, law, tabor_parameter, work_of_adhesion, points, cell=8):
        self.radius = tabor_parameter**3 / work_of_adhesion**2
        critical = (9 * np.pi * work_of_adhesion * self.radius**2 / 8) ** (1 / 3)
        grid = Grid((points, points), (cell * critical, cell * critical))
        y, x = (axis - size / 2 for axis, size in zip(grid.coordinates, grid.size, strict=True))
        height = -(y[:, None] ** 2 + x[None, :] ** 2) / (2 * self.radius)
        self.contact = AdhesiveContact(height, grid, 1.0, law(work_of_adhesion, 1.0))
        self.area = grid.size[0] * grid.size[1]
        self.unit = np.pi * work_of_adhesion * self.radius / self.area  # πwR over the cell
        self.pressed = self.contact.step(self.contact.separated(), 3 * self.unit)


@pytest.mark.parametrize("law", [LennardJones104, Exponential])
def test_contact_radius_tends_to_jkr_at_large_tabor_parameter(law):
    """A point is 2 % of the radius, and edges are trapped within about one of it at 0.7 points per process zone."""
    sphere = Sphere(law, 3.0, 0.04, 256)
    state = sphere.pressed.state
    for load in (3.0, 0.0):
        solution = sphere.contact.step(state, load * sphere.unit)
        state = solution.state
        edge = sphere.contact.law.peak_distance if law is LennardJones104 else 0.0
        found = np.sqrt(np.mean(solution.gap <= edge) * sphere.area / np.pi)
        expected = reference.jkr_contact_radius(load * sphere.unit * sphere.area, sphere.radius, 1.0, 0.04)
        assert found == pytest.approx(expected, rel=0.04 if law is LennardJones104 else 0.03)
    if law is Exponential:
        # 1.50 of JKR, 1.51 of Maugis at this range; a longer tail than Maugis' and trapped edges add 2 %.
        held = sphere.contact.step(sphere.contact.step(state, -1.3 * sphere.unit).state, -1.5 * sphere.unit)
        assert held.outcome is Outcome.CONVERGED
        assert sphere.contact.step(held.state, -1.58 * sphere.unit).outcome is Outcome.DETACHED


@pytest.mark.parametrize("law", [LennardJones104, Exponential])
def test_adhesive_wave_follows_johnson(law):
    """The range is 1/8 of the amplitude; the process zone is 1.4 % (10-4) and 5 % of the wavelength."""
    wavelength, amplitude, work_of_adhesion = 1000.0, 8.0, 0.02
    grid = Grid((4, 256), (4 * wavelength / 256, wavelength))
    height = np.broadcast_to(amplitude * np.cos(2 * np.pi * grid.coordinates[1] / wavelength), grid.shape)
    contact = AdhesiveContact(height.copy(), grid, 1.0, law(work_of_adhesion, 1.0))
    adhesion = reference.wave_adhesion(amplitude, wavelength, 1.0, work_of_adhesion)
    closing = reference.wave_full_contact_pressure(amplitude, wavelength, 1.0)
    equilibrium, state = contact.law.equilibrium_distance, contact.separated()
    # Loading, then unloading into tension along the stable branch.
    for relative_pressure in (0.1, 0.3, 0.1, 0.0, -0.05):
        solution = contact.step(state, relative_pressure * closing)
        state = solution.state
        area = brentq(lambda a, p=relative_pressure: reference.wave_relative_pressure(a, adhesion) - p, 0.16, 0.9)
        mean_gap = reference.wave_relative_mean_gap(area, relative_pressure)
        if law is LennardJones104:
            assert np.mean(solution.gap < contact.law.peak_distance) == pytest.approx(area, abs=0.014)
        else:
            # Johnson's edge lies within the process zone.
            assert np.mean(solution.gap == 0) == pytest.approx(area, abs=0.05)
            assert np.mean(solution.gap == 0) < area < np.mean(solution.gap < 2.0)
        assert (solution.gap.mean() - equilibrium) / amplitude == pytest.approx(mean_gap, abs=0.015)
    # The least pressure of Johnson's curve is −0.076; the wave detaches there.
    least = min(reference.wave_relative_pressure(np.linspace(0.01, 0.5, 500), adhesion))
    assert law is not LennardJones104 or contact.step(state, (least - 0.02) * closing).outcome is Outcome.DETACHED


WAVELENGTH, AMPLITUDE = 1e-7, 1e-9
GRIDS = np.array([32, 64, 128, 256])


def rate(points, errors):
    """Exponent of the error's decay with the number of points, least squares."""
    return -np.polyfit(np.log(points), np.log(errors), 1)[0]


def wave_errors(points):
    """Errors of area and mean gap (rms) over pressures and positions of the wave on the grid."""
    full = reference.wave_full_contact_pressure(AMPLITUDE, WAVELENGTH, CONTACT_MODULUS)
    grid = Grid((2, points), (WAVELENGTH / 8, WAVELENGTH))
    errors = []
    for shift in np.arange(6) / 6 * grid.spacing[1]:
        wave = AMPLITUDE * np.cos(2 * np.pi * (grid.coordinates[1] + shift) / WAVELENGTH)
        for relative_pressure in (0.05, 0.2, 0.5, 0.8, 0.95):
            found = solve(np.broadcast_to(wave, grid.shape), grid, CONTACT_MODULUS, relative_pressure * full)
            area = reference.wave_relative_area(relative_pressure)
            gap = reference.wave_relative_mean_gap(area, relative_pressure)
            errors.append((np.mean(found.pressure > 0) - area, found.gap.mean() / AMPLITUDE - gap))
    return np.array(errors)


def test_westergaard_wave_converges():
    errors = [wave_errors(points) for points in GRIDS]
    for points, error in zip(GRIDS, errors, strict=True):
        # Each of the two edges of contact lies within a point of its place.
        assert np.abs(error[:, 0]).max() < 2 / points
    # A gap that opens as distance^(3/2) from an edge misplaced by a part of the spacing gives order 2 or better;
    # 2.0 was measured, the rms over six positions scatters.
    gaps = [np.sqrt(np.mean(error[:, 1] ** 2)) for error in errors]
    assert rate(GRIDS, gaps) > 1.7
    assert gaps[-1] < 3e-5
