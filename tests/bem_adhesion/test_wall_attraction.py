"""Attraction outside a hard wall: its conditions, its limits, both controls; independent of the solver's own passes."""

import numpy as np
import pytest
from scipy.optimize import brentq

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.hard_wall.contact import HardWallContact
from bem_adhesion.kernels.law import LawKernels
from bem_adhesion.kernels.local_energy import kernels_of
from bem_adhesion.kernels.wall import WallKernels
from bem_adhesion.solution import Outcome
from contact_study.numerics.grid import Grid
from contact_study.physics.laws.dugdale import Dugdale
from contact_study.physics.laws.exponential import Exponential
from tests.bem_adhesion.paper_system import E_STAR
from tests.bem_adhesion.rough_surfaces import self_affine
from theory import references as reference

RANGE = 1.74e-10  # m: with this the law's peak is that of the 10-4 law of the same work of adhesion


def contact_of(work_of_adhesion, points=64, control="pressure", **options):
    height, grid = self_affine(points)
    return AdhesiveContact(height, grid, E_STAR, Exponential(work_of_adhesion, RANGE), control, **options)


def elastic_pressure(contact, displacement):
    """K w by NumPy's transform (Pa); its mean is the load's."""
    grid = contact._grid
    q = np.hypot(
        *np.meshgrid(
            *(2 * np.pi * np.fft.fftfreq(n, s / n) for n, s in zip(grid.shape, grid.size, strict=True)), indexing="ij"
        )
    )
    return np.fft.ifft2(0.5 * E_STAR * q / contact.law.length * np.fft.fft2(displacement)).real


def energy(contact, gap, pressure):
    """½<w K w> + <φ> + p <d> (J/m²), without the solver's passes."""
    displacement = contact.height + gap
    elastic = 0.5 * np.mean(displacement * elastic_pressure(contact, displacement))
    return elastic + np.mean(contact.law.potential(gap)) + pressure * gap.mean()


@pytest.mark.parametrize("control", ["pressure", "gap"])
@pytest.mark.parametrize("work_of_adhesion", [0.1, 0.69, 2.76])
def test_states_satisfy_the_conditions_of_contact(work_of_adhesion, control):
    contact = contact_of(work_of_adhesion, control=control)
    state = contact.separated()
    for load in (0.2e9, 2e9, 20e9, 1e9) if control == "pressure" else (6e-10, 2e-10, 1e-11, 4e-10):
        found = contact.step(state, load)
        state = found.state
        assert found.outcome is Outcome.CONVERGED
        touching = found.gap == 0
        assert 0 < touching.mean() < 1
        assert found.gap.min() == 0
        mean = found.pressure.mean() if control == "pressure" else found.gap.mean()
        assert mean == pytest.approx(load, rel=1e-6 if control == "pressure" else 1e-5)
        balance = elastic_pressure(contact, found.displacement) + found.pressure.mean()
        # The tolerance of the solver, in both conditions, and rounding of the transform.
        np.testing.assert_allclose(balance, found.pressure, atol=2e-8 * E_STAR)
        reaction = found.pressure + contact.law.traction(found.gap)
        assert reaction[touching].min() > -1e-8 * E_STAR
        np.testing.assert_allclose(reaction[~touching], 0, atol=1e-12 * E_STAR)
        assert found.residual <= 1e-8
        assert found.complementarity_residual == pytest.approx(max(0, -reaction[touching].min() / E_STAR), abs=1e-14)
        assert found.interaction_energy == pytest.approx(np.mean(contact.law.potential(found.gap)), rel=1e-12)


def test_a_prediction_touches_where_the_coarse_grid_does():
    contact = contact_of(0.1, points=128)
    grids, load = contact.levels, contact._load(5e9 / E_STAR)
    gap = contact._gap_of(contact.separated())
    grids.finest.press(gap, load)
    assert grids.coarser is not None
    touching = grids._predict(grids.coarser, gap, load, 2000, True) == 0
    on_coarse = touching[::2, ::2]
    right, below = np.roll(on_coarse, -1, 1), np.roll(on_coarse, -1, 0)
    assert touching[::2, 1::2][on_coarse & right].all()
    assert touching[1::2, ::2][on_coarse & below].all()
    assert touching[1::2, 1::2][on_coarse & right & below & np.roll(right, -1, 0)].all()
    found = contact.step(contact.separated(), 5e9)
    # The two differ at the edges alone. Where interpolation rounds points off the wall half of the contact is missing.
    assert np.mean(touching) == pytest.approx(np.mean(found.gap == 0), rel=0.1)


