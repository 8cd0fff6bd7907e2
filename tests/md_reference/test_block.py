import numpy as np
import pytest

from md_reference.block.condensed import (
    condense,
    contact_modulus,
    element_matrix,
    isotropic_element,
    surface_stiffness,
    without_lateral_freedom,
)
from tests.md_reference.systems import CONTACT_MODULUS, ELEMENT, LATTICE_CONSTANT, POISSONS_RATIO, YOUNGS_MODULUS


def dense_stiffness(element, shape, layers):
    """Stiffness matrix of an explicit periodic block, free below, its top plane left out (clamped)."""
    rows, columns = shape
    number = np.arange(3 * (layers + 1) * rows * columns).reshape(layers + 1, rows, columns, 3)
    dense = np.zeros((number.size, number.size))
    for k in range(layers):
        for j in range(rows):
            for i in range(columns):
                corners = [
                    number[k + z, (j + y) % rows, (i + x) % columns] for z in (0, 1) for y in (0, 1) for x in (0, 1)
                ]
                dofs = np.concatenate(corners)
                np.add.at(dense, (dofs[:, None], dofs[None, :]), element)
    kept = number[:layers].ravel()
    return dense[np.ix_(kept, kept)]


def apply(stiffness, displacement):
    """S u by the definition in the module: the normal component times i makes the matrix real."""
    u = np.fft.rfft2(displacement)
    u[2] *= 1j
    xx, yy, zz, xy, xz, yz = stiffness.coefficients
    out = np.stack(
        [
            xx * u[0] + xy * u[1] + xz * u[2],
            xy * u[0] + yy * u[1] + yz * u[2],
            xz * u[0] + yz * u[1] + zz * u[2],
        ]
    )
    out[2] *= -1j
    return np.fft.irfft2(out, s=displacement.shape[1:])


@pytest.mark.parametrize(("shape", "layers"), [((4, 4), 3), ((3, 5), 5), ((5, 4), 6), ((4, 2), 1)])
def test_condensation_equals_dense_schur_complement(shape, layers):
    dense = dense_stiffness(ELEMENT, shape, layers)
    surface = 3 * shape[0] * shape[1]
    schur = dense[:surface, :surface]
    if layers > 1:
        interior = np.linalg.solve(dense[surface:, surface:], dense[surface:, :surface])
        schur = schur - dense[:surface, surface:] @ interior
    u = np.random.default_rng(1).standard_normal((*shape, 3))
    expected = (schur @ u.ravel()).reshape(u.shape)
    found = apply(surface_stiffness(ELEMENT, shape, LATTICE_CONSTANT, layers), np.moveaxis(u, -1, 0))
    # Rounding of a well-conditioned elimination.
    np.testing.assert_allclose(np.moveaxis(found, 0, -1), expected, atol=1e-13 * np.abs(expected).max())


def test_element_carries_no_force_in_rigid_motion_and_has_the_isotropic_moduli():
    corners = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]) * LATTICE_CONSTANT
    first = YOUNGS_MODULUS * POISSONS_RATIO / ((1 + POISSONS_RATIO) * (1 - 2 * POISSONS_RATIO))
    shear = YOUNGS_MODULUS / (2 * (1 + POISSONS_RATIO))
    rng = np.random.default_rng(0)
    rotation = rng.standard_normal((3, 3))
    rotation -= rotation.T
    rigid = (corners @ rotation.T + rng.standard_normal(3)).ravel()
    assert np.abs(ELEMENT @ rigid).max() < 1e-13 * np.abs(ELEMENT).max() * np.abs(rigid).max()
    gradient = rng.standard_normal((3, 3))
    strain = 0.5 * (gradient + gradient.T)
    uniform = (corners @ gradient.T).ravel()
    energy = 0.5 * uniform @ ELEMENT @ uniform
    expected = LATTICE_CONSTANT**3 * (0.5 * first * np.trace(strain) ** 2 + shear * np.sum(strain**2))
    assert energy == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("mode", "modulus"), [(1, 1.00040), (3, 0.99987), (12, 0.99921), (40, 0.98865), (100, 0.87122), (200, 0.52212)]
)
def test_contact_modulus_of_the_paper_block(mode, modulus):
    # The reference table used μ = 27.18, λ = 142.73 GPa and E* = 93.7348 GPa, rounded: 1.2e-4 below the exact μ.
    phase = 2 * np.pi * mode / 400
    coefficients = condense(ELEMENT, np.zeros(1), np.array([phase]), 400)
    found = contact_modulus(coefficients, np.array([phase / LATTICE_CONSTANT]), LATTICE_CONSTANT)
    assert found[0] / CONTACT_MODULUS == pytest.approx(modulus, abs=1.5e-4)


def test_long_waves_see_the_contact_modulus_to_second_order():
    # At q times thickness >> 1 the half-space is reached exponentially; what is left is lattice dispersion, ∝ q².
    phase = 2 * np.pi / np.array([50, 100, 200])
    coefficients = condense(ELEMENT, np.zeros(3), phase, 2000)
    error = 1 - contact_modulus(coefficients, phase / LATTICE_CONSTANT, LATTICE_CONSTANT) / CONTACT_MODULUS
    rates = np.log2(error[:-1] / error[1:])
    assert error[0] < 2e-3
    assert np.all((rates > 1.9) & (rates < 2.1))


def test_uniform_compression_and_shear_of_a_thick_block():
    first = YOUNGS_MODULUS * POISSONS_RATIO / ((1 + POISSONS_RATIO) * (1 - 2 * POISSONS_RATIO))
    shear = YOUNGS_MODULUS / (2 * (1 + POISSONS_RATIO))
    xx, yy, zz, xy, xz, yz = condense(ELEMENT, np.zeros(1), np.zeros(1), 7)[:, 0] * 7 / LATTICE_CONSTANT
    np.testing.assert_allclose([xx, yy, zz], [shear, shear, first + 2 * shear], rtol=1e-12)
    np.testing.assert_allclose([xy, xz, yz], 0, atol=1e-12 * zz)


def test_swapping_the_axes_swaps_the_components():
    swap = [1, 0, 2, 3, 5, 4]
    phases = np.random.default_rng(2).uniform(-np.pi, np.pi, (2, 20))
    direct = condense(ELEMENT, phases[0], phases[1], 11)
    np.testing.assert_allclose(condense(ELEMENT, phases[1], phases[0], 11)[swap], direct, atol=1e-12 * direct.max())


def test_unknown_blocks_and_no_layers_are_refused():
    with pytest.raises(ValueError, match="ytp_springs"):
        element_matrix("ytp_springs", LATTICE_CONSTANT, YOUNGS_MODULUS, POISSONS_RATIO)
    with pytest.raises(ValueError, match="at least one layer"):
        condense(ELEMENT, np.zeros(1), np.zeros(1), 0)
    np.testing.assert_array_equal(
        element_matrix("isotropic", LATTICE_CONSTANT, YOUNGS_MODULUS, POISSONS_RATIO),
        isotropic_element(LATTICE_CONSTANT, YOUNGS_MODULUS, POISSONS_RATIO),
    )


def test_a_block_on_rails_keeps_its_normal_compliance():
    block = surface_stiffness(ELEMENT, (12, 16), LATTICE_CONSTANT, 16)
    railed = without_lateral_freedom(block)
    np.testing.assert_allclose(railed.contact_modulus, block.contact_modulus, rtol=1e-12)
    np.testing.assert_allclose(railed.normal_stiffness, block.normal_stiffness, rtol=1e-12)
