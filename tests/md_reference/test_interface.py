import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from md_reference.interface.pairs import LennardJonesInterface
from md_reference.interface.substrate import Substrate
from tests.md_reference.systems import LATTICE_CONSTANT, LENGTH, WELL_DEPTH, interface_of, rough_coefficients

ATOMS = (7, 10)
SURFACE = rough_coefficients(modes=2, rms=1.0e-10)


@pytest.fixture(scope="module")
def interface():
    return interface_of(ATOMS, SURFACE)


def state_on(interface, seed=0, lateral=20e-10, lowest=0.95, highest=2.5):
    """Atoms anywhere within several lattice constants of their rest positions, above the surface there."""
    rng = np.random.default_rng(seed)
    u = np.zeros((3, *interface.shape))
    u[:2] = rng.uniform(-lateral, lateral, (2, *interface.shape))
    u[2] = -interface.gap(u) + rng.uniform(lowest, highest, interface.shape) * LENGTH
    return u


def pair_sum(interface, u, energy_of_squared_distance):
    """Energy by brute force over all periodic images within three cells."""
    substrate = interface.substrate
    rows, columns = substrate.shape
    j, i = np.meshgrid(np.arange(-3 * rows, 4 * rows), np.arange(-3 * columns, 4 * columns), indexing="ij")
    heights = substrate.heights[j % rows, i % columns]
    total = 0.0
    for iy in range(interface.shape[0]):
        for ix in range(interface.shape[1]):
            dx = ix * interface.spacing[1] + u[0, iy, ix] - i * substrate.spacing[1]
            dy = iy * interface.spacing[0] + u[1, iy, ix] - j * substrate.spacing[0]
            dz = u[2, iy, ix] - heights
            total += np.sum(energy_of_squared_distance(dx**2 + dy**2 + dz**2))
    return total


def switched_pair(s, cutoff=4.0):
    """Pair energy of r², written independently: 1 − 10x³ + 15x⁴ − 6x⁵ between 0.9 r_c and r_c."""
    x = np.clip((s / (cutoff * LENGTH) ** 2 - 0.81) / 0.19, 0, 1)
    t = (LENGTH**2 / s) ** 3
    return 4 * WELL_DEPTH * (t**2 - t) * (1 - 10 * x**3 + 15 * x**4 - 6 * x**5)


def test_energy_is_the_sum_over_all_pairs_within_the_cutoff(interface):
    u = state_on(interface, lateral=5e-10)
    found = interface.evaluate(u, np.empty_like(u))
    assert found == pytest.approx(pair_sum(interface, u, switched_pair), rel=1e-12)


def central_difference(function, u, direction, step):
    return (function(u + step * direction) - function(u - step * direction)) / (2 * step)


def test_force_and_hessian_are_derivatives_to_second_order_of_the_difference(interface):
    u = state_on(interface)
    force, hessian = np.empty_like(u), np.empty((6, *ATOMS))
    interface.evaluate(u, force, hessian)
    direction = np.random.default_rng(1).standard_normal(u.shape)
    x, y, z = direction
    xx, yy, zz, xy, xz, yz = hessian
    image = np.stack([xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z])

    def energy(v):
        return interface.evaluate(v, np.empty_like(v))

    def forces(v):
        out = np.empty_like(v)
        interface.evaluate(v, out)
        return out

    steps = np.array([8e-13, 4e-13, 2e-13])
    slope = -np.sum(force * direction)
    energy_errors = [abs(central_difference(energy, u, direction, h) / slope - 1) for h in steps]
    force_errors = [np.abs(central_difference(forces, u, direction, h) + image).max() for h in steps]
    for errors in (energy_errors, force_errors):
        rates = np.log2(np.array(errors[:-1]) / errors[1:])
        assert np.all((rates > 1.9) & (rates < 2.1))
    assert force_errors[-1] < 1e-3 * np.abs(image).max()


def test_forces_with_and_without_hessian_agree(interface):
    u = state_on(interface, seed=2)
    plain, full = np.empty_like(u), np.empty_like(u)
    energies = interface.evaluate(u, plain), interface.evaluate(u, full, np.empty((6, *ATOMS)))
    assert energies[0] == pytest.approx(energies[1], rel=1e-14)
    np.testing.assert_allclose(plain, full, rtol=0, atol=1e-13 * np.abs(plain).max())


@settings(max_examples=25)
@given(rows=st.integers(-4, 4), columns=st.integers(-4, 4), seed=st.integers(0, 99))
def test_forces_are_periodic_in_the_lateral_position(interface, rows, columns, seed):
    u = state_on(interface, seed)
    moved = u.copy()
    moved[0] += columns * ATOMS[1] * LATTICE_CONSTANT
    moved[1] += rows * ATOMS[0] * LATTICE_CONSTANT
    here, there = np.empty_like(u), np.empty_like(u)
    assert interface.evaluate(moved, there) == pytest.approx(interface.evaluate(u, here), rel=1e-9)
    # Positions of up to 1e-8 m are rounded to 1e-24 m; the steepest atoms change by 1e3 N/m.
    np.testing.assert_allclose(there, here, rtol=0, atol=1e-11 * np.abs(here).max())


