"""When a contact is in balance: the tolerance shrinks with light loads and weak stresses, down to rounding."""

import pytest

from contact_study.numerics.balance import LIGHT, WEAK, excess


def test_an_ordinary_state_is_judged_by_its_residual():
    assert excess(1e-8, 2e-8, missing=1e-9, load=0.1, stress=0.1) == pytest.approx((2.0, 1e-3))
    assert not excess(1e-8, 2e-8, missing=1e-9, load=0.1, stress=0.1).balanced
    assert excess(1e-8, 1e-8, missing=1e-8, load=LIGHT, stress=WEAK).balanced


def test_no_load_is_no_measure_of_what_is_missing():
    assert excess(1e-8, 1e-9, missing=1e-9, stress=1e-12) == pytest.approx((0.1, 0.0))


def test_a_light_load_is_missed_by_the_same_share():
    """Whichever sign it has; the residual itself may stay."""
    for load in (1e-4, -1e-9):
        share = 1e-8 / LIGHT
        assert excess(1e-8, 0.0, missing=0.5 * share * load, load=load) == pytest.approx((0.0, 0.5))
        assert not excess(1e-8, 0.0, missing=-2 * share * load, load=load).balanced
    # However loose the tolerance.
    assert not excess(0.1, 0.0, missing=0.02, load=1.0).balanced


def test_weak_stresses_are_balanced_by_the_same_share():
    assert excess(1e-8, 1e-10, load=1e-9, stress=0.01 * WEAK).residual == pytest.approx(1.0)


def test_nothing_is_asked_for_beyond_rounding_or_below_the_tolerance():
    found = excess(1e-8, 1e-15, missing=1e-17, load=1e-15, stress=1e-15, rounding=2e-15, points=10_000)
    assert found == pytest.approx((0.5, 0.5))
    assert not excess(1e-8, 1e-7, load=1e-15, stress=1e-15, rounding=1e-3).balanced