def test_a_loose_tolerance_shows_in_the_complementarity():
    """The pull that the wall would need is what the dataset says, and no more than the residual."""
    contact = contact_of(0.69, tolerance=1e-2)
    found = contact.step(contact.step(contact.separated(), 1e9).state, 5e9)
    reaction = found.pressure + contact.law.traction(found.gap)
    pull = -reaction[found.gap == 0].min() / E_STAR
    assert found.complementarity_residual == pytest.approx(pull, rel=1e-6)
    # The pull may be the largest residual itself; it comes back from SI units by some roundings.
    assert 1e-4 < pull <= found.residual * (1 + 1e-12) <= 1e-2


def test_states_are_minima():
    """No small displacement that the wall allows lowers the energy, rough or smooth, at the edge or everywhere."""
    contact = contact_of(2.76)
    rng = np.random.default_rng(0)
    for load in (0.5e9, 5e9):
        found = contact.step(contact.separated(), load)
        lowest = energy(contact, found.gap, load)
        for width in (0, 2, 8) * 4:
            change = rng.standard_normal(found.gap.shape)
            if width:
                taper = np.exp(
                    -0.5
                    * (np.fft.fftfreq(64)[:, None] ** 2 + np.fft.fftfreq(64)[None, :] ** 2)
                    * (2 * np.pi * width) ** 2
                )
                change = np.fft.ifft2(taper * np.fft.fft2(change)).real
            moved = np.maximum(found.gap + 1e-2 * RANGE * change / np.abs(change).max(), 0)
            assert energy(contact, moved, load) > lowest


def test_energy_falls_by_the_work_of_the_load():
    """On a branch without jumps dU = −p dū: the trapezoidal rule over 20 steps is good to 1e-3 (a quarter at 40)."""
    contact, state = contact_of(0.69), None
    pressures = np.linspace(1e9, 4e9, 21)
    energies, gaps = [], []
    for pressure in pressures:
        found = contact.step(contact.separated() if state is None else state, pressure)
        state = found.state
        energies.append(found.elastic_energy + found.interaction_energy)
        gaps.append(found.gap.mean())
    assert energies[-1] - energies[0] == pytest.approx(-np.trapezoid(pressures, gaps), rel=1e-3)


@pytest.mark.parametrize("work_of_adhesion", [0.69e-4, 0.69, 2.76])
def test_both_controls_have_the_same_states(work_of_adhesion):
    by_pressure, by_gap = (contact_of(work_of_adhesion, control=control) for control in ("pressure", "gap"))
    state = by_pressure.separated()
    for pressure in (1e9, 10e9, 0.5e9, -0.05e9 if work_of_adhesion > 1 else 0.2e9):
        one = by_pressure.step(state, pressure)
        state = one.state
        other = by_gap.step(state, one.gap.mean())
        assert other.converged
        np.testing.assert_allclose(other.gap, one.gap, atol=1e-6 * RANGE)
        np.testing.assert_array_equal(other.gap == 0, one.gap == 0)
        assert other.pressure.mean() == pytest.approx(pressure, abs=2e-8 * E_STAR)
        assert other.fft_pairs < 20, "the spring's end is known from the state"


def test_without_attraction_it_is_the_hard_wall():
    """The same points touch, and what differs is proportional to the work of adhesion."""
    height, grid = self_affine(64)
    wall = HardWallContact(height, grid, E_STAR, tolerance=1e-11)
    weak, weaker = contact_of(0.69e-4, tolerance=1e-10), contact_of(0.69e-5, tolerance=1e-10)
    for pressure in (0.5e9, 5e9, 10e9):
        bare = wall.step(wall.separated(), pressure)
        errors = []
        for contact in (weak, weaker):
            found = contact.step(contact.separated(), pressure)
            np.testing.assert_array_equal(found.gap == 0, bare.pressure > 0)
            errors.append((np.abs(found.pressure - bare.pressure).max(), np.abs(found.gap - bare.gap).max()))
        np.testing.assert_allclose(np.divide(*errors), 10, rtol=0.05)


