"""The block: condensed to its surface, explicit on levels, and with springs that turn."""

import numpy as np
import pytest

from md_reference.block.condensed import CORNERS, effective_contact_modulus
from md_reference.block.multiscale import MultiscaleBlock, NonlinearSpringBlock, level_layers
from tests.md_reference.systems import AREA, E_STAR, ELEMENT, LAME, MASS, POISSON, SPACING, YOUNGS, apply, stiffness_of

SCALE = LAME[1] * SPACING**2  # a spring's force at a stretch of one


def dense_stiffness(element, shape, layers):
    rows, columns = shape
    number = np.arange(3 * (layers + 1) * rows * columns).reshape(layers + 1, rows, columns, 3)
    dense = np.zeros((number.size, number.size))
    for k, j, i in np.ndindex(layers, rows, columns):
        dofs = np.concatenate([number[k + z, (j + y) % rows, (i + x) % columns] for x, y, z in CORNERS])
        np.add.at(dense, (dofs[:, None], dofs[None, :]), element)
    return dense


@pytest.mark.parametrize(("shape", "layers"), [((3, 5), 5), ((4, 2), 1)])
def test_condensation_equals_dense_schur_complement(shape, layers):
    surface, kept = 3 * shape[0] * shape[1], 3 * layers * shape[0] * shape[1]
    dense = dense_stiffness(ELEMENT, shape, layers)[:kept, :kept]  # the top plane is clamped
    inside, coupling = dense[surface:, surface:], dense[surface:, :surface]
    schur = dense[:surface, :surface] - coupling.T @ np.linalg.solve(inside, coupling)
    u = np.random.default_rng(1).standard_normal((*shape, 3))
    expected = (schur @ u.ravel()).reshape(u.shape)
    found = apply(stiffness_of(shape, layers), np.moveaxis(u, -1, 0))
    # Rounding of a well-conditioned elimination.
    np.testing.assert_allclose(np.moveaxis(found, 0, -1), expected, atol=1e-13 * np.abs(expected).max())


def test_element_carries_no_force_in_rigid_motion_and_has_the_isotropic_moduli():
    corners, rng = CORNERS * SPACING, np.random.default_rng(0)
    gradient = rng.standard_normal((3, 3))
    strain, rotation = 0.5 * (gradient + gradient.T), gradient - gradient.T
    rigid = (corners @ rotation.T + rng.standard_normal(3)).ravel()
    assert np.abs(ELEMENT @ rigid).max() < 1e-13 * np.abs(ELEMENT).max() * np.abs(rigid).max()
    uniform = (corners @ gradient.T).ravel()
    first, shear = YOUNGS * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNGS / (2 * (1 + POISSON))
    expected = SPACING**3 * (0.5 * first * np.trace(strain) ** 2 + shear * np.sum(strain**2))
    assert 0.5 * uniform @ ELEMENT @ uniform == pytest.approx(expected, rel=1e-12)
    xx, yy, zz, *others = stiffness_of((2, 2), 7).coefficients[:, 0, 0] * 7 / SPACING
    np.testing.assert_allclose([xx, yy, zz], [shear, shear, first + 2 * shear], rtol=1e-12)
    np.testing.assert_allclose(others, 0, atol=1e-12 * zz)


def test_effective_modulus_is_that_of_the_waves_present():
    stiffness = stiffness_of((24, 36))
    modulus = stiffness.contact_modulus
    wave = np.cos(2 * np.pi * 5 * np.arange(36) / 36)[None, :] * np.ones((24, 1))
    # The transform holds a wave along y twice, one along x once; each weighs by its wavenumber and squared amplitude.
    both = effective_contact_modulus(stiffness, 3 * np.cos(2 * np.pi * 8 * np.arange(24) / 24)[:, None] + 2 * wave)
    along_y, along_x = 9 * 8 / 24, 4 * 5 / 36
    expected = along_y * modulus[8, 0] + along_x * modulus[0, 5]
    assert both == pytest.approx(expected / (along_y + along_x), rel=1e-9)
    flat_surface = effective_contact_modulus(stiffness, np.zeros((24, 36)))
    assert flat_surface == pytest.approx(modulus[0, 1], rel=1e-12)
    assert flat_surface == pytest.approx(E_STAR, rel=0.05)


def block_of(atoms=(16, 16), layers=(2, 2, 2), kind=MultiscaleBlock):
    return kind(atoms, SPACING, *LAME, layers, MASS)


def random_vector(block, seed=0):
    return np.where(block.mass > 0, np.random.default_rng(seed).standard_normal(block.size), 0.0)


def forces(block, vector):
    force = np.zeros(block.size)
    block.force(vector.copy(), force)
    return np.where(block.mass > 0, force, 0.0)


