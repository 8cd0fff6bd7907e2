"""Theories of a smooth sphere: closed forms, limits of Maugis' theory, energy, and what no sphere can be."""

import doctest
import importlib

import numpy as np
import pytest

from contact_study.physics.spheres.maugis import maugis_dugdale_contact
from contact_study.physics.spheres.numbers import maugis_parameter, tabor_parameter
from theory import DMT, JKR, Hertz, MaugisDugdale, maugis_of_tabor, tabor_of_maugis

RADIUS, MODULUS, WORK = 2e-6, 3e7, 0.04
# The units of D. Maugis, J. Colloid Interface Sci. 150, 243 (1992), in which only λ is left.
IN_HIS_UNITS = 1.0, 0.75, 1 / np.pi
LAMBDAS = (1e-3, 1e-2, 0.1, 0.5, 0.9, 1.0, 3.0, 10.0, 100.0)


def test_jkr_has_its_published_folds_and_both_branches():
    sphere = JKR(RADIUS, MODULUS, WORK)
    assert sphere.pull_off_force == pytest.approx(-1.5 * np.pi * WORK * RADIUS, rel=1e-12)
    # K. L. Johnson, K. Kendall, A. D. Roberts 1971; the least displacement after dδ/da = 0.
    least = -0.75 * np.cbrt(np.pi**2 * WORK**2 * RADIUS / MODULUS**2)
    assert sphere.pull_off_displacement == pytest.approx(least, rel=1e-12)
    # At the first touch of an approach, δ = 0, the sphere is pulled by 8/9 of the pull-off force.
    assert sphere.at_displacement(0.0)[0] == pytest.approx(-4 / 3 * np.pi * WORK * RADIUS, rel=1e-9)
    force, displacement, radius, held = sphere.curve(5e-7)
    assert np.all(np.diff(radius) > 0)
    assert radius[0] == 0
    assert force[-1] == pytest.approx(5e-7, rel=1e-9)
    assert np.all(np.diff(displacement[held]) > 0)
    assert np.all(np.diff(displacement[~held]) < 0)
    np.testing.assert_allclose(displacement, radius**2 / RADIUS - np.sqrt(2 * np.pi * WORK * radius / MODULUS))


def test_hertz_and_dmt_differ_by_a_constant_force():
    hertz, dmt = Hertz(RADIUS, MODULUS), DMT(RADIUS, MODULUS, WORK)
    assert dmt.pull_off_force == pytest.approx(-2 * np.pi * WORK * RADIUS, rel=1e-14)
    assert (hertz.pull_off_force, hertz.pull_off_displacement, dmt.pull_off_displacement) == (0, 0, 0)
    force, displacement, radius = hertz.at_force(1e-7)
    assert force == pytest.approx(4 / 3 * MODULUS * np.sqrt(RADIUS) * displacement**1.5, rel=1e-12)
    assert dmt.at_displacement(displacement)[0] == pytest.approx(force + dmt.pull_off_force, rel=1e-9)
    assert radius == pytest.approx(np.sqrt(RADIUS * displacement), rel=1e-12)


@pytest.mark.parametrize("parameter", LAMBDAS)
def test_maugis_is_solved_for_every_parameter(parameter):
    sphere = MaugisDugdale.of_parameter(parameter)
    assert sphere.parameter == pytest.approx(parameter, rel=1e-12)
    assert JKR(*IN_HIS_UNITS).pull_off_force > sphere.pull_off_force > DMT(*IN_HIS_UNITS).pull_off_force
    force, displacement, radius, held = sphere.curve(10.0)
    assert force[0] == 0
    assert displacement[0] == pytest.approx(-2 / (np.pi * parameter), rel=1e-12)  # the range of the tension
    assert force[-1] == pytest.approx(10.0, rel=1e-9)
    assert np.all(np.diff(radius) >= 0)
    # In steps even enough to draw: of the diagonal, 400 states.
    steps = np.hypot(np.diff(force) / np.ptp(force), np.diff(displacement) / np.ptp(displacement))
    assert steps.max() < 0.01
    assert np.all(np.diff(displacement[held]) > 0)
    for target in (10.0, 0.0, 0.9 * sphere.pull_off_force):
        assert sphere.at_force(target)[0] == pytest.approx(target, abs=1e-9)


def test_maugis_has_the_limits_of_jkr_and_dmt():
    jkr, dmt = JKR(*IN_HIS_UNITS), DMT(*IN_HIS_UNITS)
    soft, stiff = MaugisDugdale.of_parameter(100.0), MaugisDugdale.of_parameter(1e-3)
    # The distance to JKR falls as 1/λ², that to DMT as λ: 2e-4 and 1e-3 are bounds of either.
    assert soft.pull_off_force == pytest.approx(jkr.pull_off_force, rel=2e-4)
    assert stiff.pull_off_force == pytest.approx(dmt.pull_off_force, rel=1e-3)
    for force in (-1.3, 0.0, 4.0):
        np.testing.assert_allclose(soft.at_force(force)[1:], jkr.at_force(force)[1:], rtol=2e-3)
        np.testing.assert_allclose(stiff.at_force(force)[2], dmt.at_force(force)[2], rtol=5e-3)
        # The surface outside is lifted by the tension, which DMT leaves out: 4/3 λ c of the zone's radius c.
        assert abs(stiff.at_force(force)[1] - dmt.at_force(force)[1]) < 2e-3 * np.sqrt(4 / (np.pi * 1e-3))