def test_flat_surfaces_hold_up_to_the_peak():
    grid = Grid((8, 8), (4e-9, 4e-9))
    contact = AdhesiveContact(np.zeros(grid.shape), grid, E_STAR, Exponential(0.69, RANGE))
    pressed = contact.step(contact.separated(), 1e9)
    np.testing.assert_array_equal(pressed.gap, 0)
    np.testing.assert_allclose(pressed.pressure, 1e9, rtol=1e-12)
    peak = contact.law.peak_tensile_stress
    assert contact.step(pressed.state, -0.999 * peak).outcome is Outcome.CONVERGED
    assert contact.step(pressed.state, -1.001 * peak).outcome is Outcome.DETACHED


def test_full_contact_is_met_by_either_control():
    by_pressure, by_gap = (contact_of(0.69, control=control) for control in ("pressure", "gap"))
    pressed = by_pressure.step(by_pressure.separated(), 200e9)
    np.testing.assert_array_equal(pressed.gap, 0)
    released = by_pressure.step(pressed.state, 5e9)
    assert released.converged
    assert 0 < np.mean(released.gap == 0) < 1
    closed = by_gap.step(by_gap.separated(), 0.0)
    assert closed.converged
    np.testing.assert_array_equal(closed.gap, 0)
    # At the least pressure: one point more would be pulled off.
    assert closed.pressure.min() == pytest.approx(-by_gap.law.peak_tensile_stress, rel=1e-9)
    opened = by_gap.step(closed.state, 2e-11)
    assert opened.converged
    assert opened.gap.mean() == pytest.approx(2e-11, abs=0, rel=1e-6)
    assert opened.pressure.mean() < closed.pressure.mean()


def test_surfaces_almost_closed_under_gap_control():
    """The contact is then far stiffer than the spring: a mean gap of 1/1700 of the range."""
    contact = contact_of(0.69, control="gap")
    found = contact.step(contact.separated(), 1e-13)
    assert found.converged
    assert found.gap.mean() == pytest.approx(1e-13, abs=1e-8 * RANGE)


