"""A hard wall with a hardness: the conditions of each step, what stays from step to step, energies, limits, edges."""

import numpy as np
import pytest

from bem_adhesion import HardWall, rough_contact
from bem_adhesion.solution import Outcome
from contact_study.physics.solids import HalfSpace, Layer
from tests.bem_adhesion.paper_system import E_STAR, SIZE, approach_of, random_heights, self_affine, stepped
from tests.bem_adhesion.test_hard_wall import assert_complementary

HALF_SPACE = HalfSpace(E_STAR)


def plastic(height, grid, hardness, solid=HALF_SPACE, **options):
    return rough_contact(height, grid.size, solid, HardWall(), hardness=hardness, **options)


@pytest.mark.parametrize(
    ("shape", "exponent", "seed", "share", "loads"),
    [
        ((64, 64), 0.0, 11, 0.05, (0.003, 0.01, 0.001, 0.008, 0.01)),
        ((33, 57), 1.0, 11, 0.05, (0.09, 0.3, 0.03, 0.24, 0.3)),
        ((100, 64), 3.0, 11, 0.05, (0.3, 0.999, 0.1, 0.8, 0.999)),
        ((32, 32), 1.0, 143, 7e-4, (0.5, 1 - 2e-6, 0.2, 1 - 2e-6)),  # flattened all over
    ],
)
def test_conditions_hold_on_every_step_of_a_path(shape, exponent, seed, share, loads):
    height, grid = random_heights(shape, exponent, seed)
    hardness = share * height.std() * E_STAR
    before, targets = np.zeros(shape), hardness * np.array(loads)
    for target, found in zip(targets, stepped(plastic(height, grid, hardness), targets), strict=True):
        assert_complementary(found, height, grid, HALF_SPACE, target, hardness, before)
        before = found.plastic_indentation


def test_a_hardness_out_of_reach_changes_no_bit():
    height, _ = self_affine(128)
    elastic = rough_contact(height, SIZE, E_STAR, HardWall())
    [hard] = stepped(rough_contact(height, SIZE, E_STAR, HardWall(), hardness=1e13), [1e9])
    found = elastic.step(elastic.separated(), 1e9)
    np.testing.assert_array_equal(hard.pressure, found.pressure)
    np.testing.assert_array_equal(hard.gap, found.gap)
    assert hard.fft_pairs == found.fft_pairs
    assert not hard.plastic_indentation.any()


@pytest.mark.parametrize("share", [0.01, 0.5, 0.9])
def test_soft_bodies_yield_on_all_of_their_contact(share):
    height, grid = self_affine(64)
    hardness = 1e-9 * E_STAR
    [found] = stepped(plastic(height, grid, hardness), [share * hardness])
    assert found.converged
    assert found.iterations <= 10
    assert np.mean(found.pressure > 0) == pytest.approx(share, abs=1.5 / grid.points)
    assert height[found.pressure > 0].min() >= height[found.pressure == 0].max()


def test_unloading_is_elastic_and_loading_again_comes_back():
    height, grid = self_affine(64)
    contact = plastic(height, grid, 0.05 * E_STAR)
    up, next_to, down, least, again, beyond = stepped(contact, [2e9, 2e9 * (1 - 1e-4), 1e9, 1e7, 2e9, 3e9])
    # One-sided difference over a change of load of 1e-4, during which no point of this grid opens.
    difference = (up.pressure.mean() - next_to.pressure.mean()) / (next_to.gap.mean() - up.gap.mean())
    assert contact.stiffness(up) == pytest.approx(difference, rel=1e-3)
    for found in (next_to, down, least):
        np.testing.assert_array_equal(found.plastic_indentation, up.plastic_indentation)
    # What follows from pressures within 1e-10 of the rms height: the same state, and no further yielding.
    np.testing.assert_allclose(again.gap, up.gap, atol=1e-9 * height.std())
    np.testing.assert_allclose(again.plastic_indentation, up.plastic_indentation, atol=1e-9 * height.std())
    assert beyond.plastic_indentation.mean() > 1.2 * up.plastic_indentation.mean()
    # The elastic contact of what is left of the surface is the same thing.
    elastic = rough_contact(height - up.plastic_indentation, SIZE, E_STAR, HardWall())
    np.testing.assert_allclose(elastic.step(elastic.separated(), 1e9).pressure, down.pressure, atol=1e-6 * E_STAR)
    assert np.mean(down.pressure > 0) > 1.5 * np.mean(stepped(contact, [1e9])[0].pressure > 0), "yielded points touch"


BODIES = {"layer": (Layer(E_STAR, 0.3, 0.05 * SIZE), "periodic"), "free": (HalfSpace(E_STAR), "free")}


