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
    E_STAR,
    R0,
    SPACING,
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
    u[2] = -interface.gap(u) + rng.uniform(lowest, highest, interface.shape) * R0
    return u


def evaluated(interface, u, with_hessian=False):
    force, hessian = np.empty_like(u), np.empty((6, *u.shape[1:]))
    energy = interface.evaluate(u, force, hessian if with_hessian else None)
    return (energy, force, hessian) if with_hessian else (energy, force)


def switched_pair(s, cutoff=4.0):
    x = np.clip((s / (cutoff * R0) ** 2 - 0.81) / 0.19, 0, 1)
    t = (R0**2 / s) ** 3
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
    u, edge = state_on(INTERFACE, lateral=5e-10), np.zeros((3, *ATOMS))
    energy, plain = evaluated(INTERFACE, u)
    assert energy == pytest.approx(pair_sum(INTERFACE, u), rel=1e-12)
    full_energy, full, _ = evaluated(INTERFACE, u, True)
    assert energy == pytest.approx(full_energy, rel=1e-14)
    np.testing.assert_allclose(plain, full, rtol=0, atol=1e-13 * np.abs(plain).max())
    height = np.linspace(3.9, 4.05, ATOMS[0] * ATOMS[1]).reshape(ATOMS)
    edge[2] = INTERFACE.substrate.heights.max() + height * R0
    energy, force = evaluated(INTERFACE, edge)
    assert energy == pytest.approx(pair_sum(INTERFACE, edge), rel=1e-9)
    assert np.all(force[:, height > 4] == 0)


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
    other = LennardJonesInterface(rolled, ATOMS, INTERFACE.spacing, WELL_DEPTH, R0, 4.0)
    period = (columns % 9 - 4) * ATOMS[1] * SPACING, (rows % 9 - 4) * ATOMS[0] * SPACING, 0
    way = columns * substrate.spacing[1], rows * substrate.spacing[0], 0
    for interface, moved in ((INTERFACE, u + np.reshape(period, (3, 1, 1))), (other, u + np.reshape(way, (3, 1, 1)))):
        energy_there, there = evaluated(interface, moved)
        assert energy_there == pytest.approx(energy, rel=1e-9)
        # Positions of up to 1e-8 m are rounded to 1e-24 m; the steepest atoms change by 1e3 N/m.
        np.testing.assert_allclose(there, here, rtol=0, atol=1e-11 * np.abs(here).max())
        np.testing.assert_allclose(interface.gap(moved), INTERFACE.gap(u), atol=1e-22)


@pytest.mark.parametrize(("component", "value"), [(2, -1.0), (2, 0.2), (2, np.nan), (0, np.inf), (0, 1e3)])
def test_an_atom_inside_or_nowhere_has_infinite_energy(component, value):
    u = state_on(INTERFACE)
    if component == 2:
        value = -INTERFACE.gap(u * [[[1]], [[1]], [[0]]])[3, 4] + value * R0
    u[component, 3, 4] = value
    assert evaluated(INTERFACE, u)[0] == np.inf


SIZE = (48e-10, 80e-10)
WAVY = rough_heights(modes=4, rms=1e-10)


def exact_height_and_cosine(y, x):
    wave = 2j * np.pi * np.fft.fftfreq(9, 1 / 9)
    along_y, along_x = np.exp(np.outer(y, wave) / SIZE[0]), np.exp(np.outer(x, wave) / SIZE[1])
    height, slope_y, slope_x = (
        np.einsum("ny,nx,yx->n", one, other, np.fft.fft2(WAVY) / WAVY.size).real
        for one, other in ((along_y, along_x), (along_y * wave / SIZE[0], along_x), (along_y, along_x * wave / SIZE[1]))
    )
    return height, 1 / np.sqrt(1 + slope_y**2 + slope_x**2)


def test_samples_are_refined_until_the_height_is_as_exact_as_asked():
    coarse, fine = (
        sample_substrate(lambda shape: interpolate(WAVY, shape), SIZE, (16, 16), t) for t in (np.inf, 1e-14)
    )
    y, x = np.random.default_rng(4).uniform(-1, 2, (2, 500)) * np.array(SIZE)[:, None]
    assert (coarse.refinement, fine.refinement) == (1, 4)
    np.testing.assert_allclose(fine.heights, coarse.heights, atol=1e-24)
    height, cosine = exact_height_and_cosine(y, x)
    errors = [np.abs(substrate.height_and_cosine(y, x)[0] - height).max() for substrate in (fine, coarse)]
    assert errors[0] < 0.01 * errors[1]
    # The spline's slope is of third order in the distance of samples, an eighth of the shortest wave.
    np.testing.assert_allclose(fine.height_and_cosine(y, x)[1], cosine, rtol=1e-3)
    assert cosine.min() < 0.95


MANY = (30, 40)
SCALE = E_STAR * AREA
ROUGH = interface_of(MANY, rough_heights(modes=2))


