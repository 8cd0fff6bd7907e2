import numpy as np
import pytest

from bem_adhesion.linear.conjugate_gradients import LinearisedContact
from bem_adhesion.linear.preconditioner import FourierPreconditioner, preconditioner_for
from bem_adhesion.operators.fourier import PeriodicOperator, periodic
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.numerics.multigrid import HalvedInverse
from contact_study.physics.solids import HalfSpace

E_STAR = 93.7348e9
GRIDS = [
    Grid((16, 16), (1e-7, 1e-7)),
    Grid((15, 21), (1e-7, 1.4e-7)),
    Grid((16, 9), (3e-8, 1e-7)),
    Grid((7, 32), (1e-3, 2e-3)),
]


@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid.shape}")
@pytest.mark.parametrize("mode", [(1, 0), (0, 1), (2, 3), (-3, 2)])
def test_cosine_pressure_gives_cosine_displacement(grid, mode):
    y, x = grid.coordinates
    q_y, q_x = 2 * np.pi * mode[0] / grid.size[0], 2 * np.pi * mode[1] / grid.size[1]
    wave = np.cos(q_y * y[:, None] + q_x * x[None, :] + 0.3)
    solid = PeriodicOperator(grid, HalfSpace(E_STAR))
    solid.field[...] = 1e9 * wave
    expected = 2 * 1e9 / (E_STAR * np.hypot(q_y, q_x))
    # Rounding: a transform of n points loses a few eps * log2(n).
    np.testing.assert_allclose(solid.apply(solid.compliance) / expected, wave, atol=1e-14)
    np.testing.assert_allclose(solid.apply(solid.stiffness) / 1e9, wave, atol=1e-14)
    assert solid.pairs == 2


def test_mean_displacement_feels_only_the_spring():
    grid = GRIDS[1]
    solid = PeriodicOperator(grid, HalfSpace(E_STAR), mean_stiffness=5e17)
    solid.field[...] = 2e-10
    np.testing.assert_allclose(solid.apply(solid.stiffness), 1e8, rtol=1e-13)


def test_shifted_compliance_is_the_inverse_of_half_space_and_springs():
    grid = GRIDS[1]
    solid = PeriodicOperator(grid, HalfSpace(E_STAR))
    product = solid.inverse_shifted(1e18) * (solid.stiffness * grid.points + 1e18) * grid.points
    np.testing.assert_allclose(product, 1.0, rtol=1e-14)
    assert solid.compliance[0, 0] == 0.0


def test_single_precision_counts_half_and_coarser_grids_by_points():
    fine, coarse = Grid((16, 16), (1.0, 1.0)), Grid((8, 8), (1.0, 1.0))
    single = PeriodicOperator(coarse, HalfSpace(1.0), np.float32)
    single.field[...] = np.cos(2 * np.pi * coarse.coordinates[1])
    wave = single.field.copy()
    single.apply(single.compliance)
    np.testing.assert_allclose(single.field, wave / np.pi, atol=1e-6)  # single rounding is 6e-8
    assert single.equivalent_pairs(fine) == 0.5 / 4


@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid.shape}")
def test_sum_on_the_spectrum_is_the_scalar_product(grid):
    field = np.random.default_rng(1).standard_normal(grid.shape)
    solid = PeriodicOperator(grid, HalfSpace(1.0), mean_stiffness=3.0 / grid.size[0])
    solid.field[...] = field
    total = solid.apply_and_sum(solid.stiffness)
    assert total == pytest.approx(np.vdot(field, solid.field), rel=1e-13)


def test_largest_stiffness_bounds_every_field_and_is_met_by_one():
    grid = Grid((8, 12), (1.0, 1.0))
    solid = PeriodicOperator(grid, HalfSpace(2.0))
    rows, columns = np.indices(grid.shape)
    solid.field[...] = (-1.0) ** (rows + columns)
    assert solid.apply_and_sum(solid.stiffness) / grid.points == pytest.approx(solid.largest, rel=1e-14)
    assert solid.largest == pytest.approx(np.hypot(8, 12) * np.pi, rel=1e-14)
    assert PeriodicOperator(grid, HalfSpace(2.0), mean_stiffness=99.0).largest == 99.0


def test_the_operators_of_a_contact_take_turns_in_one_spectrum():
    make, shape = periodic(HalfSpace(2.0)), (24, 18)
    grid = Grid(shape, (1.0, 0.75))
    together = [make(grid, np.float64), make(grid, np.float32), make(grid.with_shape((12, 9)), np.float64)]
    spectra = [operator._transform.spectrum for operator in together]
    assert all(np.shares_memory(spectra[0], spectrum) for spectrum in spectra[1:])
    for operator in together:
        alone = PeriodicOperator(operator.grid, HalfSpace(2.0), operator.field.dtype.type)
        alone.field[...] = operator.field[...] = np.random.default_rng(0).standard_normal(operator.grid.shape)
        np.testing.assert_array_equal(operator.apply(operator.stiffness), alone.apply(alone.stiffness))