def paraboloid(tabor_parameter, work_of_adhesion, points, cell):
    """A periodic paraboloid, in units of E* and the range; ``cell`` in JKR contact radii at pull-off."""
    radius = tabor_parameter**3 / work_of_adhesion**2
    critical = (9 * np.pi * work_of_adhesion * radius**2 / 8) ** (1 / 3)
    grid = Grid((points, points), (cell * critical, cell * critical))
    y, x = (axis - size / 2 for axis, size in zip(grid.coordinates, grid.size, strict=True))
    height = -(y[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)
    return AdhesiveContact(height, grid, 1.0, Exponential(work_of_adhesion, 1.0)), radius, grid.size[0] * grid.size[1]


def test_a_sphere_of_short_range_is_that_of_jkr():
    """Tabor parameter 3: contact radius and pull-off."""
    work_of_adhesion = 0.04
    contact, radius, area = paraboloid(3.0, work_of_adhesion, 256, 8)
    state = contact.separated()
    for load in (3.0, 0.0, -1.3):
        force = load * np.pi * work_of_adhesion * radius
        found = contact.step(state, force / area)
        state = found.state
        touching = np.sqrt(np.mean(found.gap == 0) * area / np.pi)
        # The edge of the contact lies inside the process zone, ρ²/w = 25 ranges or 3 % of the radius long.
        assert touching == pytest.approx(reference.jkr_contact_radius(force, radius, 1.0, work_of_adhesion), rel=0.03)
    # 1.50 of JKR, 1.51 of Maugis at this range; a longer tail than Maugis' and edges trapped at 2.3 points to the
    # process zone add 2 %.
    unit = np.pi * work_of_adhesion * radius / area
    held = contact.step(state, -1.5 * unit)
    assert held.outcome is Outcome.CONVERGED
    assert contact.step(held.state, -1.58 * unit).outcome is Outcome.DETACHED


def test_pull_off_goes_from_jkr_to_dmt_as_the_range_grows():
    pull_offs = []
    for tabor_parameter, work_of_adhesion in ((1.0, 0.02), (0.3, 0.05)):
        contact, radius, area = paraboloid(tabor_parameter, work_of_adhesion, 64, 8)
        unit = np.pi * work_of_adhesion * radius / area
        state = contact.step(contact.separated(), 3 * unit).state
        held, lost = 1.0, 2.2
        while lost - held > 0.02:
            tried = 0.5 * (held + lost)
            found = contact.step(state, -tried * unit)
            assert found.converged
            if found.detached:
                lost = tried
            else:
                held, state = tried, found.state
        found, parameter = (
            0.5 * (held + lost),
            reference.maugis_parameter(radius, 1.0, work_of_adhesion, work_of_adhesion),
        )
        pull_offs.append(found)
        # The exponential has half of its adhesion beyond Maugis' range: nearer to DMT by up to 6 % at one λ.
        assert 0 < found / reference.maugis_dugdale_pull_off(parameter) - 1 < 0.07
    assert 1.55 < pull_offs[0] < pull_offs[1] - 0.1 < 1.9


def test_adhesive_wave_follows_johnson():
    wavelength, amplitude, work_of_adhesion = 1000.0, 8.0, 0.02
    grid = Grid((4, 256), (4 * wavelength / 256, wavelength))
    height = np.broadcast_to(amplitude * np.cos(2 * np.pi * grid.coordinates[1] / wavelength), grid.shape)
    contact = AdhesiveContact(height.copy(), grid, 1.0, Exponential(work_of_adhesion, 1.0))
    adhesion = reference.wave_adhesion(amplitude, wavelength, 1.0, work_of_adhesion)
    closing = reference.wave_full_contact_pressure(amplitude, wavelength, 1.0)
    state = contact.separated()
    for relative_pressure in (0.1, 0.3, 0.1, 0.0, -0.05):
        found = contact.step(state, relative_pressure * closing)
        state = found.state
        area = brentq(lambda a, p=relative_pressure: reference.wave_relative_pressure(a, adhesion) - p, 0.16, 0.9)
        mean_gap = reference.wave_relative_mean_gap(area, relative_pressure)
        # Johnson's edge lies within the process zone, ρ²/w = 50 ranges or 5 % of the wavelength, on either side.
        assert np.mean(found.gap == 0) == pytest.approx(area, abs=0.05)
        assert np.mean(found.gap == 0) < area < np.mean(found.gap < 2.0)
        assert found.gap.mean() / amplitude == pytest.approx(mean_gap, abs=0.015)


# What sums beside one round where a tension is the rest of it; differences of the default, over the largest stiffness.
@pytest.mark.parametrize(
    ("law", "rounding", "differences"),
    [(Exponential(0.69, RANGE), 1e-12, 0.0), (Dugdale(0.69, RANGE, 0.02), 1e-11, 1e-10)],
)
def test_compiled_pass_equals_the_functions_of_the_law(law, rounding, differences):
    passes = kernels_of(law)
    assert isinstance(passes, WallKernels)
    # On the ramp, and to where an exponential is less than the smallest number.
    gap = RANGE * np.concatenate([[0.0], np.geomspace(1e-6, 30, 40), np.linspace(0.5, 1.5, 41), [800.0, 1e5]])
    one, two = (np.empty((2, 1, gap.size)) for _ in range(2))
    assert passes.evaluate(gap[None], *one) == pytest.approx(LawKernels(law).evaluate(gap[None], *two), rel=1e-13)
    # The pass lets no exponential fall below e⁻⁷⁰⁰ = 1e-304.
    least = 1e-303 * np.abs(two).max(axis=-1)
    np.testing.assert_allclose(one[0], two[0], rtol=rounding, atol=least[0].item())
    largest = np.abs(two[1]).max()
    np.testing.assert_allclose(one[1], two[1], rtol=1e-8, atol=max(differences * largest, least[1].item()))


def test_a_start_inside_the_wall_is_refused():
    contact = contact_of(0.69)
    with pytest.raises(ValueError, match="gaps < 0"):
        contact.step(contact.separated() - 20e-10, 1e9)
