import pytest

from contact_study.numerics.balance import LIGHT, WEAK, excess


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