@pytest.mark.parametrize("parameter", [0.05, 0.5, 5.0])
def test_the_force_is_the_derivative_of_an_energy(parameter):
    """Of U(δ, w) with F = ∂U/∂δ and −πc² = ∂U/∂w under one strength: both ways to the mixed derivative agree."""
    radius, modulus, work = IN_HIS_UNITS
    strength, step = parameter / 2, 1e-4

    def outer(sphere, displacement):
        """Zone's outer radius, from the force that Maugis' equations give at the radius of the contact."""
        force, _, a = sphere.at_displacement(displacement)
        # F = 4E*a³/3R − 2σ₀(√(c² − a²) a + c² arccos(a/c)), solved for c.
        tension = (4 * modulus * a**3 / (3 * radius) - force) / (2 * strength)
        low, high = a, a + 10 * np.sqrt(2 * radius * work / strength)
        for _ in range(200):
            c = (low + high) / 2
            found = a * np.sqrt(c**2 - a**2) + c**2 * np.arccos(a / c)
            low, high = (c, high) if found < tension else (low, c)
        return c

    for displacement in (0.1, 1.0, 3.0):
        more, less = (MaugisDugdale(radius, modulus, work * (1 + s), strength) for s in (step, -step))
        by_work = (more.at_displacement(displacement)[0] - less.at_displacement(displacement)[0]) / (2 * work * step)
        sphere = MaugisDugdale(radius, modulus, work, strength)
        ends = [outer(sphere, displacement * (1 + s)) for s in (step, -step)]
        by_displacement = -np.pi * (ends[0] ** 2 - ends[1] ** 2) / (2 * displacement * step)
        assert by_work == pytest.approx(by_displacement, rel=1e-5)  # central differences of step 1e-4


@pytest.mark.parametrize("parameter", [1e-2, 0.3, 1.0, 30.0])
def test_the_attraction_before_contact_continues_that_in_contact(parameter):
    """Where the contact is a point, Maugis' equations and the tension on a circle are two ways to one state."""
    sphere = MaugisDugdale.of_parameter(parameter)
    touch = sphere._start + 1
    before, after = (np.array(sphere.states(touch + side)) for side in (-1e-12, 0.0))
    # The radius of the contact is 1e-4 of the zone's there; force and displacement differ in its square.
    np.testing.assert_allclose(before[:2], after[:2], rtol=3e-8)
    assert before[2] == 0
    assert after[2] < 2e-3


def test_thin_zones_have_series_that_agree_with_the_closed_form():
    for root in (5e-3, 0.99e-2, 1.01e-2):
        zone = np.sqrt(1 + root**2) - 1
        m, angle = 1 + zone, np.arctan(root)
        quadratic, linear = (root + (m**2 - 2) * angle) / 2, 4 / 3 * (root * angle - m + 1)
        a = float(maugis_dugdale_contact(1.0, zone)[1])
        # Rounding of order 1e-16 in differences of order 1e-7; a wrong third term of the series is 1e-9.
        assert quadratic * a**2 + linear * a == pytest.approx(1.0, rel=2e-10)


def test_the_numbers_of_tabor_and_maugis():
    assert maugis_of_tabor(1.0) == pytest.approx(1.1570, abs=5e-5)  # published with four digits
    assert tabor_of_maugis(maugis_of_tabor(0.7)) == pytest.approx(0.7, rel=1e-14)
    length, strength = 3e-10, 1.3e8
    tabor = tabor_parameter(RADIUS, MODULUS, WORK, length)
    own = maugis_of_tabor(tabor, relative_strength=strength * length / WORK)
    assert own == pytest.approx(maugis_parameter(RADIUS, MODULUS, WORK, strength), rel=1e-13)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: JKR(0.0, MODULUS, WORK), "radius = 0.0: must be finite and positive"),
        (lambda: MaugisDugdale(RADIUS, MODULUS, WORK, -1.0), "strength"),
        (lambda: Hertz(RADIUS, np.nan), "contact_modulus"),
        (lambda: DMT(RADIUS, MODULUS, 0.0), "work_of_adhesion"),
        (lambda: JKR(RADIUS, MODULUS, WORK).at_force(-1e-6), "force = -1e-06: the sphere has detached; .*-3.76991e-07"),
        (lambda: JKR(RADIUS, MODULUS, WORK).at_force(-3.8e-7), "the sphere has detached"),
        (lambda: JKR(RADIUS, MODULUS, WORK).at_displacement(-1e-6), "displacement"),
        (lambda: JKR(RADIUS, MODULUS, WORK).curve(np.inf), "force"),
        (lambda: JKR(RADIUS, MODULUS, WORK).curve(1e-6, points=1), "points"),
        (lambda: maugis_of_tabor(-1.0), "tabor"),
    ],
)
def test_what_no_sphere_can_be_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize("module", ["base", "numbers", "hertz", "jkr", "dmt", "maugis"])
def test_examples_of_docstrings(module):
    found = doctest.testmod(importlib.import_module(f"contact_study.physics.spheres.{module}"))
    assert found.attempted > 0
    assert found.failed == 0
