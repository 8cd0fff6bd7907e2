"""A hard wall with a hardness: the conditions of each step, what stays from step to step, energies, limits, edges."""

import warnings

import numpy as np
import pytest
from scipy.optimize import lsq_linear

import contact_study
from bem_adhesion import HardWall, rough_contact
from bem_adhesion.solution import Outcome
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import HalfSpace, Layer
from contact_study.study.study import make_study
from tests.bem_adhesion.paper_system import study_table
from tests.bem_adhesion.rough_surfaces import CONTACT_MODULUS, SIZE, random_heights, self_affine
from tests.bem_adhesion.test_hard_wall import dense_compliance

TOLERANCE = 1e-10


def plastic(height, grid, hardness, solid=CONTACT_MODULUS, **options):
    options = {"tolerance": TOLERANCE, **options}
    return rough_contact(height, grid.size, solid, HardWall(), hardness=hardness, **options)


def walked(contact, targets):
    """The states along a path from separation."""
    state, found = contact.separated(), []
    for target in targets:
        found.append(contact.step(state, target))
        state = found[-1].state
    return found


def assert_conditions(found, before, height, grid, hardness, mean_pressure, solid=None):
    """What a step must fulfil, from pressure, gap and indentation alone, by NumPy's transform in float64."""
    solid = solid or HalfSpace(CONTACT_MODULUS)
    pressure, gap, indentation = found.pressure, found.gap, found.plastic_indentation
    assert found.outcome is Outcome.CONVERGED
    assert pressure.min() >= 0
    assert pressure.max() <= hardness * (1 + 1e-14)
    assert pressure.mean() == pytest.approx(mean_pressure, rel=1e-12)
    assert gap.min() >= 0
    assert np.all(gap[pressure > 0] == 0)
    assert np.all(indentation >= before)
    assert np.all((indentation == before)[pressure < hardness * (1 - 1e-14)])
    compliance_q = np.zeros(grid.spectrum_shape)
    compliance_q.reshape(-1)[1:] = 1 / solid.stiffness_on(grid).reshape(-1)[1:]
    displacement = np.fft.irfft2(compliance_q * np.fft.rfft2(pressure), grid.shape)
    surface = height - indentation + gap
    deviation = displacement - displacement.mean() - (surface - surface.mean())
    # The solver's tolerance, and once more for the difference of two transforms and of the means.
    assert np.abs(deviation).max() <= 3 * TOLERANCE * height.std()
    np.testing.assert_allclose(found.displacement, surface, atol=1e-14 * np.abs(height).max())
    assert found.elastic_energy == pytest.approx(
        0.5 * np.mean(pressure * displacement) + solid.compression_energy(mean_pressure),
        rel=1e-6,
        abs=1e-14 * mean_pressure * np.ptp(height) * grid.points**0.5,  # rounding of the work that cancels
    )
    # Where nothing but the hardness bounds the pressure it is met to rounding.
    assert found.complementarity_residual <= 1e-14 * hardness / CONTACT_MODULUS


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
    [found] = walked(plastic(height, grid, hardness, 2.0), [expected.mean()])
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
        for target, found in zip(targets, walked(plastic(height, grid, hardness), targets), strict=True):
            assert_conditions(found, before, height, grid, hardness, target)
            before = found.plastic_indentation


def test_a_hardness_out_of_reach_changes_no_bit():
    height, grid = self_affine(128)
    elastic = rough_contact(height, SIZE, CONTACT_MODULUS, HardWall())
    [hard] = walked(rough_contact(height, SIZE, CONTACT_MODULUS, HardWall(), hardness=1e13), [1e9])
    found = elastic.step(elastic.separated(), 1e9)
    np.testing.assert_array_equal(hard.pressure, found.pressure)
    np.testing.assert_array_equal(hard.gap, found.gap)
    assert hard.fft_pairs == found.fft_pairs
    assert not hard.plastic_indentation.any()
    # Below the largest pressure points yield, and the state tends to the elastic one as the hardness rises to it.
    distance = []
    for share in (0.9, 0.99, 0.999):
        [near] = walked(plastic(height, grid, share * found.pressure.max()), [1e9])
        distance.append(float(np.abs(near.gap - found.gap).max()))
    assert 0 < distance[2] < distance[1] < distance[0]


