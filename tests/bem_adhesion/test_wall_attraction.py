"""Attraction outside a hard wall: its conditions, its limits, both controls; independent of the solver's own passes."""

import numpy as np
import pytest

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.hard_wall.contact import HardWallContact
from contact_study.physics.laws.exponential import Exponential
from tests.bem_adhesion.paper_system import E_STAR
from tests.bem_adhesion.rough_surfaces import self_affine

RANGE = 1.74e-10  # m: with this the law's peak is that of the 10-4 law of the same work of adhesion


def contact_of(work_of_adhesion, points=64, control="pressure", **options):
    height, grid = self_affine(points)
    return AdhesiveContact(height, grid, E_STAR, Exponential(work_of_adhesion, RANGE), control, **options)


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
