"""Whether a block under a load has come to rest, or to equilibrium at its temperature, as its series tell."""

import numpy as np
import pytest

from contact_study.numerics.time_series import statistics_of
from md_reference.thermal.equilibration import (
    Descent,
    TemperatureStatistics,
    load_missing,
    not_in_equilibrium,
    still_moving,
)
from tests.md_reference.systems import CONTACT_MODULUS


def descent(carried, load=1e9, speed=0.0, terminal_speed=np.inf, impact=0.0):
    return Descent(np.asarray(carried), load, bool(np.any(carried)), speed, terminal_speed, impact)


def test_the_load_is_carried_within_the_error_of_the_mean():
    noise = np.random.default_rng(0).normal(scale=2e8, size=400)  # its mean errs by 1e7
    noise -= noise.mean()
    assert load_missing(descent(1e9 + noise), CONTACT_MODULUS) == (pytest.approx(0, abs=1e-12), "")
    assert load_missing(descent(1.03e9 + noise), CONTACT_MODULUS)[1] == ""
    residual, message = load_missing(descent(1.06e9 + noise), CONTACT_MODULUS)
    assert residual == pytest.approx(6e7 / CONTACT_MODULUS)
    assert message.startswith("the interface carried 1.06e+09 ± 1e+07 Pa on average, not the 1e+09 Pa applied")
    # A hundredth of the load is missing, and a drift has little noise.
    assert load_missing(descent(0.995e9 + 1e-4 * noise), CONTACT_MODULUS)[1] == ""
    assert load_missing(descent(0.985e9 + 1e-4 * noise), CONTACT_MODULUS)[1]
    # The block lands half-way: the series has an error that would account for the half of the load.
    landing = np.where(np.arange(100) < 50, 0.0, 1e9) + 0.1 * noise[:100]
    assert 4 * statistics_of(landing).standard_error > 5e8
    assert load_missing(descent(landing), CONTACT_MODULUS)[1]


def test_swings_do_not_excuse_a_load_that_is_not_carried():
    """Four standard errors of a block that bounces are 0.4 of its load: by chance for a thermostat, not for swings."""
    noise = np.random.default_rng(0).normal(size=400)
    noise *= 2e9 / noise.std()
    bouncing = descent(1.2e9 + noise - noise.mean())
    assert load_missing(bouncing, CONTACT_MODULUS)[1] == ""
    residual, message = load_missing(bouncing, CONTACT_MODULUS, swings=True)
    assert residual == pytest.approx(2e8 / CONTACT_MODULUS)
    assert message.startswith("the interface carried 1.2e+09 ± ")
    assert load_missing(descent(1.05e9 + noise - noise.mean()), CONTACT_MODULUS, swings=True)[1] == ""


def test_one_state_has_no_error_to_miss_the_load_by():
    assert load_missing(descent([0.995e9]), CONTACT_MODULUS)[1] == ""
    said = "the interface carried 9.8e+08 Pa on average, not the 1e+09 Pa applied: raise dynamics.duration"
    assert load_missing(descent([0.98e9]), CONTACT_MODULUS)[1] == said


def test_what_is_said_of_a_block_on_its_way():
    falling = descent([0.4e9, 0.5e9], speed=1.0, terminal_speed=1.5)
    for words in (still_moving(falling, 0.0, CONTACT_MODULUS)[1], load_missing(falling, CONTACT_MODULUS)[1]):
        assert words.startswith("the block still falls at 1 m/s: ")
        assert "lower dynamics.damping: damping limits its fall to 1.5 m/s" in words
    ringing = descent([0.4e9, 0.5e9], speed=1.0, terminal_speed=15.0)
    assert still_moving(ringing, 0.0, CONTACT_MODULUS)[1].startswith("the atoms still move: ")
    assert still_moving(descent([1e9]), 1e-3 * CONTACT_MODULUS, CONTACT_MODULUS) == (1e-3, "")
    # Nothing is out of balance, and the block moves.
    residual, message = still_moving(descent([1e9], impact=2e-3 * CONTACT_MODULUS), 0.0, CONTACT_MODULUS)
    assert residual == pytest.approx(2e-3)
    assert message.startswith("the atoms still move: ")
    # A load too small for the bound is not carried by a surface that nothing touches.
    residual, message = still_moving(descent([0.0], load=1e6), 0.0, CONTACT_MODULUS)
    assert residual == pytest.approx(1e6 / CONTACT_MODULUS)
    assert message.startswith("no atom is within reach of the substrate: ")
    assert "damping" not in message  # there is none


def warmth(nodes=300.0, whole=300.0, freedoms=10_000, states=100, forgotten=9.0):
    return TemperatureStatistics(nodes, whole, 300.0, freedoms, states, forgotten)


def said_of(carried=1e9, speed=0.0, terminal_speed=np.inf, **given):
    return not_in_equilibrium(descent([carried] * 20, 1e9, speed, terminal_speed), warmth(**given), CONTACT_MODULUS)[1]


def test_a_block_that_moves_up_and_down_by_more_than_chance_is_in_no_equilibrium():
    assert said_of() == ""
    # Nothing forgotten: the square of one normal number, of which four deviations are 16.
    assert said_of(whole=15.9 * 300, forgotten=0.1) == ""
    assert "with 16.2 times the energy of thermal motion, by chance with 16.1 " in said_of(whole=4860, forgotten=0.1)
    # The mean of many is near to one; of two states it is not.
    assert said_of(whole=600, forgotten=400.0)
    assert said_of(whole=600, forgotten=400.0, states=2) == ""
    # A fall has other remedies.
    assert said_of(0.5e9, whole=1e6, speed=1.0, terminal_speed=1.5).startswith("the block still falls")
    assert said_of(0.5e9, whole=1e6).startswith("the block still moves up and down")
    assert said_of(0.5e9).startswith("the interface carried")


@pytest.mark.parametrize("forgotten", [1.0, 9.0])
@pytest.mark.parametrize("swings", [5.5, 8.2])  # in all states; of 5.5 in 11 states each state sees the same
def test_chance_is_not_taken_for_ringing(forgotten, swings):
    """Oscillators in equilibrium with a bath, exactly."""
    states, copies = 11, 20_000
    random = np.random.default_rng(0)
    kept = np.exp((-0.5 * forgotten + 2j * np.pi * swings) / states)
    amplitude = random.normal(size=(copies, 2)) @ [1, 1j]
    squares = np.zeros(copies)
    for _ in range(states):
        noise = random.normal(size=(copies, 2)) @ [1, 1j]
        amplitude = kept * amplitude + np.sqrt(1 - abs(kept) ** 2) * noise
        squares += amplitude.real**2
    # 20 000 times 6e-5 are 1.2 beyond the bound: more than six once in a thousand times.
    seventh = np.sort(squares / states)[-7]
    assert said_of(whole=300 * seventh, states=states, forgotten=forgotten) == ""
    assert said_of(whole=300 * 3 * seventh, states=states, forgotten=forgotten)


def test_cold_nodes_are_in_no_equilibrium():
    """Four deviations of sqrt(2/10 000), 5.7 %; of many freedoms a hundredth."""
    assert said_of(nodes=284.0) == said_of(nodes=316.0) == ""
    assert said_of(nodes=282.0).startswith("the atoms moved at 282 K on average, not at the thermostat's 300 K: ")
    assert said_of(nodes=318.0)
    assert said_of(nodes=296.0, freedoms=10**6)
    assert said_of(nodes=297.5, freedoms=10**6) == ""
