import numpy as np
import pytest

from contact_study.numerics.fourier import RealTransform
from contact_study.numerics.grid import Grid
from contact_study.numerics.multigrid import SHORT_WAVES
from md_reference.statics.linear import LinearOptions, LinearSolver
from md_reference.statics.preconditioner import FourierPreconditioner, TwoLevelPreconditioner, preconditioner_for
from tests.md_reference.systems import stiffness_of

SHAPE = (128, 64)


def coefficients_of(shape):
    coefficients = stiffness_of(shape).coefficients.astype(np.float32)
    coefficients[2, 0, 0] = 0
    return coefficients


def beds(shape=SHAPE):
    coefficients = coefficients_of(shape)
    shift = 0.02 * float(coefficients.max())
    return [
        make(RealTransform((3, *shape), np.float32), coefficients, shift)
        for make in (FourierPreconditioner, preconditioner_for)
    ]


def applied(bed, field):
    bed.field[...] = field
    total = bed.apply_and_sum()
    return total, bed.field.astype(float)


@pytest.mark.parametrize("shape", [SHAPE, (132, 68), (130, 66), (128, 70)])
def test_the_halved_bed_is_symmetric_and_knows_its_energy(shape):
    """Also where a coarse layer has Nyquist waves along one axis, along both, or along none."""
    for bed in beds(shape):
        one, other = np.random.default_rng(0).standard_normal((2, 3, *shape))
        energy, of_one = applied(bed, one)
        _, of_other = applied(bed, other)
        # Single precision, sums over 25000 numbers.
        assert energy == pytest.approx(np.vdot(one, of_one), rel=1e-5)
        assert energy > 0
        scale = np.linalg.norm(one) * np.linalg.norm(of_other)
        assert np.vdot(one, of_other) == pytest.approx(np.vdot(other, of_one), abs=1e-6 * scale)
    assert isinstance(bed, TwoLevelPreconditioner)


@pytest.mark.parametrize("mode", [(1, 1), (-1, 1), (2, 0)])
def test_long_waves_meet_the_block_itself(mode):
    """Oblique ones of either sign: what couples the components is odd in the wavevector."""
    y, x = Grid(SHAPE, (2 * np.pi, 2 * np.pi)).coordinates
    phase = mode[0] * y[:, None] + mode[1] * x[None, :]
    wave = np.array([np.cos(phase), 0.5 * np.sin(phase), np.cos(phase + 0.4)])
    exact, found = (applied(bed, wave)[1] for bed in beds())
    for_short_waves = SHORT_WAVES / coefficients_of(SHAPE)[:3].max(axis=(1, 2))
    # Bilinear interpolation and its transpose between 16 points a wave: (1 − (2π/16)²/12)² = 0.974.
    np.testing.assert_allclose(found, exact + for_short_waves[:, None, None] * wave, atol=0.03 * np.abs(exact).max())


@pytest.mark.parametrize("seed", [1, 2])
def test_conjugate_gradients_need_as_many_iterations(seed):
    """Cores and softening tails in patches of a few atoms, tilted, as the edges of an adhesive contact have them."""
    rng = np.random.default_rng(seed)
    stiffness = stiffness_of(SHAPE)
    largest = stiffness.coefficients.max()
    patches = np.repeat(np.repeat(rng.random((16, 8)), 8, axis=0), 8, axis=1)
    tilt = rng.uniform(-0.3, 0.3, (2, *SHAPE))
    x, y, z = np.array([tilt[0], tilt[1], np.ones(SHAPE)]) / np.sqrt(1 + np.sum(tilt**2, axis=0))
    diagonal = np.where(patches < 0.3, 3.0, -0.001) * largest * np.array([x * x, y * y, z * z, x * y, x * z, y * z])
    gradient = np.zeros((3, *SHAPE))
    gradient[2] = 1.0  # a change of the load
    found = []
    for halvings in (0, 2):
        solver = LinearSolver(stiffness, 0.02 * largest, False, options=LinearOptions(halvings=halvings))
        solver.diagonal[...] = diagonal
        found.append(solver.solve(gradient, 1e-3, 60))
        assert not found[-1].indefinite
    exact, halved = found
    assert halved.iterations <= exact.iterations + 2
    # A pair an iteration, and of the bed three pairs of a quarter and a sixteenth at most.
    assert solver.pairs < 1.3 * halved.iterations
    # Both to a residual of 1e-3, over the softest stiffness.
    np.testing.assert_allclose(halved.step, exact.step, atol=2e-2 * np.abs(exact.step).max())


def test_transforms_of_the_coarser_layers_are_counted():
    full, halved = beds()
    for bed in (full, halved):
        bed.apply_and_sum()
    assert halved.pairs == 1 / 4  # no coarser than 32 atoms along an axis: one halving here
    assert full.pairs == 0  # its owner counts them
    _, twice = beds((128, 128))
    twice.apply_and_sum()
    assert twice.pairs == 1 / 16


@pytest.mark.parametrize("shape", [(64, 65), (62, 64), (32, 128)])
def test_layers_that_cannot_be_halved_keep_their_transforms(shape):
    assert isinstance(beds(shape)[1], FourierPreconditioner)
