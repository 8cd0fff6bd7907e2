"""Whether a block under a load is at rest, or in equilibrium at its temperature, as its series tell; checkpoints."""

import numpy as np
import pytest

from contact_study.inputs.errors import InputError
from md_reference.thermal.checkpoint import ChainState, Frame, TrajectoryState
from md_reference.thermal.equilibration import Descent, load_missing, not_in_equilibrium, still_moving
from md_reference.thermal.hmc import SamplerState
from md_reference.thermal.langevin import Motion
from tests.md_reference.systems import E_STAR


def descent(carried, load=1e9, speed=0.0, terminal_speed=np.inf, impact=0.0):
    return Descent(np.asarray(carried), load, bool(np.any(carried)), speed, terminal_speed, impact)


def assert_said(words, message):
    assert message.startswith(words)
    assert bool(message) == bool(words)


NOISE = np.random.default_rng(0).normal(scale=2e8, size=400)  # its mean errs by 1e7
NOISE -= NOISE.mean()
# Four standard errors of a block that bounces are 0.4 of its load: by chance for a thermostat, not for swings.
BOUNCING = 10 * NOISE / (NOISE.std() / 2e8)
# The block lands half-way: the series has an error that would account for the half of the load.
LANDING = np.where(np.arange(100) < 50, 0.0, 1e9) + 0.1 * NOISE[:100]


@pytest.mark.parametrize(
    ("carried", "swings", "words"),
    [
        (1e9 + NOISE, False, ""),
        (1.03e9 + NOISE, False, ""),
        (1.06e9 + NOISE, False, "the interface carried 1.06e+09 ± 1e+07 Pa on average, not the 1e+09 Pa applied"),
        (0.995e9 + 1e-4 * NOISE, False, ""),
        (0.985e9 + 1e-4 * NOISE, False, "the interface carried"),
        (LANDING, False, "the interface carried"),
        (1.2e9 + BOUNCING, False, ""),
        (1.2e9 + BOUNCING, True, "the interface carried 1.2e+09 ± "),
        (1.05e9 + BOUNCING, True, ""),
        ([0.995e9], False, ""),  # one state has no error to miss the load by
        ([0.98e9], False, "the interface carried 9.8e+08 Pa on average, not the 1e+09 Pa applied: raise dynamics.dur"),
    ],
)
def test_the_load_is_carried_within_the_error_of_the_mean(carried, swings, words):
    residual, message = load_missing(descent(carried), E_STAR, swings=swings)
    assert_said(words, message)
    assert residual * E_STAR == pytest.approx(abs(np.mean(carried) - 1e9), abs=0.1)


def test_what_is_said_of_a_block_on_its_way():
    falling = descent([0.4e9, 0.5e9], speed=1.0, terminal_speed=1.5)
    for words in (still_moving(falling, 0.0, E_STAR)[1], load_missing(falling, E_STAR)[1]):
        assert words.startswith("the block still falls at 1 m/s: ")
        assert "lower dynamics.damping: damping limits its fall to 1.5 m/s" in words
    assert still_moving(descent([1e9]), 1e-3 * E_STAR, E_STAR) == (1e-3, "")
    for moving, left, words in (
        (descent([0.4e9, 0.5e9], speed=1.0, terminal_speed=15.0), 0.5e9 / E_STAR, "the atoms still move: "),
        (descent([1e9], impact=2e-3 * E_STAR), 2e-3, "the atoms still move: "),
        # A load too small for the bound is not carried by a surface that nothing touches.
        (descent([0.0], load=1e6), 1e6 / E_STAR, "no atom is within reach of the substrate: "),
    ):
        residual, message = still_moving(moving, 0.0, E_STAR)
        assert residual == pytest.approx(left)
        assert_said(words, message)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, ""),
        # Nothing forgotten: the square of one normal number, of which four deviations are 16.
        ({"whole": 15.9 * 300, "forgotten": 0.1}, ""),
        ({"whole": 4860, "forgotten": 0.1}, "the block still moves up and down as a whole, with 16.2 times"),
        # The mean of many is near to one; of two states it is not.
        ({"whole": 600, "forgotten": 400.0}, "the block still moves up and down"),
        ({"whole": 600, "forgotten": 400.0, "states": 2}, ""),
        ({"carried": 0.5e9, "whole": 1e6, "speed": 1.0, "terminal_speed": 1.5}, "the block still falls"),
        ({"carried": 0.5e9, "whole": 1e6}, "the block still moves up and down"),
        ({"carried": 0.5e9}, "the interface carried"),
        # Four deviations of sqrt(2/10 000), 5.7 %; of many freedoms a hundredth.
        ({"nodes": 284.0}, ""),
        ({"nodes": 316.0}, ""),
        ({"nodes": 282.0}, "the atoms moved at 282 K on average, not at the thermostat's 300 K: "),
        ({"nodes": 318.0}, "the atoms moved at 318 K"),
        ({"nodes": 296.0, "freedoms": 10**6}, "the atoms moved at 296 K"),
        ({"nodes": 297.5, "freedoms": 10**6}, ""),
    ],
)
def test_a_block_that_rings_or_is_cold_is_in_no_equilibrium(given, words):
    warmth = {"nodes": 300.0, "whole": 300.0, "bath": 300.0, "freedoms": 10_000, "forgotten": 9.0, **given}
    carried = [warmth.pop("carried", 1e9)] * warmth.pop("states", 100)
    moving = descent(carried, 1e9, warmth.pop("speed", 0.0), warmth.pop("terminal_speed", np.inf))
    assert_said(words, not_in_equilibrium(moving, E_STAR, **warmth)[1])


def checkpoints():
    rng = np.random.default_rng(1)
    motion = Motion(rng.standard_normal((3, 7)), rng.standard_normal((3, 7)), 2e-9, -300.0, 2e-12)
    series = [Frame(1e-12, 2e-9, 3e8, 300.0, 5.0), Frame(2e-12, 1.9e-9, 4e8, 310.0, 6.0)]
    sampler = SamplerState(np.arange(12).reshape(3, 2, 2) * (1 + 2j), 0.4, np.ones((3, 2, 2)), 2, 1, 9)
    chain = ChainState(sampler, np.random.default_rng(0), np.ones((3, 2, 2)), True, [1e9, 2e9])
    return TrajectoryState(motion, rng, 3, True, 2, 20, 412, series), chain


@pytest.mark.parametrize("before", checkpoints())
def test_a_checkpoint_is_the_same_again_unless_of_another_version(before):
    kept = before.pack()
    after = type(before).unpack(kept)
    for name, values in after.pack().items():
        np.testing.assert_array_equal(kept[name], values)
    assert after.generator.random() == before.generator.random()
    del kept["record"]
    with pytest.raises(InputError, match="of another version of this program; drop it with --overwrite"):
        type(before).unpack(kept)
