"""Limits of a Newton step atom by atom, and the curvature that models attracted atoms."""

import numpy as np
import pytest
from scipy import optimize

from md_reference.statics.atomwise import limit_step, raise_curvature, repulsive_root
from tests.md_reference.systems import LENGTH, matrices_of

PREFACTOR = 2e-9
SHAPE = (1, 60)


def law(distance):
    s = LENGTH / distance
    return PREFACTOR * (s**11 - s**5)


def limited(distance, step, cosine=1.0, after=None, force=None):
    after = cosine if after is None else after
    distance, step = distance * LENGTH, np.broadcast_to(step, SHAPE) * LENGTH
    trial_gap = (distance + step) / after
    height = trial_gap.copy()
    forces = np.full(SHAPE, cosine**2 * law(distance) if force is None else force)
    before = np.full(SHAPE, distance / cosine), np.full(SHAPE, cosine), forces
    limit_step(*before, LENGTH, PREFACTOR, trial_gap, np.full(SHAPE, after), height)
    np.testing.assert_array_equal(height, trial_gap)  # what the gap is corrected by, the height is
    return trial_gap[0] * after / LENGTH


@pytest.mark.parametrize("guess", [0.5, 1.0, 1.2, 3.0])
@pytest.mark.parametrize("force", [0.0, 1e-6, 0.3, 2.0, 50.0, 1e4])
def test_root_of_the_repulsion(force, guess):
    s = repulsive_root(force, guess)
    assert s >= 1
    assert s**11 - s**5 == pytest.approx(force, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("cosine", [1.0, 0.8])
@pytest.mark.parametrize("distance", [0.85, 0.99, 1.05, 1.5])
def test_a_short_step_is_taken_as_it_is(distance, cosine):
    steps = [sign * h for h in (1e-3, 5e-4) for sign in (1, -1)]
    errors = [abs(limited(distance, step, cosine)[0] - distance - step) for step in steps]
    assert max(errors[2:]) <= max(0.3 * max(errors[:2]), 1e-12)


@pytest.mark.parametrize("cosine", [1.0, 0.8])
def test_a_repelled_atom_moves_to_the_force_that_newton_foresees(cosine):
    before = 0.95 * LENGTH
    slope = (law(before * 1.00001) - law(before * 0.99999)) / (0.00002 * before)
    steps = np.linspace(-0.3, 0.005, SHAPE[1])
    wanted = law(before) + slope * steps * LENGTH
    np.testing.assert_allclose(law(limited(0.95, steps, cosine) * LENGTH), wanted, rtol=1e-6)


def test_long_steps_are_limited():
    # A repelled atom that comes free, far beyond balance: two fifths of r0 from contact.
    np.testing.assert_allclose(limited(0.95, 3), 1.4, rtol=1e-12)
    # An attracted one enters repulsion softly.
    steps = np.linspace(-0.35, -0.6, SHAPE[1])
    ends = limited(1.3, steps)
    deepest = optimize.brentq(lambda d: law(d * LENGTH) / PREFACTOR - 0.126, 0.9, 1.0)
    assert ends.min() / deepest == pytest.approx(1, rel=1e-9)
    # On a slope contact is at r0 along the normal, not at the vertical gap r0.
    np.testing.assert_allclose(limited(1.3, steps, 0.8), ends, rtol=1e-12)
    # No distance changes by more than two fifths.
    np.testing.assert_allclose([limited(3, -2.9), limited(3, 2.9)], [SHAPE[1] * [1.8], SHAPE[1] * [4.2]])
    # Attracted although closer than r0, as over a hollow: from where it is, as softly.
    np.testing.assert_allclose(limited(0.98, -0.3, force=-1e-10), 0.98 * deepest, rtol=1e-9)
    # The surface tilts under the moved atom: distance counts along the new normal.
    np.testing.assert_allclose(limited(1.5, 0.1, cosine=1.0, after=0.9), 1.6, rtol=1e-12)


def curved(hessian, gradient_z, gap, cosine=1.0, damping=0.0):
    gradient, diagonal = np.reshape([0, 0, gradient_z], (3, 1, 1)), np.empty((6, 1, 1), np.float32)
    given = np.reshape(hessian, (6, 1, 1)).astype(float), gradient.astype(float)
    at = np.full((1, 1), gap * LENGTH), np.full((1, 1), cosine)
    raise_curvature(*given, *at, damping, LENGTH, diagonal)
    return diagonal[:, 0, 0]


@pytest.mark.parametrize(
    ("zz", "force", "gap", "cosine", "distance"),
    [
        (-0.3, 1e-10, 2, 0.8, 2 - 1 / 0.8),  # drawn to contact, r0 along the normal
        (-0.3, -1e-10, 2, 0.8, 2),  # drawn away
        (-0.3, 1e-10, 1.01, 1.0, 0.03),  # close to contact
        (-0.3, 0.0, 2, 1.0, np.inf),  # in balance, and in repulsion: the Hessian itself
        (0.3, 1e-10, 0.95, 1.0, np.inf),
    ],
)
def test_springs_of_attracted_atoms_end_at_their_goal(zz, force, gap, cosine, distance):
    hessian = np.array([0.1, 0.2, zz, 0.01, 0.02, 0.03])
    lift = abs(force) / (distance * LENGTH) * np.array([1, 1, 1, 0, 0, 0])
    np.testing.assert_allclose(curved(hessian, force, gap, cosine), hessian + lift, rtol=1e-6)


@pytest.mark.parametrize("damping", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("zz", [-0.3, 0.05])
def test_damping_takes_its_share_of_the_negative_curvature(damping, zz):
    components = [-0.1, 0.2, zz, 0.05, 0.08, 0.03]
    found, given = (np.linalg.eigvalsh(matrices_of(six))[0] for six in (
        curved(components, 0.0, 2, damping=damping), components))  # fmt: skip
    assert found == pytest.approx((1 - damping) * given, abs=1e-7)
