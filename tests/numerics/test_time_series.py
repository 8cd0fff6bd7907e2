import numpy as np
import pytest
from scipy.signal import lfilter

from contact_study.numerics.time_series import LEAST_STATES, autocovariance, statistics_of


def exponential_memory(time, count, columns):
    correlation = (2 * time - 1) / (2 * time + 1)
    noise = np.random.default_rng(0).standard_normal((count, columns))
    noise[1:] *= np.sqrt(1 - correlation**2)
    return lfilter([1.0], [1.0, -correlation], noise, axis=0)


@pytest.mark.parametrize(("time", "count"), [(0.5, 300), (4.5, 300)])
def test_error_of_the_mean_is_what_repeated_series_scatter_by(time, count):
    found = statistics_of(exponential_memory(time, count, 4000))
    # The bias of τ is of the order of the window over the series, 5τ/n; the floor of ½ lifts one of ½ by its noise.
    bias = (0.1 if time == 0.5 else 0.03) + 5 * time / count
    assert np.mean(found.autocorrelation_time) == pytest.approx(time, rel=bias)
    # The scatter of 4000 means is known to 1/√8000, its square to 2.2 %; the rest is bias.
    assert np.mean(found.standard_error**2) / np.var(found.mean) == pytest.approx(1, abs=0.17 if time == 0.5 else 0.07)
    assert np.mean(found.resolved) > 0.99  # of 66 τ, as the noise of τ would have it


def test_values_that_do_not_change_have_no_error_and_one_value_has_none_known():
    found = statistics_of(np.full(10, 0.1))
    assert (found.standard_error, found.autocorrelation_time, found.resolved) == (0, 0.5, True)
    assert found.mean == pytest.approx(0.1, rel=1e-15)
    found = statistics_of(np.array([2.0]))
    assert (found.mean, found.resolved) == (2.0, False)
    assert np.isnan(found.standard_error)
    few = statistics_of(exponential_memory(0.5, LEAST_STATES - 1, 1000))
    assert not few.resolved.any()
    assert np.isfinite(few.standard_error).all()
    noise = np.random.default_rng(2).standard_normal(50)
    found = statistics_of(np.stack([noise, np.append(noise[1:], np.inf), np.append(noise[2:], [np.inf, -np.inf])], 1))
    np.testing.assert_allclose(found.mean, [noise.mean(), np.inf, np.nan])
    for unknown in (np.isnan(found.standard_error), np.isnan(found.autocorrelation_time), ~found.resolved):
        assert unknown.tolist() == [False, True, True]


def test_series_of_many_times_their_memory_are_told_and_short_ones_seldom_wrongly():
    for time, count, share, wrongly in (
        # Found shares of wrong ones, 0.100 and 0.098, and a fifth. With windows of up to half of the series they are
        # 0.20 and 0.14.
        (20, 60, 0.0, 0.12),
        (50, 200, 0.0, 0.117),
        # Four errors are exceeded once in 16 000 times by normal numbers; an error of few τ is itself uncertain.
        (0.5, LEAST_STATES, 0.99, 0.015),
        (5, 300, 0.98, 0.015),
    ):
        found = statistics_of(exponential_memory(time, count, 4000))
        assert np.mean(found.resolved) >= share
        assert np.mean(found.resolved & (np.abs(found.mean) > 4 * found.standard_error)) < wrongly


def test_autocovariance_is_the_sum_over_pairs_and_scale_and_offset_decide_nothing():
    series = exponential_memory(1.5, 200, 3)
    one, other = statistics_of(series), statistics_of(1e-20 * (series + 3))
    np.testing.assert_allclose(other.autocorrelation_time, one.autocorrelation_time, rtol=1e-10)
    np.testing.assert_allclose(other.standard_error, 1e-20 * one.standard_error, rtol=1e-10)
    series = np.random.default_rng(1).standard_normal((7, 2)) + 5
    deviation = series - series.mean(axis=0)
    for lag in range(7):
        pairs = deviation[: 7 - lag] * deviation[lag:]
        np.testing.assert_allclose(autocovariance(series)[lag], pairs.sum(axis=0) / (7 - lag), rtol=0, atol=1e-14)