@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid.shape}")
def test_kernels_hold_half_of_the_rows_and_are_those_of_all(grid):
    field = np.random.default_rng(2).standard_normal(grid.shape)
    solid = PeriodicOperator(grid, HalfSpace(1.0))
    solid.field[...] = field
    whole = np.fft.irfft2(HalfSpace(1.0).stiffness_on(grid) * np.fft.rfft2(field), s=grid.shape)
    np.testing.assert_allclose(solid.apply(solid.stiffness), whole, rtol=0, atol=1e-13 * np.abs(whole).max())
    assert solid.stiffness.shape[0] == grid.shape[0] // 2 + 1


def test_an_interpolated_field_goes_through_the_coarser_one():
    coarse, fine = Grid((12, 20), (1.0, 2.0)), Grid((24, 40), (1.0, 2.0))
    values = np.random.default_rng(3).standard_normal(coarse.shape)
    make = periodic(HalfSpace(1.0))  # the spectra of both lie in one memory
    single, under = make(fine, np.float32), make(coarse, np.float32)
    under.field[...] = values
    found = single.interpolate(under)
    np.testing.assert_allclose(found[::2, ::2], values, atol=1e-5)  # rounding of single precision
    np.testing.assert_allclose(found, fourier.interpolate(values, fine.shape), atol=1e-5)


SHIFT = 0.02
MAKE = periodic(HalfSpace(1.0), 0.3)
GRID = Grid((128, 64), (120.0, 70.0))


def beds(grid=GRID):
    operator = MAKE(grid, np.float32)
    return FourierPreconditioner(operator, SHIFT), preconditioner_for(operator, MAKE, SHIFT)[0]


def applied(bed, field):
    bed.field[...] = field
    total = bed.apply_and_sum()
    return total, bed.field.astype(float)


def test_the_halved_bed_is_symmetric_and_knows_its_energy():
    _, bed = beds()
    assert isinstance(bed, HalvedInverse)
    one, other = np.random.default_rng(0).standard_normal((2, *GRID.shape))
    energy, of_one = applied(bed, one)
    _, of_other = applied(bed, other)
    # Single precision, sums over 8192 points.
    assert energy == pytest.approx(np.vdot(one, of_one), rel=1e-5)
    assert energy > 0
    assert np.vdot(one, of_other) == pytest.approx(np.vdot(other, of_one), rel=1e-4)


@pytest.mark.parametrize("seed", [1])
def test_conjugate_gradients_need_as_many_iterations(seed):
    """Cores and softening tails in patches of a few points, as the process zone of an adhesive contact has them."""
    rng = np.random.default_rng(seed)
    operator = MAKE(GRID, np.float32)
    patches = np.repeat(np.repeat(rng.random((16, 8)), 8, axis=0), 8, axis=1)
    curvature = np.where(patches < 0.3, 3.0, -0.01).astype(np.float32)
    right_side = np.ones(GRID.shape, np.float32)  # a change of the load
    full = LinearisedContact(operator, SHIFT)
    expected = full.solve(right_side, curvature, 1.0, 1e-3, 60)
    halved = LinearisedContact(operator, SHIFT, preconditioner_for(operator, MAKE, SHIFT)[0])
    found = halved.solve(right_side, curvature, 1.0, 1e-3, 60)
    assert not found.negative_curvature
    assert found.iterations <= expected.iterations + 1
    # Both to a residual of 1e-3, over the softest stiffness.
    np.testing.assert_allclose(halved.solution, full.solution, atol=1e-2 * np.abs(full.solution).max())


def test_transforms_of_the_coarser_grids_are_counted():
    operator = MAKE(GRID, np.float32)
    bed, (coarser,) = preconditioner_for(operator, MAKE, SHIFT)
    bed.apply_and_sum()
    # In single precision, and no coarser than 32 points along an axis: one halving here.
    assert coarser.equivalent_pairs(GRID) == 0.5 / 4
    assert operator.pairs == 0


@pytest.mark.parametrize("shape", [(64, 65), (62, 64), (32, 128)])
def test_grids_that_cannot_be_halved_keep_their_transforms(shape):
    operator = MAKE(Grid(shape, (60.0, 60.0)), np.float32)
    assert isinstance(preconditioner_for(operator, MAKE, SHIFT)[0], FourierPreconditioner)
