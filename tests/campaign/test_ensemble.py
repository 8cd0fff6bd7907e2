import numpy as np
import pytest

from contact_study.campaign.worker import Averages
from contact_study.numerics.distributions import Bins
from contact_study.numerics.time_series import statistics_of
from contact_study.results.schema import AUTOCORRELATION_TIME, STANDARD_ERROR, variable_of
from contact_study.results.state import InterfaceState, SolverReport


def state(separation, time):
    return InterfaceState(
        gap=np.full((2, 2), 3e-10),
        pressure=np.zeros((2, 2)),
        contact=np.zeros((2, 2), bool),
        equilibrium_distance=3e-10,
        mean_separation=separation,
        elastic_energy=0.0,
        interaction_energy=0.0,
        report=SolverReport(True, False, 0.0, 1, 0.0),
        spacing=(1e-10, 1e-10),
        further={"time": time, "temperature": 300.0},
    )


def averages_of(separations):
    averages = Averages(Bins(np.array([-1e9, 1e9]), np.array([0, 1e-9])), fields=False, discarded=100)
    for number, separation in enumerate(np.concatenate([np.zeros(100), separations])):
        averages.add(state(separation, 1e-13 * number))
    return averages


def test_fewer_states_than_tell_a_memory_are_warned_of_alike():
    noise = np.random.default_rng(0).standard_normal(49)
    with pytest.warns(UserWarning, match="the 49 states of a point, 4.9 ps, .* takes 50: .*; raise dynamics.fr"):
        values = averages_of(1e-12 * noise).step().values
    assert np.isnan(values["mean_separation" + AUTOCORRELATION_TIME])
    values = averages_of(1e-12 * np.append(noise, 0.0)).step().values
    assert values["mean_separation" + AUTOCORRELATION_TIME] < 2e-13


def test_memory_of_states_in_motion_is_a_time():
    noise = np.random.default_rng(0).standard_normal(800)
    series = 1e-12 * np.convolve(noise, np.exp(-np.arange(200) / 20))[300:700]
    values = averages_of(series).step().values
    found = statistics_of(series)
    assert 5 < found.autocorrelation_time < 40
    time = "mean_separation" + AUTOCORRELATION_TIME
    assert values[time] == pytest.approx(1e-13 * found.autocorrelation_time, rel=1e-9)
    assert variable_of(time).units == "s"
    assert values["mean_pressure" + AUTOCORRELATION_TIME] == pytest.approx(0.5e-13)  # without memory
    # Half of a drift's 6 ps hold no five times its memory.
    least = statistics_of(np.linspace(0, 1e-11, 60)).autocorrelation_time / 10
    assert 0.6 < least < 1.2
    words = "the 60 states of a point, 6 ps, are too few for the autocorrelation time of mean_separation, "
    words += f"{least:.2g} ps at least: their standard errors need a series of twenty such times; raise dynamics.dur"
    with pytest.warns(UserWarning, match=words):
        values = averages_of(np.linspace(0, 1e-11, 60)).step().values
    assert np.isnan(values[time])
    assert values["mean_separation" + STANDARD_ERROR] > 0