@pytest.mark.parametrize("share", [0.01, 0.25, 0.5, 0.9])
def test_soft_bodies_yield_on_all_of_their_contact(share):
    """Far below elastic stresses A = p/H, and the load is carried where the surface is highest."""
    height, grid = self_affine(64)
    hardness = 1e-9 * CONTACT_MODULUS
    [found] = walked(plastic(height, grid, hardness), [share * hardness])
    assert found.converged
    assert found.iterations <= 10
    assert np.mean(found.pressure > 0) == pytest.approx(share, abs=1.5 / grid.points)
    assert height[found.pressure > 0].min() >= height[found.pressure == 0].max()


def test_loads_up_to_the_hardness_close_the_contact():
    """Slopes of 0.08 and a hardness of 0.1 E*."""
    height, grid = random_heights((128, 128), 2.0, seed=5)
    gradient = np.gradient(height, *grid.spacing)
    height *= 0.08 / np.sqrt(np.mean(gradient[0] ** 2 + gradient[1] ** 2))
    contact = plastic(height, grid, 0.1 * CONTACT_MODULUS)
    areas = []
    for share in (0.1, 0.7, 0.9, 0.99, 1 - 1e-6):
        [found] = walked(contact, [share * 0.1 * CONTACT_MODULUS])
        assert_conditions(
            found, np.zeros(grid.shape), height, grid, 0.1 * CONTACT_MODULUS, share * 0.1 * CONTACT_MODULUS
        )
        assert found.iterations <= 10
        areas.append(np.mean(found.pressure > 0))
    assert areas == sorted(areas)
    assert areas[-1] == 1


def test_a_surface_that_is_flattened_all_over_can_be_loaded_again():
    height, grid = random_heights((32, 32), 1.0, seed=143)
    hardness = 7e-4 * height.std() * CONTACT_MODULUS
    targets = hardness * np.array([0.5, 1 - 2e-6, 0.2, 1 - 2e-6])
    before = np.zeros(grid.shape)
    for target, found in zip(targets, walked(plastic(height, grid, hardness), targets), strict=True):
        assert_conditions(found, before, height, grid, hardness, target)
        before = found.plastic_indentation


def test_unloading_is_elastic_and_loading_again_comes_back():
    height, grid = self_affine(64)
    contact = plastic(height, grid, 0.05 * CONTACT_MODULUS)
    up, down, least, again, beyond = walked(contact, [2e9, 1e9, 1e7, 2e9, 3e9])
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
    assert np.mean(down.pressure > 0) > 1.5 * np.mean(walked(contact, [1e9])[0].pressure > 0), "yielded points touch"


def test_stiffness_is_that_of_unloading():
    height, grid = self_affine(64)
    contact = plastic(height, grid, 0.05 * CONTACT_MODULUS)
    up, down = walked(contact, [2e9, 2e9 * (1 - 1e-4)])
    difference = (up.pressure.mean() - down.pressure.mean()) / (down.gap.mean() - up.gap.mean())
    # One-sided difference over a change of load of 1e-4, during which no point of this grid opens.
    assert contact.stiffness(up) == pytest.approx(difference, rel=1e-3)


