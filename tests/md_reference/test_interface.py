"""The interface: pairs, the surface between the sites, expansion about the last evaluation, flat layers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contact_study.numerics.fourier import interpolate
from md_reference.interface.cached import CachedInterface
from md_reference.interface.pairs import LennardJonesInterface, flat_adhesion
from md_reference.interface.substrate import Substrate, sample_substrate
from tests.md_reference.systems import (
    AREA,
    CONTACT_MODULUS,
    LATTICE_CONSTANT,
    LENGTH,
    WELL_DEPTH,
    interface_of,
    rough_heights,
    times_matrices,
)

ATOMS = (7, 10)
INTERFACE = interface_of(ATOMS, rough_heights(modes=2, rms=1.0e-10))


def state_on(interface, seed=0, lateral=20e-10, lowest=0.95, highest=2.5):
    rng = np.random.default_rng(seed)
    u = np.zeros((3, *interface.shape))
    u[:2] = rng.uniform(-lateral, lateral, (2, *interface.shape))
    u[2] = -interface.gap(u) + rng.uniform(lowest, highest, interface.shape) * LENGTH
    return u


def evaluated(interface, u, with_hessian=False):
    force, hessian = np.empty_like(u), np.empty((6, *u.shape[1:]))
    energy = interface.evaluate(u, force, hessian if with_hessian else None)
    return (energy, force, hessian) if with_hessian else (energy, force)


def switched_pair(s, cutoff=4.0):
    x = np.clip((s / (cutoff * LENGTH) ** 2 - 0.81) / 0.19, 0, 1)
    t = (LENGTH**2 / s) ** 3
    return 4 * WELL_DEPTH * (t**2 - t) * (1 - 10 * x**3 + 15 * x**4 - 6 * x**5)


def pair_sum(interface, u):
    substrate = interface.substrate
    rows, columns = substrate.shape
    j, i = np.meshgrid(np.arange(-3 * rows, 4 * rows), np.arange(-3 * columns, 4 * columns), indexing="ij")
    heights = substrate.heights[j % rows, i % columns]
    total = 0.0
    for iy, ix in np.ndindex(interface.shape):
        dx = ix * interface.spacing[1] + u[0, iy, ix] - i * substrate.spacing[1]
        dy = iy * interface.spacing[0] + u[1, iy, ix] - j * substrate.spacing[0]
        total += np.sum(switched_pair(dx**2 + dy**2 + (u[2, iy, ix] - heights) ** 2))
    return total


def test_energy_is_the_sum_over_all_pairs_within_the_cutoff():
    u = state_on(INTERFACE, lateral=5e-10)
    energy, plain = evaluated(INTERFACE, u)
    assert energy == pytest.approx(pair_sum(INTERFACE, u), rel=1e-12)
    full_energy, full, _ = evaluated(INTERFACE, u, True)
    assert energy == pytest.approx(full_energy, rel=1e-14)
    np.testing.assert_allclose(plain, full, rtol=0, atol=1e-13 * np.abs(plain).max())


def test_atoms_that_the_skip_map_passes_over_feel_nothing():
    u, highest = np.zeros((3, *ATOMS)), INTERFACE.substrate.heights.max()
    u[2] = highest + np.linspace(3.9, 4.05, ATOMS[0] * ATOMS[1]).reshape(ATOMS) * LENGTH
    energy, force = evaluated(INTERFACE, u)
    assert energy == pytest.approx(pair_sum(INTERFACE, u), rel=1e-9)
    far = u[2] > highest + 4 * LENGTH
    assert 0 < np.count_nonzero(far) < far.size
    assert np.all(force[:, far] == 0)


def test_force_and_hessian_are_derivatives_to_second_order_of_the_difference():
    u = state_on(INTERFACE)
    _, force, hessian = evaluated(INTERFACE, u, True)
    direction = np.random.default_rng(1).standard_normal(u.shape)
    image, slope = times_matrices(hessian, direction), -np.sum(force * direction)
    errors = []
    for h in (8e-13, 4e-13, 2e-13):
        (above, force_above), (below, force_below) = (evaluated(INTERFACE, u + s * h * direction) for s in (1, -1))
        curvature = np.abs((force_above - force_below) / (2 * h) + image).max()
        errors.append([abs((above - below) / (2 * h) / slope - 1), curvature])
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all((rates > 1.9) & (rates < 2.1))
    assert errors[-1][1] < 1e-3 * np.abs(image).max()


@settings(max_examples=25)
@given(rows=st.integers(-20, 20), columns=st.integers(-20, 20), seed=st.integers(0, 99))
def test_periods_and_moves_of_the_whole_change_nothing(rows, columns, seed):
    u, substrate = state_on(INTERFACE, seed), INTERFACE.substrate
    energy, here = evaluated(INTERFACE, u)
    rolled = Substrate(np.roll(substrate.heights, (rows, columns), (0, 1)), substrate.spacing)
    other = LennardJonesInterface(rolled, ATOMS, INTERFACE.spacing, WELL_DEPTH, LENGTH, 4.0)
    period = (rows % 9 - 4) * ATOMS[0] * LATTICE_CONSTANT, (columns % 9 - 4) * ATOMS[1] * LATTICE_CONSTANT
    for interface, way in (
        (INTERFACE, period),
        (other, (rows * substrate.spacing[0], columns * substrate.spacing[1])),
    ):
        moved = u.copy()
        moved[:2] += np.array(way[::-1])[:, None, None]
        energy_there, there = evaluated(interface, moved)
        assert energy_there == pytest.approx(energy, rel=1e-9)
        # Positions of up to 1e-8 m are rounded to 1e-24 m; the steepest atoms change by 1e3 N/m.
        np.testing.assert_allclose(there, here, rtol=0, atol=1e-11 * np.abs(here).max())
        np.testing.assert_allclose(interface.gap(moved), INTERFACE.gap(u), atol=1e-22)


@pytest.mark.parametrize(("component", "value"), [(2, -1.0), (2, 0.2), (2, np.nan), (0, np.inf), (0, 1e3)])
def test_an_atom_inside_or_nowhere_has_infinite_energy(component, value):
    u = state_on(INTERFACE)
    if component == 2:
        value = -INTERFACE.gap(u * [[[1]], [[1]], [[0]]])[3, 4] + value * LENGTH
    u[component, 3, 4] = value
    assert evaluated(INTERFACE, u)[0] == np.inf


def test_prefactor_is_that_of_a_flat_layer():
    interface = interface_of((13, 13))
    u = np.zeros((3, 13, 13))
    for distance in (0.95, 1.2):
        u[2] = distance * LENGTH
        s = 1 / distance
        # Discrete sites and the cutoff: a few per cent of the attraction.
        expected = pytest.approx(interface.force_prefactor * (s**11 - s**5), rel=0.04)
        assert np.mean(evaluated(interface, u)[1][2]) == expected


def test_cosine_of_the_tilt_is_that_of_the_surface():
    interface = interface_of((40, 40), rough_heights())
    u = np.random.default_rng(0).uniform(-3e-10, 3e-10, (3, 40, 40))
    gap, cosine = interface.gap_and_cosine(u)
    np.testing.assert_array_equal(gap, interface.gap(u))
    h = 1e-13
    steps = h * np.eye(3)[:2, :, None, None]
    slopes = [(interface.gap(u - step) - interface.gap(u + step)) / (2 * h) for step in steps]
    # The difference quotient of a cubic: h² over the square of its spacing, and rounding of heights over h.
    np.testing.assert_allclose(cosine, 1 / np.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2), rtol=1e-6)
    assert cosine.min() < 0.95


SIZE = (48e-10, 80e-10)
WAVY = rough_heights(modes=4, rms=1e-10)


def exact_height(y, x):
    wave = 2 * np.pi * np.fft.fftfreq(9, 1 / 9)
    along_y, along_x = np.exp(1j * np.outer(y, wave) / SIZE[0]), np.exp(1j * np.outer(x, wave) / SIZE[1])
    return np.einsum("ny,nx,yx->n", along_y, along_x, np.fft.fft2(WAVY) / WAVY.size).real


def test_samples_are_refined_until_the_height_is_as_exact_as_asked():
    coarse, fine = (
        sample_substrate(lambda shape: interpolate(WAVY, shape), SIZE, (16, 16), t) for t in (np.inf, 1e-14)
    )
    y, x = np.random.default_rng(4).uniform(0, 1, (2, 500)) * np.array(SIZE)[:, None]
    assert (coarse.refinement, fine.refinement) == (1, 4)
    np.testing.assert_allclose(fine.heights, coarse.heights, atol=1e-24)
    errors = [np.abs(substrate.height_and_cosine(y, x)[0] - exact_height(y, x)).max() for substrate in (fine, coarse)]
    assert errors[0] < 0.01 * errors[1]


MANY = (30, 40)
SCALE = CONTACT_MODULUS * AREA
ROUGH = interface_of(MANY, rough_heights(modes=2))


def first_evaluated(distances):
    start = np.zeros((3, *MANY))
    start[:2] = np.random.default_rng(0).uniform(-1e-10, 1e-10, (2, *MANY))
    start[2] = -ROUGH.gap(start) + distances * LENGTH
    cached, force = CachedInterface(ROUGH, MANY), np.empty_like(start)
    energy, exact, hessian = evaluated(ROUGH, start, True)
    assert cached.evaluate(start, force) == pytest.approx(energy, rel=1e-12)
    np.testing.assert_array_equal(force, exact)
    np.testing.assert_array_equal(cached.hessian, hessian.astype(np.float32))
    assert cached.evaluations == 1
    return start, cached, force


@pytest.mark.parametrize(
    ("error", "size"),
    [(1e-6, 0.09), (1e-4, 0.003), (1e-4, 0.3), (1e-2, 0.03)],
)
def test_expanded_forces_are_within_the_error_allowed(error, size):
    start, cached, force = first_evaluated(np.random.default_rng(2).uniform(0.9, 4.2, MANY))
    rng = np.random.default_rng(1)
    direction = rng.standard_normal((3, *MANY))
    step = size * LENGTH * rng.uniform(0, 1, MANY) * direction / np.linalg.norm(direction, axis=0)
    energy = cached.evaluate(start + step, force, error * SCALE)
    # The bound of T leaves room for its growth on the way: measured, 0.42 of the error at most. The next term of the
    # energy is a third of the force's, times the way, of either sign: measured, 7e-4 of the bound at most.
    exact_energy, exact, _ = evaluated(ROUGH, start + step, True)
    off = np.linalg.norm(force - exact, axis=0)
    assert 1e-3 * error * SCALE < off.max() <= error * SCALE
    left = np.linalg.norm(step, axis=0)[off > 0].max()
    assert left <= 0.1 * LENGTH
    assert abs(energy - exact_energy) <= 3e-3 * error * SCALE * left * np.count_nonzero(off)
    share = cached.evaluations - 1
    assert np.count_nonzero(off) == pytest.approx((1 - share) * off.size, abs=0.03 * off.size)  # some are out of reach
    assert 0.0 < share < 1.0 or size == 0.003


def test_without_an_error_allowed_only_atoms_that_stood_are_left():
    start, cached, force = first_evaluated(1.1)
    there = start.copy()
    there[2, :3] += 1e-6 * LENGTH
    cached.evaluate(there, force)
    np.testing.assert_array_equal(force, evaluated(ROUGH, there, True)[1])
    assert cached.evaluations == pytest.approx(1 + 3 / MANY[0])
    cached.forget()
    cached.evaluate(there, force)
    assert cached.evaluations == pytest.approx(2 + 3 / MANY[0])


def test_no_expansion_starts_from_an_atom_inside_the_substrate():
    start, cached, force = first_evaluated(1.1)
    inside = start.copy()
    inside[2, 4, 5] -= LENGTH
    for _ in range(2):
        assert cached.evaluate(inside, force, 1e-3 * SCALE) == np.inf
    cached.evaluate(start, force, 1e-3 * SCALE)
    np.testing.assert_array_equal(force, evaluated(ROUGH, start, True)[1])


SITE = 400 * LATTICE_CONSTANT / 647


def flat(cutoff):
    return flat_adhesion((SITE, SITE), AREA, WELL_DEPTH, LENGTH, cutoff)


@pytest.mark.parametrize(("cutoff", "adhesion"), [(4, 0.68646), (8, 0.69164)])
def test_adhesion_of_flat_layers_is_that_of_the_prototype(cutoff, adhesion):
    found = flat(cutoff)
    # An independent prototype, to the digits that it printed.
    assert found["work_of_adhesion"] == pytest.approx(adhesion, abs=6e-6)
    assert found["equilibrium_distance"] == pytest.approx(3.280e-10, abs=1e-14)
    assert found["peak_distance"] == pytest.approx(3.741e-10, abs=1e-13)
    assert found["peak_tensile_stress"] == pytest.approx(3.980e9, rel=1e-3)