def first_evaluated(distances):
    start = np.zeros((3, *MANY))
    start[:2] = np.random.default_rng(0).uniform(-1e-10, 1e-10, (2, *MANY))
    start[2] = -ROUGH.gap(start) + distances * R0
    cached, force = CachedInterface(ROUGH, MANY), np.empty_like(start)
    energy, exact, hessian = evaluated(ROUGH, start, True)
    assert cached.evaluate(start, force) == pytest.approx(energy, rel=1e-12)
    np.testing.assert_array_equal(force, exact)
    np.testing.assert_array_equal(cached.hessian, hessian.astype(np.float32))
    assert cached.evaluations == 1
    return start, cached, force


@pytest.mark.parametrize(("error", "size"), [(1e-6, 0.09), (1e-4, 0.003), (1e-4, 0.3), (1e-2, 0.03)])
def test_expanded_forces_are_within_the_error_allowed(error, size):
    start, cached, force = first_evaluated(np.random.default_rng(2).uniform(0.9, 4.2, MANY))
    rng = np.random.default_rng(1)
    direction = rng.standard_normal((3, *MANY))
    step = size * R0 * rng.uniform(0, 1, MANY) * direction / np.linalg.norm(direction, axis=0)
    energy = cached.evaluate(start + step, force, error * SCALE)
    # The bound of T leaves room for its growth on the way: measured, 0.42 of the error at most. The next term of the
    # energy is a third of the force's, times the way, of either sign: measured, 7e-4 of the bound at most.
    exact_energy, exact, _ = evaluated(ROUGH, start + step, True)
    off = np.linalg.norm(force - exact, axis=0)
    assert 1e-3 * error * SCALE < off.max() <= error * SCALE
    left = np.linalg.norm(step, axis=0)[off > 0].max()
    assert left <= 0.1 * R0
    assert abs(energy - exact_energy) <= 3e-3 * error * SCALE * left * np.count_nonzero(off)
    share = cached.evaluations - 1
    assert np.count_nonzero(off) == pytest.approx((1 - share) * off.size, abs=0.03 * off.size)  # some are out of reach
    assert 0.0 < share < 1.0 or size == 0.003


def test_without_an_error_allowed_only_atoms_that_stood_are_left():
    start, cached, force = first_evaluated(1.1)
    there, inside = start.copy(), start.copy()
    there[2, :3] += 1e-6 * R0
    for evaluations in (1 + 3 / MANY[0], 2 + 3 / MANY[0]):
        cached.evaluate(there, force)
        np.testing.assert_array_equal(force, evaluated(ROUGH, there, True)[1])
        assert cached.evaluations == pytest.approx(evaluations)
        cached.forget()
    # No expansion starts from an atom inside the substrate.
    inside[2, 4, 5] -= R0
    for _ in range(2):
        assert cached.evaluate(inside, force, 1e-3 * SCALE) == np.inf
    cached.evaluate(start, force, 1e-3 * SCALE)
    np.testing.assert_array_equal(force, evaluated(ROUGH, start, True)[1])


def test_the_atoms_that_are_expanded_depend_on_no_choice_of_axes():
    heights, found, error = rough_heights(modes=6), [], 1e-4 * SCALE
    steep, turned = interface_of(MANY, heights), interface_of(MANY[::-1], heights.T)
    start = state_on(steep, lateral=1e-10, lowest=1.2)
    step = np.random.default_rng(1).uniform(-0.03, 0.03, (3, *MANY)) * R0
    for interface, order, axes in ((steep, [0, 1, 2], (0, 1, 2)), (turned, [1, 0, 2], (0, 2, 1))):
        cached, force = CachedInterface(interface, interface.shape), np.empty((3, *interface.shape))
        for u in (start, start + step):
            cached.evaluate(np.ascontiguousarray(u[order].transpose(axes)), force, error)
        found.append((cached.evaluations, force[order].transpose(axes)))
    (evaluations, force), (evaluations_turned, force_turned) = found
    assert 1.1 < evaluations == evaluations_turned < 1.9
    # 17 k d²/r0 is below twice the error: k d is some tens of it, and single precision rounds that by 6e-8 of it.
    np.testing.assert_allclose(force_turned, force, rtol=0, atol=1e-5 * error)


SITE = 400 * SPACING / 647


@pytest.mark.parametrize(("cutoff", "adhesion"), [(4, 0.68646), (8, 0.69164)])
def test_adhesion_of_flat_layers_is_that_of_the_prototype(cutoff, adhesion):
    found = flat_adhesion((SITE, SITE), AREA, WELL_DEPTH, R0, cutoff)
    # An independent prototype, to the digits that it printed.
    assert found["work_of_adhesion"] == pytest.approx(adhesion, abs=6e-6)
    assert found["equilibrium_distance"] == pytest.approx(3.280e-10, abs=1e-14)
    assert found["peak_distance"] == pytest.approx(3.741e-10, abs=1e-13)
    assert found["peak_tensile_stress"] == pytest.approx(3.980e9, rel=1e-3)
    # The largest attraction of s¹¹ − s⁵ is at s⁶ = 5/11; discrete sites and the cutoff change a few per cent of it.
    largest = 6 / 11 * (5 / 11) ** (5 / 6) * interface_of((13, 13)).force_prefactor
    assert largest / AREA == pytest.approx(3.980e9, rel=0.04)
