"""The block whose springs turn: its first order is the linear block, a turn costs nothing, forces are a gradient."""

import numpy as np
import pytest

import contact_study
from contact_study.study.study import make_study
from md_reference.block.condensed import lame_constants
from md_reference.block.multiscale import MultiscaleBlock, NonlinearSpringBlock
from md_reference.block.nonlinear_slab import rotating_slab_force
from md_reference.block.slab import fill_ghosts, slab_constants, slab_force
from md_reference.study.model import check
from tests.md_reference.systems import LATTICE_CONSTANT, POISSONS_RATIO, YOUNGS_MODULUS
from tests.md_reference.test_dynamics import moving
from tests.md_reference.test_multiscale_block import MASS, free_nodes, random_vector

LAME = lame_constants(YOUNGS_MODULUS, POISSONS_RATIO)
SCALE = LAME[1] * LATTICE_CONSTANT**2  # a spring's force at a stretch of one


def block_of(kind, layers=(3, 2), atoms=(16, 8)):
    return kind(atoms, LATTICE_CONSTANT, *LAME, layers, MASS)


def forces(block, displacement):
    force = np.zeros(block.size)
    block.force(displacement, force)
    return np.where(free_nodes(block), force, 0.0)


def test_first_order_is_the_linear_block():
    """Random strains of every kind: the difference of the forces falls with the square of the strain."""
    errors = []
    for strain in (4e-3, 2e-3, 1e-3):
        one, other = (
            forces(block, strain * LATTICE_CONSTANT * random_vector(block))
            for block in (block_of(MultiscaleBlock), block_of(NonlinearSpringBlock))
        )
        errors.append(np.max(np.abs(one - other)) / SCALE)
        assert np.max(np.abs(one)) / SCALE > strain
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.02)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.01)


def test_a_turn_costs_nothing():
    """All nodes, ghosts too, turned by 30° about a skew axis; the linear cell is strained by that."""
    axis, angle = np.array([1.0, 2.0, -0.5]) / np.sqrt(5.25), np.pi / 6
    cross = np.cross(np.eye(3), axis)
    turn = np.eye(3) + np.sin(angle) * cross.T + (1 - np.cos(angle)) * cross.T @ cross.T
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-15)
    z, y, x = np.meshgrid(*(LATTICE_CONSTANT * np.arange(n) for n in (4, 7, 6)), indexing="ij")
    position = np.stack([x, y, z])
    u = np.einsum("cd,dkji->ckji", turn - np.eye(3), position)
    found, linear = np.zeros_like(u), np.zeros_like(u)
    energy = rotating_slab_force(u, found, LATTICE_CONSTANT, LAME[1], LAME[0] - LAME[1], 0, u.shape[2] - 2)
    slab_force(u, linear, *slab_constants(LATTICE_CONSTANT, *LAME), 0, u.shape[2] - 2)
    inside = np.s_[:, :, 1:-1, 1:-1]
    # Rounding of the displacements, over a spring's length.
    assert np.max(np.abs(found[inside])) < 1e-13 * SCALE
    assert energy < 1e-24 * SCALE * LATTICE_CONSTANT
    assert np.max(np.abs(linear[inside])) > 0.01 * SCALE


def test_forces_are_the_gradient_of_the_energy():
    """Over both levels and the plane that hangs between them, at strains where the block is far from linear."""
    block = block_of(NonlinearSpringBlock)
    at, along = 0.1 * LATTICE_CONSTANT * random_vector(block), LATTICE_CONSTANT * random_vector(block, 1)

    def energy(displacement):
        scratch = np.zeros(block.size)
        block.force(displacement, scratch)
        return block.elastic_energy(displacement, scratch)

    slope = -forces(block, at.copy()) @ along
    errors = [(energy(at + step * along) - energy(at - step * along)) / (2 * step) / slope - 1 for step in (2e-3, 1e-3)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)
    assert abs(errors[1]) < 1e-3
    linear = forces(block_of(MultiscaleBlock), at.copy())
    assert np.max(np.abs(linear - forces(block, at.copy()))) > 0.1 * SCALE


def test_energy_is_a_sum_over_rows():
    """Every spring and every volume belongs to one row, across the periodic edges, too."""
    u = 0.1 * LATTICE_CONSTANT * np.random.default_rng(2).standard_normal((3, 4, 11, 8))
    fill_ghosts(u)
    constants = LATTICE_CONSTANT, LAME[1], LAME[0] - LAME[1]
    force, parts = np.zeros_like(u), np.zeros_like(u)
    energy = rotating_slab_force(u, force, *constants, 0, 9)
    found = [rotating_slab_force(u, parts, *constants, *rows) for rows in ((0, 1), (1, 5), (5, 9))]
    # Rounding of a sum of hundreds of terms.
    assert sum(found) == pytest.approx(energy, rel=1e-13)
    np.testing.assert_array_equal(parts[:, :, 1:-1, 1:-1], force[:, :, 1:-1, 1:-1])
    # The same nodes seen from another row and column on.
    moved = np.roll(u[:, :, 1:-1, 1:-1], (3, 2), axis=(2, 3))
    u[:, :, 1:-1, 1:-1] = moved
    fill_ghosts(u)
    assert rotating_slab_force(u, parts, *constants, 0, 9) == pytest.approx(energy, rel=1e-13)


@pytest.mark.parametrize("pressure", [1e8, 2e10, -5e9])
def test_flat_block_under_pressure(pressure):
    """Strained along z alone, the forces on the plane on top are the pressure, and the energy that of the block."""
    block = block_of(NonlinearSpringBlock)
    area = 16 * 8 * LATTICE_CONSTANT**2
    strain = -pressure / (LAME[0] + 2 * LAME[1])
    for _ in range(30):  # Newton's method with the modulus at rest
        nodes = np.zeros(block.size)
        floor = 0.0
        for level, u in zip(block.levels, block.levels_of(nodes), strict=True):
            edge = level.size * LATTICE_CONSTANT
            u[2] = strain * (floor + edge * np.arange(level.shape[1]))[:, None, None]
            floor += edge * (level.shape[1] - 1)
        force = np.zeros(block.size)
        block.force(nodes, force)
        found = np.sum(block.top_of(force)[2]) / area
        strain -= (pressure - found) / (LAME[0] + 2 * LAME[1])
    assert found == pytest.approx(pressure, rel=1e-9)
    assert block.elastic_energy(nodes, force) / area == pytest.approx(block.compression_energy(nodes), rel=1e-9)
    linear = block_of(MultiscaleBlock).compression_energy(nodes)
    assert linear == pytest.approx(block.compression_energy(nodes), rel=abs(strain))
    assert linear != pytest.approx(block.compression_energy(nodes), rel=0.05 * abs(strain))


def test_a_study_takes_it():
    """On its way down, nearly the same motion: what the rotation adds is of the second order."""
    gaps = []
    for block in ("isotropic", "nonlinear_springs"):
        study = moving(
            surface={"rms_height": "0.3 angstrom"},
            atomistic={"block": block},
            dynamics={"duration": "4 ps", "frames": 2},
        )
        with pytest.warns(UserWarning, match="converge"):
            gaps.append(contact_study.run(study, "atomistic").mean_gap.item())
    assert 1e-6 < abs(gaps[0] / gaps[1] - 1) < 1e-2


def test_only_dynamics_has_it():
    with pytest.raises(ValueError, match=r'atomistic\.block = "nonlinear_springs".*"dynamics"'):
        check(make_study(moving(atomistic={"block": "nonlinear_springs", "method": "quasi_static"})).cases[0])