@pytest.mark.parametrize("hardness", [0.1, 0.003])
@pytest.mark.parametrize(("solid", "boundary"), BODIES.values(), ids=BODIES)
def test_an_approach_yields_as_its_pressure_does(solid, boundary, hardness):
    height, grid = self_affine(32)
    hardness *= E_STAR
    pressures = hardness * np.array([0.1, 0.4, 0.05, 0.4, 0.9])
    pressed = stepped(plastic(height, grid, hardness, solid, boundary=boundary), pressures)
    approaches = [approach_of(found, height, solid) for found in pressed]
    contact = plastic(height, grid, hardness, solid, boundary=boundary, control="approach")
    for found, one, target in zip(stepped(contact, approaches), pressed, approaches, strict=True):
        assert found.converged
        assert approach_of(found, height, solid) == pytest.approx(target, abs=3e-10 * height.std())
        assert 0 <= found.pressure.min() <= found.pressure.max() <= hardness * (1 + 1e-14)
        # Two solves to the tolerance, and what the earlier ones of a path leave of it.
        np.testing.assert_allclose(found.plastic_indentation, one.plastic_indentation, atol=1e-8 * height.std())
        np.testing.assert_allclose(found.gap, one.gap, atol=1e-8 * height.std())
        assert found.pressure.mean() == pytest.approx(one.pressure.mean(), rel=1e-6)
    assert 0 < approaches[2] < approaches[1], "unloaded it stands where it yielded to, less what springs back"


@pytest.mark.parametrize(("solid", "boundary"), BODIES.values(), ids=BODIES)
def test_where_the_whole_surface_yields_the_state_says_so(solid, boundary):
    height, grid = self_affine(32)
    hardness = 0.03 * E_STAR
    nearly = stepped(plastic(height, grid, hardness, solid, boundary=boundary), [0.999 * hardness])[0]
    contact = plastic(height, grid, hardness, solid, boundary=boundary, control="approach")
    last = approach_of(nearly, height, solid)
    held, beyond, lifted, apart = stepped(contact, [last, 3 * last, 3 * last - 0.05 * height.std(), last])
    assert held.converged
    assert held.pressure.max() == pytest.approx(hardness, rel=1e-14)
    assert beyond.outcome is Outcome.YIELDED
    assert "whole surface yields" in beyond.message
    np.testing.assert_array_equal(beyond.pressure, hardness)
    np.testing.assert_array_equal(beyond.gap, 0)
    assert approach_of(beyond, height, solid) == pytest.approx(3 * last, rel=1e-8)  # at 1 − 1e-9 of the hardness
    # Surfaces stay as deep as they have been pressed, but for what both spring back.
    assert beyond.plastic_indentation.mean() > held.plastic_indentation.mean() + 1.5 * last
    for found in (lifted, apart):
        assert found.converged
        np.testing.assert_array_equal(found.plastic_indentation, beyond.plastic_indentation)
    assert 0 < lifted.pressure.mean() < hardness
    assert not apart.pressure.any()


@pytest.mark.parametrize("control", ["gap", "approach"])
def test_a_position_is_met_where_every_touching_point_yields(control):
    height, grid = random_heights((12, 12), 1.0, seed=3)
    hardness = 1e-4 * height.std() / max(grid.size) * E_STAR
    solid = HalfSpace(E_STAR) if control == "gap" else Layer(E_STAR, 0.3, 0.05)
    contact = plastic(height, grid, hardness, solid, control=control)
    highest = np.sort(height, axis=None)[-4:]
    # Midway between the third and the fourth point from above: three touch, next to undeformed.
    level = 0.5 * (highest[0] + highest[1])
    target = float(np.maximum(level - height, 0).mean()) if control == "gap" else highest[-1] - level
    [found] = stepped(contact, [target])
    met = found.gap.mean() if control == "gap" else approach_of(found, height, solid)
    assert met == pytest.approx(target, rel=1e-9)
    assert found.pressure.mean() == pytest.approx(3 / 144 * hardness, rel=1e-12)
    assert_complementary(found, height, grid, solid, found.pressure.mean(), hardness)
    # Solid and load move by a ten-thousandth of the heights.
    np.testing.assert_allclose(np.sort(found.plastic_indentation, axis=None)[-3:], highest[1:] - level, rtol=1e-2)
    if control == "gap":
        [near, nearer] = stepped(contact, [target, 0.999 * target])
        assert np.all((nearer.plastic_indentation > near.plastic_indentation) == (near.pressure == hardness))


def test_a_load_that_no_state_carries_is_refused():
    height, grid = self_affine(32)
    contact = plastic(height, grid, 1e9)
    with pytest.raises(ValueError, match="no state carries the hardness"):
        contact.step(contact.separated(), 1e9)
    free = plastic(height, grid, 1e9, boundary="free")
    with pytest.raises(ValueError, match=r"target = 1e\+09: no state carries the hardness"):
        free.step(free.separated(), 1e9)
    with pytest.raises(ValueError, match=r"needs \(2, 32, 32\)"):
        contact.step(np.zeros((32, 32)), 1e8)
    with pytest.raises(ValueError, match="indentation < 0"):
        contact.step(np.stack([np.zeros((32, 32)), np.full((32, 32), -1e-10)]), 1e8)
