import numpy as np
import pytest

from md_reference.interface.cached import CachedInterface
from tests.md_reference.systems import CONTACT_MODULUS, LATTICE_CONSTANT, LENGTH, interface_of, rough_coefficients

ATOMS = (30, 40)
SCALE = CONTACT_MODULUS * LATTICE_CONSTANT**2
ROUGH = interface_of(ATOMS, rough_coefficients(modes=2, rms=2e-10))


def state_at(distances):
    """Atoms at given heights above the surface (r0), a little off their rest positions."""
    u = np.zeros((3, *ATOMS))
    u[:2] = np.random.default_rng(0).uniform(-1e-10, 1e-10, (2, *ATOMS))
    u[2] = -ROUGH.gap(u) + distances * LENGTH
    return u


def moves(size, seed=1):
    """Of random direction, up to ``size`` r0 long."""
    rng = np.random.default_rng(seed)
    direction = rng.standard_normal((3, *ATOMS))
    return size * LENGTH * rng.uniform(0, 1, ATOMS) * direction / np.linalg.norm(direction, axis=0)


@pytest.mark.parametrize(
    ("error", "size"),
    [(1e-6, 0.09), (1e-4, 0.003), (1e-4, 0.03), (1e-4, 0.3), (1e-2, 0.003), (1e-2, 0.03), (1e-2, 0.3)],
)
def test_forces_are_within_the_error_allowed(error, size):
    distances = np.random.default_rng(2).uniform(0.9, 4.2, ATOMS)
    start = state_at(distances)
    followed = CachedInterface(ROUGH, ATOMS)
    force, exact, hessian = np.empty_like(start), np.empty_like(start), np.empty((6, *ATOMS))
    assert followed.evaluate(start, force) == pytest.approx(ROUGH.evaluate(start, exact, hessian), rel=1e-12)
    np.testing.assert_array_equal(force, exact)
    np.testing.assert_array_equal(followed.hessian, hessian.astype(np.float32))
    assert followed.evaluations == 1
    step = moves(size)
    energy = followed.evaluate(start + step, force, error * SCALE)
    # The bound of T leaves room for its growth on the way: measured, 0.42 of the error at most. The next term of the
    # energy is a third of the force's, times the way, of either sign: measured, 7e-4 of the bound at most.
    off = np.linalg.norm(force - _exact(start + step, exact), axis=0)
    assert off.max() <= error * SCALE
    assert off.max() > 1e-3 * error * SCALE  # it is used
    left = np.linalg.norm(step, axis=0)[off > 0].max()
    assert left <= 0.1 * LENGTH
    assert abs(energy - ROUGH.evaluate(start + step, exact)) <= 3e-3 * error * SCALE * left * np.count_nonzero(off)
    share = followed.evaluations - 1
    assert np.count_nonzero(off) == pytest.approx((1 - share) * off.size, abs=0.03 * off.size)  # some are out of reach
    assert 0.0 < share < 1.0 or size == 0.003


def _exact(u, out):
    ROUGH.evaluate(u, out, np.empty((6, *ATOMS)))  # the sums without second derivatives round differently
    return out


def _followed_from_start():
    start = state_at(np.full(ATOMS, 1.1))
    followed = CachedInterface(ROUGH, ATOMS)
    force, exact = np.empty_like(start), np.empty_like(start)
    followed.evaluate(start, force)
    return start, followed, force, exact


def test_without_an_error_allowed_only_atoms_that_stood_are_left():
    start, followed, force, exact = _followed_from_start()
    there = start.copy()
    there[2, :3] += 1e-6 * LENGTH
    followed.evaluate(there, force)
    np.testing.assert_array_equal(force, _exact(there, exact))
    assert followed.evaluations == pytest.approx(1 + 3 / ATOMS[0])
    followed.forget()
    followed.evaluate(there, force)
    assert followed.evaluations == pytest.approx(2 + 3 / ATOMS[0])


def test_an_atom_inside_the_substrate_is_no_place_to_follow_from():
    start, followed, force, exact = _followed_from_start()
    inside = start.copy()
    inside[2, 4, 5] -= LENGTH
    assert followed.evaluate(inside, force, 1e-3 * SCALE) == np.inf
    assert followed.evaluate(inside, force, 1e-3 * SCALE) == np.inf
    followed.evaluate(start, force, 1e-3 * SCALE)
    np.testing.assert_array_equal(force, _exact(start, exact))
