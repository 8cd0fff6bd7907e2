import numpy as np
import pytest
from scipy.signal import lfilter

from contact_study.numerics.time_series import LEAST_STATES, autocovariance, statistics_of


def exponential_memory(correlation, count, columns):
    """Series of unit variance with ρ(t) = correlation^t, whose τ is ½(1 + ρ)/(1 − ρ)."""
    noise = np.random.default_rng(0).standard_normal((count, columns))
    noise[1:] *= np.sqrt(1 - correlation**2)
    return lfilter([1.0], [1.0, -correlation], noise, axis=0)


@pytest.mark.parametrize(("correlation", "count"), [(0.0, 300), (0.5, 300), (0.8, 300), (0.8, 3000)])
def test_error_of_the_mean_is_what_repeated_series_scatter_by(correlation, count):
    found = statistics_of(exponential_memory(correlation, count, 1000))
    time = 0.5 * (1 + correlation) / (1 - correlation)
    # The bias of τ is of the order of the window over the series, 5τ/n; the floor of ½ lifts one of ½ by its noise.
    bias = (0.1 if correlation == 0 else 0.03) + 5 * time / count
    assert np.mean(found.autocorrelation_time) == pytest.approx(time, rel=bias)
    # A thousand means give their scatter to 1/√2000.
    error = np.sqrt(np.mean(found.standard_error**2))
    assert error == pytest.approx(np.std(found.mean), rel=3 / np.sqrt(2000) + bias)
    assert np.mean(found.resolved) > 0.99  # of 66 τ, as the noise of τ would have it


@pytest.mark.parametrize("correlation", [0.5, 0.8])
def test_error_of_a_short_series_is_right_on_average(correlation):
    """Sixty-six τ and two hundred: the window's choice and deviations from the series' own mean nearly cancel."""
    found = statistics_of(exponential_memory(correlation, 300, 4000))
    # The scatter of 4000 means is known to 1/√8000, its square to 2.2 %; the rest is bias.
    assert np.mean(found.standard_error**2) / np.var(found.mean) == pytest.approx(1, abs=0.07)


def test_autocovariance_is_the_sum_over_pairs():
    series = np.random.default_rng(1).standard_normal((7, 2)) + 5
    deviation = series - series.mean(axis=0)
    for lag in range(7):
        pairs = deviation[: 7 - lag] * deviation[lag:]
        np.testing.assert_allclose(autocovariance(series)[lag], pairs.sum(axis=0) / (7 - lag), rtol=0, atol=1e-14)


def test_values_that_do_not_change_have_no_error():
    found = statistics_of(np.full((10, 2), 0.1))
    assert np.all(found.standard_error == 0)
    assert np.all(found.autocorrelation_time == 0.5)
    assert found.resolved.all()
    assert found.mean == pytest.approx(0.1, rel=1e-15)


def test_nothing_is_known_of_the_error_of_what_is_not_finite():
    noise = np.random.default_rng(2).standard_normal(50)
    found = statistics_of(np.stack([noise, np.append(noise[1:], np.inf), np.append(noise[2:], [np.inf, -np.inf])], 1))
    assert found.mean[:2].tolist() == [pytest.approx(noise.mean()), np.inf]
    assert np.isnan(found.mean[2])
    assert np.isnan(found.standard_error).tolist() == [False, True, True]
    assert np.isnan(found.autocorrelation_time).tolist() == [False, True, True]
    assert found.resolved.tolist() == [True, False, False]


def test_series_shorter_than_its_memory_is_told():
    drift = np.linspace(0, 1, 20)
    assert not statistics_of(drift).resolved
    assert statistics_of(drift).mean.shape == ()


def with_memory(time, count):
    """4000 series that remember for this τ, and whether each is resolved though its mean is off by four errors."""
    found = statistics_of(exponential_memory((2 * time - 1) / (2 * time + 1), count, 4000))
    return found, found.resolved & (np.abs(found.mean) > 4 * found.standard_error)


@pytest.mark.parametrize("time", [0.5, 5.0, 20.0, 100.0])
@pytest.mark.parametrize("count", [2, 3, 10, LEAST_STATES - 1])
def test_few_values_tell_no_memory(time, count):
    found, _ = with_memory(time, count)
    assert not found.resolved.any()
    assert np.isfinite(found.standard_error).all()


# Found shares, 0.100, 0.116, 0.081 and 0.098, and a fifth, four deviations of the least. With windows of up to half of
# the series they are 0.20, 0.34, 0.11 and 0.14.
@pytest.mark.parametrize(
    ("time", "count", "share"), [(20, 60, 0.12), (50, 60, 0.14), (20, 100, 0.098), (50, 200, 0.117)]
)
def test_a_memory_near_the_length_of_the_series_is_seldom_told_wrongly(time, count, share):
    _, wrong = with_memory(time, count)
    assert np.mean(wrong) < share


@pytest.mark.parametrize(
    ("time", "count", "share"),
    [(0.5, LEAST_STATES, 0.99), (0.8, 60, 0.98), (2, 60, 0.88), (5, 300, 0.98), (20, 1600, 0.98)],
)
def test_series_of_many_times_their_memory_are_told(time, count, share):
    """Sixty states of the paper's warm contact remember for 0.8 each; forty τ and more are told nearly always."""
    found, wrong = with_memory(time, count)
    assert np.mean(found.resolved) > share
    # Four errors are exceeded once in 16 000 times by normal numbers; an error of few τ is itself uncertain.
    assert np.mean(wrong) < 0.015


def test_one_value_has_no_error():
    found = statistics_of(np.array([2.0]))
    assert (found.mean, found.resolved) == (2.0, False)
    assert np.isnan(found.standard_error)


def test_scale_and_offset_of_the_values_decide_nothing():
    series = exponential_memory(0.5, 200, 3)
    one, other = statistics_of(series), statistics_of(1e-20 * (series + 3))
    np.testing.assert_allclose(other.autocorrelation_time, one.autocorrelation_time, rtol=1e-10)
    np.testing.assert_allclose(other.standard_error, 1e-20 * one.standard_error, rtol=1e-10)
