import numpy as np
import pytest

from contact_study.numerics.balance import LIGHT, WEAK, excess
from contact_study.numerics.distributions import Bins, probability_density, redistributed


def test_residual_and_missing_load_over_their_tolerances():
    for residual, given, expected in (
        (2e-8, {"missing": 1e-9, "load": 0.1, "stress": 0.1}, (2.0, 1e-3)),  # an ordinary state
        (1e-8, {"missing": 1e-8, "load": LIGHT, "stress": WEAK}, (1.0, 1.0)),
        (1e-9, {"missing": 1e-9, "stress": 1e-12}, (0.1, 0.0)),  # no load is no measure
        (0.0, {"missing": 0.5e-8 / LIGHT * 1e-4, "load": 1e-4}, (0.0, 0.5)),  # a light load by the same share
        (0.0, {"missing": -2e-8 / LIGHT * 1e-9, "load": -1e-9}, (0.0, 2.0)),
        (1e-10, {"load": 1e-9, "stress": 0.01 * WEAK}, (1.0, 0.0)),
        # Rounding of the points and of their mean.
        (1e-15, {"missing": 1e-17, "load": 1e-15, "stress": 1e-15, "rounding": 2e-15, "points": 10_000}, (0.5, 0.5)),
        (0.0, {"tolerance": 0.1, "missing": 0.02, "load": 1.0}, (0.0, 2.0)),  # a loose one lets but a share be missing
        (1e-7, {"load": 1e-15, "stress": 1e-15, "rounding": 1e-3}, (10.0, 0.0)),  # at most the tolerance
    ):
        found = excess(residual=residual, **({"tolerance": 1e-8} | given))
        assert found == pytest.approx(expected)
        assert found.balanced == (max(expected) <= 1)
        assert found.to_balance == pytest.approx(1 / max(expected))


VALUES = np.random.default_rng(0).normal(1.0, 0.5, 10_000)


def test_density_is_a_share_of_all_values_and_whole_bins_are_joined_exactly():
    density = probability_density(VALUES, np.linspace(0, 2, 11))
    assert np.sum(density * 0.2) == pytest.approx(np.mean((VALUES >= 0) & (VALUES <= 2)), rel=1e-12)
    fine, coarse = np.linspace(-3, 5, 81), np.linspace(-3, 5, 17)
    rows = np.stack([probability_density(VALUES, fine), np.arange(80.0)])
    joined = redistributed(rows, fine, coarse)
    np.testing.assert_allclose(joined[0], probability_density(VALUES, coarse), rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(joined[1], np.arange(80.0).reshape(16, 5).mean(axis=1), rtol=1e-12)
    spread, new = redistributed(rows[0], fine, np.linspace(-4, 7, 79)), np.linspace(-4, 7, 79)
    assert np.sum(spread * np.diff(new)) == pytest.approx(1, rel=1e-12)
    assert np.all(spread[new[1:] < fine[0]] == 0)


BINS = Bins(np.linspace(-2.0, 10.0, 13), np.linspace(0.0, 4.0, 9))


def test_which_bins_can_be_had_from_which():
    assert BINS.spans == ([-2.0, 10.0, 12.0], [0.0, 4.0, 8.0])
    for other, equal, held in (
        (BINS.spans, True, True),
        (([-2 + 1e-12, 10, 12], [0, 4 + 1e-12, 8]), True, True),  # rounding
        (([-3, 10, 13], [0, 4, 8]), False, True),
        (([-2, 13, 12], [0, 4, 8]), False, True),
        (([-2, 10, 12], [0, 8, 8]), False, True),
        (([-2, 10, 24], [0, 4, 8]), False, False),
        (([-2, 10, 6], [0, 4, 9]), False, False),
    ):
        assert BINS.equal(Bins.evenly(*other)) == equal
        assert BINS.hold(Bins.evenly(*other)) == held
