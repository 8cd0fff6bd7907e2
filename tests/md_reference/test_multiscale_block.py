import numpy as np
import pytest
from scipy.sparse.linalg import LinearOperator, cg

from md_reference.block.condensed import lame_constants
from md_reference.block.multiscale import MultiscaleBlock, level_layers
from tests.md_reference.systems import ELEMENT, LATTICE_CONSTANT, POISSONS_RATIO, YOUNGS_MODULUS, stiffness_of

MASS = 3.27e-25
LAME = lame_constants(YOUNGS_MODULUS, POISSONS_RATIO)


def block_of(atoms, layers):
    return MultiscaleBlock(atoms, LATTICE_CONSTANT, *LAME, layers, MASS)


def free_nodes(block):
    return block.mass > 0


def random_vector(block, seed=0):
    vector = np.random.default_rng(seed).standard_normal(block.size)
    return np.where(free_nodes(block), vector, 0.0)


def stiffness_times(block, vector):
    """K u on the nodes that move, for a rigid plane at rest."""
    force = np.zeros(block.size)
    block.force(vector.copy(), force)
    return np.where(free_nodes(block), -force, 0.0)


def surface_response(block, wave):
    """Bottom displacement under a cosine of normal forces, the interior in balance."""
    load = np.zeros(block.size)
    block.bottom_of(load)[2] = wave
    operator = LinearOperator((block.size,) * 2, matvec=lambda u: stiffness_times(block, u))
    diagonal = np.zeros(block.size)
    for level, nodes in zip(block.levels, block.levels_of(diagonal), strict=True):
        nodes[...] = 1 / (level.size * LATTICE_CONSTANT * LAME[1])
    preconditioner = LinearOperator((block.size,) * 2, matvec=lambda r: diagonal * r)
    found, info = cg(operator, load, rtol=1e-9, maxiter=3000, M=preconditioner)
    assert info == 0
    return block.bottom_of(found)


@pytest.mark.parametrize(
    ("atoms", "layers", "counts"),
    [
        ((400, 400), 400, (12, 8, 9, 8, 17)),
        ((400, 400), 412, (12, 8, 8, 8, 18)),
        ((200, 200), 200, (12, 8, 9, 17)),
        ((64, 48), 64, (12, 8, 8, 0)),
        ((24, 24), 24, (12, 6)),
        ((25, 24), 30, (30,)),
        ((32, 32), 8, (8,)),
    ],
)
def test_levels_are_as_thick_as_the_block(atoms, layers, counts):
    found = level_layers(atoms, layers)
    assert sum(count * 2**level for level, count in enumerate(found)) == layers
    if counts[-1]:
        assert found == counts
    assert all(n % 2 ** (len(found) - 1) == 0 for n in atoms)


def test_forces_are_those_of_the_element():
    """Cell by cell from the 24 × 24 matrix, on a random displacement of a slab."""
    block = block_of((4, 6), (3,))
    u = np.random.default_rng(1).standard_normal(block.size)
    force = np.zeros(block.size)
    block.force(u, force)
    nodes = block.levels_of(u)[0][:, :, 1:-1, 1:-1]
    expected = np.zeros(nodes.shape)
    for k in range(3):
        for j in range(4):
            for i in range(6):
                corners = [(k + z, (j + y) % 4, (i + x) % 6) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
                local = np.concatenate([nodes[:, *corner] for corner in corners])
                for n, corner in enumerate(corners):
                    expected[:, *corner] -= (ELEMENT @ local)[3 * n : 3 * n + 3]
    found = block.levels_of(force)[0][:, :, 1:-1, 1:-1]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14 * np.max(np.abs(expected)))


def test_uniform_block_condenses_to_the_surface_stiffness():
    """One level of nodes against S(q) by doubling: the same block by two algorithms."""
    block, stiffness = block_of((8, 8), (8,)), stiffness_of((8, 8), 8)
    x = 2 * np.pi * np.arange(8) / 8
    wave = np.cos(x + 0.3)[None, :] * np.ones(8)[:, None]
    bottom = surface_response(block, wave)
    compliance = 2 * np.vdot(bottom[2], wave) / 64
    assert 1 / (compliance * LATTICE_CONSTANT**2) == pytest.approx(stiffness.normal_stiffness[0, 1], rel=1e-7)


