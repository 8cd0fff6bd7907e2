import numpy as np
import pytest

from bem_adhesion.linear.conjugate_gradients import LinearisedContact
from bem_adhesion.linear.preconditioner import FourierPreconditioner, preconditioner_for
from bem_adhesion.operators.fourier import periodic
from contact_study.numerics.grid import Grid
from contact_study.numerics.multigrid import HalvedInverse
from contact_study.physics.solids import HalfSpace

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
