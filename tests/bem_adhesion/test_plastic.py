"""A hard wall with a hardness: the conditions of each step, what stays from step to step, energies, limits, edges."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from bem_adhesion import HardWall, rough_contact
from bem_adhesion.solution import Outcome
from contact_study.physics.solids import HalfSpace, Layer
from tests.bem_adhesion.rough_surfaces import CONTACT_MODULUS, SIZE, random_heights, self_affine, stepped
from tests.bem_adhesion.test_hard_wall import assert_complementary, dense_compliance

TOLERANCE = 1e-10
HALF_SPACE = HalfSpace(CONTACT_MODULUS)


def plastic(height, grid, hardness, solid=CONTACT_MODULUS, **options):
    options = {"tolerance": TOLERANCE, **options}
    return rough_contact(height, grid.size, solid, HardWall(), hardness=hardness, **options)


@pytest.mark.parametrize(("shape", "share"), [((12, 12), 0.02), ((9, 16), 0.2), ((11, 13), 0.7), ((1, 20), 0.98)])
def test_equals_bounded_least_squares(shape, share):
    height, grid = random_heights(shape, 1.0, seed=3)
    compliance = dense_compliance(grid, 2.0)
    compliance += compliance[0, 0]  # it resists a mean pressure, too: the pressure is the one at its own mean
    factor = np.linalg.cholesky(compliance).T
    target = np.linalg.solve(factor.T, (height - np.quantile(height, 1 - share)).reshape(-1))
    hardness = 0.4 * lsq_linear(factor, target, (0, np.inf), method="bvls").x.max()
    expected = lsq_linear(factor, target, (0, hardness), method="bvls", tol=1e-14).x.reshape(shape)
    assert np.any(expected == hardness)
    [found] = stepped(plastic(height, grid, hardness, 2.0), [expected.mean()])
    assert found.converged
    # Conditioning of the dense problem (some 1e2) times the solver's tolerance, relative to the largest pressure.
    np.testing.assert_allclose(found.pressure, expected, atol=1e-8 * hardness)


@pytest.mark.parametrize(("shape", "exponent"), [((64, 64), 0.0), ((33, 57), 1.0), ((100, 64), 3.0)])
def test_conditions_hold_on_every_step_of_a_path(shape, exponent):
    height, grid = random_heights(shape, exponent, seed=11)
    for largest_share in (0.01, 0.3, 0.999):
        hardness = 0.05 * height.std() * CONTACT_MODULUS
        before = np.zeros(shape)
        targets = largest_share * hardness * np.array([0.3, 1.0, 0.1, 0.8, 1.0])
        for target, found in zip(targets, stepped(plastic(height, grid, hardness), targets), strict=True):
            assert_complementary(found, height, grid, HALF_SPACE, target, hardness, before)
            before = found.plastic_indentation


def test_a_hardness_out_of_reach_changes_no_bit():
    height, grid = self_affine(128)
    elastic = rough_contact(height, SIZE, CONTACT_MODULUS, HardWall())
    [hard] = stepped(rough_contact(height, SIZE, CONTACT_MODULUS, HardWall(), hardness=1e13), [1e9])
    found = elastic.step(elastic.separated(), 1e9)
    np.testing.assert_array_equal(hard.pressure, found.pressure)
    np.testing.assert_array_equal(hard.gap, found.gap)
    assert hard.fft_pairs == found.fft_pairs
    assert not hard.plastic_indentation.any()
    # Below the largest pressure points yield, and the state tends to the elastic one as the hardness rises to it.
    distance = []
    for share in (0.9, 0.99, 0.999):
        [near] = stepped(plastic(height, grid, share * found.pressure.max()), [1e9])
        distance.append(float(np.abs(near.gap - found.gap).max()))
    assert 0 < distance[2] < distance[1] < distance[0]


@pytest.mark.parametrize("share", [0.01, 0.25, 0.5, 0.9])
def test_soft_bodies_yield_on_all_of_their_contact(share):
    """Far below elastic stresses A = p/H, and the load is carried where the surface is highest."""
    height, grid = self_affine(64)
    hardness = 1e-9 * CONTACT_MODULUS
    [found] = stepped(plastic(height, grid, hardness), [share * hardness])
    assert found.converged
    assert found.iterations <= 10
    assert np.mean(found.pressure > 0) == pytest.approx(share, abs=1.5 / grid.points)
    assert height[found.pressure > 0].min() >= height[found.pressure == 0].max()


def test_a_surface_that_is_flattened_all_over_can_be_loaded_again():
    height, grid = random_heights((32, 32), 1.0, seed=143)
    hardness = 7e-4 * height.std() * CONTACT_MODULUS
    targets = hardness * np.array([0.5, 1 - 2e-6, 0.2, 1 - 2e-6])
    before = np.zeros(grid.shape)
    for target, found in zip(targets, stepped(plastic(height, grid, hardness), targets), strict=True):
        assert_complementary(found, height, grid, HALF_SPACE, target, hardness, before)
        before = found.plastic_indentation


def test_unloading_is_elastic_and_loading_again_comes_back():
    height, grid = self_affine(64)
    contact = plastic(height, grid, 0.05 * CONTACT_MODULUS)
    up, down, least, again, beyond = stepped(contact, [2e9, 1e9, 1e7, 2e9, 3e9])
    for found in (down, least):
        np.testing.assert_array_equal(found.plastic_indentation, up.plastic_indentation)
    # What follows from pressures within 1e-10 of the rms height: the same state, and no further yielding.
    np.testing.assert_allclose(again.gap, up.gap, atol=1e-9 * height.std())
    np.testing.assert_allclose(again.plastic_indentation, up.plastic_indentation, atol=1e-9 * height.std())
    assert beyond.plastic_indentation.mean() > 1.2 * up.plastic_indentation.mean()
    # The elastic contact of what is left of the surface is the same thing.
    elastic = rough_contact(height - up.plastic_indentation, SIZE, CONTACT_MODULUS, HardWall(), tolerance=TOLERANCE)
    np.testing.assert_allclose(
        elastic.step(elastic.separated(), 1e9).pressure, down.pressure, atol=1e-6 * CONTACT_MODULUS
    )
    assert np.mean(down.pressure > 0) > 1.5 * np.mean(stepped(contact, [1e9])[0].pressure > 0), "yielded points touch"


def test_stiffness_is_that_of_unloading():
    height, grid = self_affine(64)
    contact = plastic(height, grid, 0.05 * CONTACT_MODULUS)
    up, down = stepped(contact, [2e9, 2e9 * (1 - 1e-4)])
    difference = (up.pressure.mean() - down.pressure.mean()) / (down.gap.mean() - up.gap.mean())
    # One-sided difference over a change of load of 1e-4, during which no point of this grid opens.
    assert contact.stiffness(up) == pytest.approx(difference, rel=1e-3)


BODIES = {"layer": (Layer(CONTACT_MODULUS, 0.3, 0.05 * SIZE), "periodic"), "free": (HalfSpace(CONTACT_MODULUS), "free")}


def approach_of(found, height, solid):
    """Of the undeformed surface beyond first touch of the surface that had not yielded."""
    if found.plane is not None:
        return height.max() - found.plane
    return height.max() - float(np.mean(found.displacement)) + solid.mean_compliance * float(found.pressure.mean())


@pytest.mark.parametrize("hardness", [0.1, 0.003])
@pytest.mark.parametrize(("solid", "boundary"), BODIES.values(), ids=BODIES)
def test_an_approach_yields_as_its_pressure_does(solid, boundary, hardness):
    """Up, down, up again, beyond: the way by pressures and the way by the approaches found there, and back."""
    height, grid = self_affine(32)
    hardness *= CONTACT_MODULUS
    pressures = hardness * np.array([0.1, 0.4, 0.05, 0.4, 0.9])
    pressed = stepped(plastic(height, grid, hardness, solid, boundary=boundary), pressures)
    approaches = [approach_of(found, height, solid) for found in pressed]
    contact = plastic(height, grid, hardness, solid, boundary=boundary, control="approach")
    for found, one, target in zip(stepped(contact, approaches), pressed, approaches, strict=True):
        assert found.converged
        assert approach_of(found, height, solid) == pytest.approx(target, abs=3 * TOLERANCE * height.std())
        assert 0 <= found.pressure.min() <= found.pressure.max() <= hardness * (1 + 1e-14)
        # Two solves to the tolerance, and what the earlier ones of a path leave of it.
        np.testing.assert_allclose(found.plastic_indentation, one.plastic_indentation, atol=1e-8 * height.std())
        np.testing.assert_allclose(found.gap, one.gap, atol=1e-8 * height.std())
        assert found.pressure.mean() == pytest.approx(one.pressure.mean(), rel=1e-6)
    assert 0 < approaches[2] < approaches[1], "unloaded it stands where it yielded to, less what springs back"


@pytest.mark.parametrize(("solid", "boundary"), BODIES.values(), ids=BODIES)
def test_where_the_whole_surface_yields_the_state_says_so(solid, boundary):
    height, grid = self_affine(32)
    hardness = 0.03 * CONTACT_MODULUS
    nearly = stepped(plastic(height, grid, hardness, solid, boundary=boundary), [0.999 * hardness])[0]
    contact = plastic(height, grid, hardness, solid, boundary=boundary, control="approach")
    last = approach_of(nearly, height, solid)
    held, beyond, lifted, apart = stepped(contact, [last, 3 * last, 3 * last - 0.05 * height.std(), last])
    assert held.converged
    assert held.pressure.max() == pytest.approx(hardness, rel=1e-14)
    assert beyond.outcome is Outcome.YIELDED
    assert not beyond.converged
    assert "whole surface yields" in beyond.message
    assert "\n" not in beyond.message
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
    """A few soft points: the pressure stays at a whole number of them while the surfaces approach."""
    height, grid = random_heights((12, 12), 1.0, seed=3)
    hardness = 1e-4 * height.std() / max(grid.size) * CONTACT_MODULUS
    solid = HalfSpace(CONTACT_MODULUS) if control == "gap" else Layer(CONTACT_MODULUS, 0.3, 0.05)
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