@settings(max_examples=25)
@given(rows=st.integers(-20, 20), columns=st.integers(-20, 20))
def test_moving_atoms_and_substrate_together_changes_nothing(rows, columns):
    interface = interface_of(ATOMS, SURFACE)
    substrate = interface.substrate
    rolled = Substrate(np.roll(substrate.heights, (rows, columns), (0, 1)), substrate.spacing)
    other = LennardJonesInterface(rolled, ATOMS, interface.spacing, WELL_DEPTH, LENGTH, 4.0)
    u = state_on(interface, seed=7)
    moved = u.copy()
    moved[0] += columns * substrate.spacing[1]
    moved[1] += rows * substrate.spacing[0]
    here, there = np.empty_like(u), np.empty_like(u)
    assert other.evaluate(moved, there) == pytest.approx(interface.evaluate(u, here), rel=1e-9)
    np.testing.assert_allclose(there, here, rtol=0, atol=1e-11 * np.abs(here).max())
    np.testing.assert_allclose(other.gap(moved), interface.gap(u), atol=1e-22)


def test_mirror_symmetry_of_a_symmetric_system():
    # An even surface under the mirrored state: forces mirror too.
    even = np.cos(2 * np.pi * np.arange(16) / 16)[None, :] * np.ones((11, 1)) * 1e-10
    interface = LennardJonesInterface(
        Substrate(even, (7 * LATTICE_CONSTANT / 11, 10 * LATTICE_CONSTANT / 16)),
        ATOMS,
        (LATTICE_CONSTANT, LATTICE_CONSTANT),
        WELL_DEPTH,
        LENGTH,
        4.0,
    )
    u = state_on(interface, lateral=1e-10)
    mirrored = np.roll(u[:, :, ::-1], 1, axis=2)
    mirrored[0] *= -1
    here, there = np.empty_like(u), np.empty_like(u)
    interface.evaluate(u, here)
    interface.evaluate(mirrored, there)
    expected = np.roll(here[:, :, ::-1], 1, axis=2)
    expected[0] *= -1
    np.testing.assert_allclose(there, expected, atol=1e-11 * np.abs(here).max())


def test_atoms_that_the_skip_map_passes_over_feel_nothing(interface):
    # Just within and just beyond reach of the highest site: never skipped where the exact force is not zero.
    u = np.zeros((3, *ATOMS))
    u[2] = interface.substrate.heights.max() + np.linspace(3.9, 4.05, ATOMS[0] * ATOMS[1]).reshape(ATOMS) * LENGTH
    force = np.empty_like(u)
    energy = interface.evaluate(u, force)
    assert energy == pytest.approx(pair_sum(interface, u, switched_pair), rel=1e-9)
    far = u[2] > interface.substrate.heights.max() + 4 * LENGTH
    assert far.any()
    assert not far.all()
    assert np.all(force[:, far] == 0)


def single_pair(distance):
    """Energy, force and curvature along z of one atom over one site, alone in a wide cell; reduced units."""
    cell = 12 * LENGTH
    site = Substrate(np.zeros((1, 1)), (cell, cell))
    single = LennardJonesInterface(site, (1, 1), (cell, cell), WELL_DEPTH, LENGTH, 4.0)
    u = np.array([0.0, 0.0, distance * LENGTH]).reshape(3, 1, 1)
    force, hessian = np.empty_like(u), np.empty((6, 1, 1))
    energy = single.evaluate(u, force, hessian)
    return np.array([energy, force[2, 0, 0] * LENGTH, hessian[2, 0, 0] * LENGTH**2]) / WELL_DEPTH


@pytest.mark.parametrize("distance", [1.0, 2.5, 3.65, 3.8, 3.95])
def test_one_pair_before_and_within_the_switch(distance):
    energy, force, curvature = single_pair(distance)
    assert energy == pytest.approx(switched_pair((distance * LENGTH) ** 2) / WELL_DEPTH, rel=1e-12)
    step = 1e-5
    above, below = single_pair(distance + step), single_pair(distance - step)
    # Second-order differences: relative step² and rounding / step, both below 1e-7 of the larger derivative.
    assert force == pytest.approx(-(above[0] - below[0]) / (2 * step), rel=1e-6)
    assert curvature == pytest.approx(-(above[1] - below[1]) / (2 * step), rel=1e-6)


def test_the_switch_has_two_continuous_derivatives():
    assert np.all(np.abs(single_pair(3.8)) > 1e-5)
    for end in (3.6, 4.0):
        jumps = [np.abs(single_pair(end + h) - single_pair(end - h)).max() for h in (1e-3, 1e-4, 1e-5)]
        # A continuous function's jump falls with the distance; a step would stay.
        np.testing.assert_allclose(np.array(jumps[:-1]) / jumps[1:], 10, rtol=0.1)


@pytest.mark.parametrize("height", [-1.0, 0.0, 0.2, np.nan, -np.inf])
def test_an_atom_inside_the_substrate_has_infinite_energy(interface, height):
    u = state_on(interface)
    u[2, 3, 4] = -interface.gap(np.array([u[0], u[1], 0 * u[2]]))[3, 4] + height * LENGTH
    assert interface.evaluate(u, np.empty_like(u)) == np.inf


def test_an_atom_with_no_lateral_position_has_infinite_energy(interface):
    for lost in (np.nan, np.inf, 1e3):
        u = state_on(interface)
        u[0, 1, 1] = lost
        assert interface.evaluate(u, np.empty_like(u)) == np.inf