def test_a_sphere_with_free_boundaries_is_indented():
    points, radius = 48, 1e-6
    grid = Grid((points, points), (4e-7, 4e-7))
    x = (np.arange(points) - (points - 1) / 2) * grid.spacing[0]
    height = -(x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)
    hardness, modulus = 1e9, 1e11
    contact = plastic(height, grid, hardness, modulus, boundary="free", tolerance=1e-8)
    force = 3e-5
    [found] = walked(contact, [force / 1.6e-13])
    touching = found.pressure > 0
    assert found.converged
    assert found.pressure.max() <= hardness * (1 + 1e-14)
    assert found.pressure.mean() * 1.6e-13 == pytest.approx(force, rel=1e-10)
    hertz = (3 * force * radius / (4 * modulus)) ** (1 / 3)
    area = np.count_nonzero(touching) * grid.spacing[0] ** 2
    assert 1.5 * force / (np.pi * hertz**2) > 1.5 * hardness, "Hertz' peak pressure is beyond it"
    assert force / hardness < area
    assert area > 1.1 * np.pi * hertz**2
    assert np.all(touching[found.plastic_indentation > 0])
    deepest = np.unravel_index(np.argmax(found.plastic_indentation), grid.shape)
    assert max(abs(deepest[0] - 23.5), abs(deepest[1] - 23.5)) < 1
    [lifted] = walked(contact, [force / 1.6e-13, 1e-3 * force / 1.6e-13])[1:]
    np.testing.assert_array_equal(lifted.plastic_indentation, found.plastic_indentation)


def table(loading, **sections):
    return {
        **study_table(32, size=500e-10, loading=loading),
        "interaction": {"law": "hard_wall"},
        "material": {"youngs_modulus": 77.2e9, "poissons_ratio": 0.42, "hardness": 4e9},
        **sections,
    }


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
    pressed = walked(plastic(height, grid, hardness, solid, boundary=boundary), pressures)
    approaches = [approach_of(found, height, solid) for found in pressed]
    contact = plastic(height, grid, hardness, solid, boundary=boundary, control="approach")
    for found, one, target in zip(walked(contact, approaches), pressed, approaches, strict=True):
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
    nearly = walked(plastic(height, grid, hardness, solid, boundary=boundary), [0.999 * hardness])[0]
    contact = plastic(height, grid, hardness, solid, boundary=boundary, control="approach")
    last = approach_of(nearly, height, solid)
    held, beyond, lifted, apart = walked(contact, [last, 3 * last, 3 * last - 0.05 * height.std(), last])
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


@pytest.mark.parametrize(
    "elasticity", [{"kind": "layer", "thickness": "5 nm"}, {"boundary": "free"}], ids=["layer", "free"]
)
def test_a_study_of_approaches_says_where_the_whole_surface_yields(elasticity, tmp_path):
    study = table({"path": [5e-10, 2e-9, 1e-9, 5e-8], "control": "approach"}, elasticity=elasticity)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*contact reaches the rim")
        with pytest.warns(UserWarning, match="1 of 4 steps did not converge"):
            found = contact_study.run(study, "continuum")
    assert found.converged.values.tolist() == [1, 1, 1, 0]
    assert "whole surface yields" in str(found.message.values[3])
    (case,) = make_study(study).cases
    peak = case.surface.realise(tmp_path).sampled.max()
    # What is held is the undeformed surface, of the bodies as they were; at 1 − 1e-9 of the hardness last.
    np.testing.assert_allclose(peak - found.mean_separation, found.applied_approach, rtol=1e-7)
    work = found.plastic_work.values
    assert 0 < work[0] < work[1]
    assert work[2] == pytest.approx(work[1], rel=1e-9), "unloading yields nothing"
    assert found.relative_contact_area.values[3] == found.relative_plastic_area.values[3] == 1


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
    [found] = walked(contact, [target])
    met = found.gap.mean() if control == "gap" else approach_of(found, height, solid)
    assert met == pytest.approx(target, rel=1e-9)
    assert found.pressure.mean() == pytest.approx(3 / 144 * hardness, rel=1e-12)
    assert_conditions(found, np.zeros(grid.shape), height, grid, hardness, found.pressure.mean(), solid)
    # Solid and load move by a ten-thousandth of the heights.
    np.testing.assert_allclose(np.sort(found.plastic_indentation, axis=None)[-3:], highest[1:] - level, rtol=1e-2)
    if control == "gap":
        [near, nearer] = walked(contact, [target, 0.999 * target])
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
