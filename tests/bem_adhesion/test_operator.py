import numpy as np
import pytest

from bem_adhesion.linear.conjugate_gradients import FourierPreconditioner, LinearisedContact, preconditioner_for
from bem_adhesion.operators import Work, periodic
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import HalfSpace

E_STAR = 93.7348e9
GRIDS = [
    Grid((16, 16), (1e-7, 1e-7)),
    Grid((15, 21), (1e-7, 1.4e-7)),
    Grid((16, 9), (3e-8, 1e-7)),
    Grid((7, 32), (1e-3, 2e-3)),
]


@pytest.mark.parametrize("spring", [0.0, 5e17])
@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid.shape}")
def test_maps_are_those_of_numpys_transform(grid, spring):
    field = np.random.default_rng(1).standard_normal(grid.shape)
    y, x = (2 * np.pi * np.fft.fftfreq(n, step) for n, step in zip(grid.shape, grid.spacing, strict=True))
    stiffness_q = 0.5 * E_STAR * np.hypot(y[:, None], x[None, :])
    stiffness_q[0, 0] = spring
    expected = np.fft.ifft2(stiffness_q * np.fft.fft2(field)).real
    work = Work(grid.points)
    solid = periodic(HalfSpace(E_STAR), spring, work=work)(grid)
    solid.field[...] = field
    total = solid.apply_and_sum(solid.stiffness)
    np.testing.assert_allclose(solid.field, expected, rtol=0, atol=1e-13 * np.abs(expected).max())
    assert total == pytest.approx(np.vdot(field, expected), rel=1e-13)
    bent = field - field.mean()
    np.testing.assert_allclose(solid.apply(solid.compliance), bent, atol=1e-13 * np.abs(bent).max())
    assert work.pairs == 2
    solid.field[...] = expected + 1e18 * field
    np.testing.assert_allclose(solid.apply(solid.inverse_shifted(1e18)), field, atol=1e-13 * np.abs(field).max())


def test_single_precision_counts_half_and_coarser_grids_by_points():
    fine, coarse = Grid((16, 16), (1.0, 1.0)), Grid((8, 8), (1.0, 1.0))
    work = Work(fine.points)
    single = periodic(HalfSpace(1.0), work=work)(coarse, np.float32)
    single.field[...] = np.cos(2 * np.pi * coarse.coordinates[1])
    wave = single.field.copy()
    single.apply(single.compliance)
    np.testing.assert_allclose(single.field, wave / np.pi, atol=1e-6)  # single rounding is 6e-8
    assert work.pairs == 0.5 / 4


def test_largest_stiffness_bounds_every_field_and_is_met_by_one():
    grid = Grid((8, 12), (1.0, 1.0))
    solid = periodic(HalfSpace(2.0))(grid)
    rows, columns = np.indices(grid.shape)
    solid.field[...] = (-1.0) ** (rows + columns)
    assert solid.apply_and_sum(solid.stiffness) / grid.points == pytest.approx(solid.largest, rel=1e-14)
    assert solid.largest == pytest.approx(np.hypot(8, 12) * np.pi, rel=1e-14)
    assert periodic(HalfSpace(2.0), 99.0)(grid).largest == 99.0


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


def test_transforms_of_the_coarser_grids_are_counted():
    work = Work(GRID.points)
    make = periodic(HalfSpace(1.0), 0.3, work=work)
    preconditioner_for(make(GRID, np.float32), make, SHIFT).apply_and_sum()
    # In single precision, and no coarser than 32 points along an axis: one halving here.
    assert work.pairs == 0.5 / 4


def test_conjugate_gradients_need_as_many_iterations():
    rng = np.random.default_rng(1)
    operator = MAKE(GRID, np.float32)
    patches = np.repeat(np.repeat(rng.random((16, 8)), 8, axis=0), 8, axis=1)
    curvature = np.where(patches < 0.3, 3.0, -0.01).astype(np.float32)
    right_side = np.ones(GRID.shape, np.float32)  # a change of the load
    full = LinearisedContact(operator, SHIFT)
    expected = full.solve(right_side, curvature, 1.0, 1e-3, 60)
    halved = LinearisedContact(operator, SHIFT, preconditioner_for(operator, MAKE, SHIFT))
    found = halved.solve(right_side, curvature, 1.0, 1e-3, 60)
    assert not found.negative_curvature
    assert found.iterations <= expected.iterations + 1
    # Both to a residual of 1e-3, over the softest stiffness.
    np.testing.assert_allclose(halved.solution, full.solution, atol=1e-2 * np.abs(full.solution).max())


@pytest.mark.parametrize("shape", [(64, 65), (62, 64), (32, 128)])
def test_grids_that_cannot_be_halved_keep_their_transforms(shape):
    operator = MAKE(Grid(shape, (60.0, 60.0)), np.float32)
    assert isinstance(preconditioner_for(operator, MAKE, SHIFT), FourierPreconditioner)