def test_coarse_levels_keep_the_modulus():
    """E*(q) of the coarsened block against all layers, within the 0.4 % of layers as few as these."""
    atoms = (32, 32)
    counts = level_layers(atoms, 32)
    assert counts == (12, 8, 1)
    block = block_of(atoms, counts)
    full = stiffness_of(atoms, 32)
    x = 2 * np.pi * np.arange(32) / 32
    for mode in (1, 3, 8):
        wave = np.cos(mode * x)[None, :] * np.ones(32)[:, None]
        bottom = surface_response(block, wave)
        modulus = 1 / (LATTICE_CONSTANT**2 * 2 * np.vdot(bottom[2], wave) / 32**2)
        assert modulus == pytest.approx(full.normal_stiffness[0, mode], rel=5e-3)


def test_hanging_nodes_leave_the_stiffness_symmetric():
    block = block_of((16, 16), (2, 2, 2))
    u, v = random_vector(block, 1), random_vector(block, 2)
    one, other = np.vdot(v, stiffness_times(block, u)), np.vdot(u, stiffness_times(block, v))
    assert one == pytest.approx(other, rel=1e-12)


def test_uniform_strain_and_rigid_motion_are_exact_across_levels():
    """A displacement linear in height: every level has the same stress, and no node feels a force but at the faces."""
    block = block_of((16, 16), (2, 2, 2))
    u, force = np.zeros(block.size), np.zeros(block.size)
    base = 0
    for level, nodes in zip(block.levels, block.levels_of(u), strict=True):
        heights = base + level.size * np.arange(nodes.shape[1])
        nodes[2] = 1e-3 * heights[:, None, None] + 5.0
        base = heights[-1]
    block.force(u, force)
    stress = block.top_of(force)[2].sum()
    assert stress < 0
    assert block.bottom_of(force)[2].sum() == pytest.approx(-stress, rel=1e-12)
    block.bottom_of(force)[...] = 0
    block.top_of(force)[...] = 0
    # Springs of the size of the applied stress cancel to their rounding.
    assert np.max(np.abs(block.nodes_of(force))) < 1e-12 * abs(stress)
    # ½ k u² of a bar: M (1e-3)² / 2 per volume, M = λ + 2μ.
    block.force(u, force)
    energy = block.elastic_energy(u, force)
    volume = 14 * 16**2  # cells of a³
    strain = 1e-3 / LATTICE_CONSTANT
    assert energy == pytest.approx(0.5 * (LAME[0] + 2 * LAME[1]) * strain**2 * volume * LATTICE_CONSTANT**3, rel=1e-12)


def test_compression_is_what_planes_do_as_a_whole():
    """Exactly so if they move as a whole, and part of the energy of any displacement."""
    block = block_of((16, 16), (4, 3))
    nodes, force = random_vector(block), np.empty(block.size)
    area = 256 * LATTICE_CONSTANT**2
    block.force(nodes, force)
    assert 0 < block.compression_energy(nodes) < block.elastic_energy(nodes, force) / area
    for level in block.levels_of(nodes):
        level[:2] = 0.0
        level[2] = level[2, :, 1:2, 1:2].copy()
    block.force(nodes, force)
    assert block.compression_energy(nodes) == pytest.approx(block.elastic_energy(nodes, force) / area, rel=1e-9)


def test_nodes_weigh_what_they_stand_for():
    block = block_of((16, 16), (2, 2, 2))
    total = block.mass[: block.size].sum() / 3 + block.top_mass
    # All cells, and half a layer more: the atoms of the surface are whole ones.
    assert total / MASS == pytest.approx((14 + 0.5) * 16**2, rel=1e-12)
    assert np.all(block.bottom_of(block.mass) == MASS)
    assert block.freedoms == 3 * (2 * 16**2 + 2 * 8**2 + 2 * 4**2)