@pytest.mark.parametrize(
    ("atoms", "layers", "counts"),
    [((400, 400), 400, (12, 8, 9, 8, 17)), ((64, 48), 64, None), ((25, 24), 30, (30,)), ((32, 32), 8, (8,))],
)
def test_levels_are_as_thick_as_the_block(atoms, layers, counts):
    found = level_layers(atoms, layers)
    assert found == (counts or found)
    assert sum(count * 2**level for level, count in enumerate(found)) == layers
    assert all(n % 2 ** (len(found) - 1) == 0 for n in atoms)


def test_forces_are_those_of_the_element():
    block = block_of((4, 6), (3,))
    u, force = np.random.default_rng(1).standard_normal(block.size), np.zeros(block.size)
    block.force(u, force)
    nodes, found = (np.moveaxis(block.levels_of(v)[0][:, :, 1:-1, 1:-1], 0, -1) for v in (u, force))
    expected = -dense_stiffness(ELEMENT, (4, 6), 3) @ nodes.ravel()
    np.testing.assert_allclose(found.ravel(), expected, rtol=0, atol=1e-14 * np.max(np.abs(expected)))


def strained(block, strain):
    u, floor = np.zeros(block.size), 0
    for level, nodes in zip(block.levels, block.levels_of(u), strict=True):
        heights = floor + level.size * np.arange(nodes.shape[1])
        nodes[2] = strain * SPACING * heights[:, None, None]
        floor = heights[-1]
    return u


def test_uniform_strain_and_rigid_motion_are_exact_across_levels():
    block = block_of()
    u, v = random_vector(block, 1), random_vector(block, 2)  # hanging nodes leave the stiffness symmetric
    assert np.vdot(v, forces(block, u)) == pytest.approx(np.vdot(u, forces(block, v)), rel=1e-12)
    u, force = strained(block, 1e-3) + 5.0 * SPACING, np.zeros(block.size)
    block.force(u, force)
    stress = block.top_of(force)[2].sum()
    assert stress < 0
    assert block.bottom_of(force)[2].sum() == pytest.approx(-stress, rel=1e-12)
    # ½ k u² of a bar: M (1e-3)² / 2 per volume, M = λ + 2μ, 14 layers of cells.
    expected = 0.5 * (LAME[0] + 2 * LAME[1]) * 1e-6 * 14 * 16**2 * SPACING**3
    assert block.elastic_energy(u, force) == pytest.approx(expected, rel=1e-12)
    block.bottom_of(force)[...] = block.top_of(force)[...] = 0
    # Springs of the size of the applied stress cancel to their rounding.
    assert np.max(np.abs(block.nodes_of(force))) < 1e-12 * abs(stress)

    # Nodes weigh what they stand for.
    assert (block.mass.sum() / 3 + block.top_mass) / MASS == pytest.approx((14 + 0.5) * 16**2, rel=1e-12)
    assert block.total_mass / MASS == pytest.approx((14 + 0.5) * 16**2, rel=1e-12)
    assert np.all(block.bottom_of(block.mass) == MASS)
    assert block.freedoms == 3 * (2 * 16**2 + 2 * 8**2 + 2 * 4**2)


LINEAR, ROTATING = (block_of((16, 8), (3, 2), kind) for kind in (MultiscaleBlock, NonlinearSpringBlock))


@pytest.mark.validation
def test_forces_of_turning_springs_are_the_gradient_of_the_energy():
    at, along = 0.1 * SPACING * random_vector(ROTATING), SPACING * random_vector(ROTATING, 1)

    def energy(displacement):
        scratch = np.zeros(ROTATING.size)
        ROTATING.force(displacement, scratch)
        return ROTATING.elastic_energy(displacement, scratch)

    slope = -forces(ROTATING, at) @ along
    errors = [(energy(at + step * along) - energy(at - step * along)) / (2 * step) / slope - 1 for step in (2e-3, 1e-3)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)
    assert abs(errors[1]) < 1e-3
    assert np.max(np.abs(forces(LINEAR, at) - forces(ROTATING, at))) > 0.1 * SCALE


@pytest.mark.parametrize("pressure", [2e10, -5e9])
def test_flat_block_of_turning_springs_under_pressure(pressure):
    area, force, modulus = 16 * 8 * AREA, np.zeros(ROTATING.size), LAME[0] + 2 * LAME[1]
    strain = -pressure / modulus
    for _ in range(30):  # Newton's method with the modulus at rest
        nodes = strained(ROTATING, strain)
        ROTATING.force(nodes, force)
        found = np.sum(ROTATING.top_of(force)[2]) / area
        strain -= (pressure - found) / modulus
    assert found == pytest.approx(pressure, rel=1e-9)
    compression = ROTATING.compression_energy(nodes)
    assert ROTATING.elastic_energy(nodes, force) / area == pytest.approx(compression, rel=1e-9)
    assert 0.05 * abs(strain) < abs(LINEAR.compression_energy(nodes) / compression - 1) < abs(strain)
