import numpy as np
import pytest
from scipy import optimize

from md_reference.statics.curvature import raise_curvature
from md_reference.statics.step_limiter import DEFAULTS, limit_step, repulsive_root
from tests.md_reference.systems import LENGTH, interface_of, rough_coefficients

PREFACTOR = 2e-9
SHAPE = (1, 60)


def law(distance):
    s = LENGTH / distance
    return PREFACTOR * (s**11 - s**5)


def landed(distance, step, cosine=1.0, after=None, force=None):
    """Distance along the normal where an atom ends that a Newton step moves by ``step`` along it."""
    after = cosine if after is None else after
    gap = np.full(SHAPE, distance / cosine)
    trial_gap = np.full(SHAPE, 0.0) + (distance + np.broadcast_to(step, SHAPE)) / after
    height = trial_gap.copy()
    forces = np.full(SHAPE, cosine**2 * law(distance) if force is None else force)
    limit_step(
        gap,
        np.full(SHAPE, cosine),
        forces,
        LENGTH,
        PREFACTOR,
        DEFAULTS,
        trial_gap,
        np.full(SHAPE, after),
        height,
    )
    np.testing.assert_array_equal(height, trial_gap)  # what the gap is corrected by, the height is
    return trial_gap[0] * after


@pytest.mark.parametrize("guess", [0.5, 1.0, 1.2, 3.0])
@pytest.mark.parametrize("force", [0.0, 1e-6, 0.3, 2.0, 50.0, 1e4])
def test_root_of_the_repulsion(force, guess):
    s = repulsive_root(force, guess)
    assert s >= 1
    assert s**11 - s**5 == pytest.approx(force, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("cosine", [1.0, 0.8])
@pytest.mark.parametrize("distance", [0.85, 0.99, 1.05, 1.5])
def test_a_short_step_is_taken_as_it_is(distance, cosine):
    # To first order: the error falls with the square of the step.
    before = distance * LENGTH
    errors = [abs(landed(before, sign * h * LENGTH, cosine)[0] - before - sign * h * LENGTH)
              for h in (1e-3, 5e-4) for sign in (1, -1)]  # fmt: skip
    assert max(errors[2:]) <= max(0.3 * max(errors[:2]), 1e-12 * LENGTH)


@pytest.mark.parametrize("cosine", [1.0, 0.8])
def test_a_repelled_atom_moves_to_the_force_that_newton_foresees(cosine):
    before = 0.95 * LENGTH
    slope = (law(before * 1.00001) - law(before * 0.99999)) / (0.00002 * before)
    steps = np.linspace(-0.3, 0.005, SHAPE[1]) * LENGTH
    wanted = law(before) + slope * steps
    np.testing.assert_allclose(law(landed(before, steps, cosine)), wanted, rtol=1e-6)


def test_a_repelled_atom_that_comes_free_goes_no_further_than_the_tangent():
    # Far beyond balance: two fifths of r0 from contact.
    freed = landed(0.95 * LENGTH, 3 * LENGTH)
    np.testing.assert_allclose(freed, 1.4 * LENGTH, rtol=1e-12)


def test_an_attracted_atom_lands_softly():
    steps = np.linspace(-0.35, -0.6, SHAPE[1]) * LENGTH
    ends = landed(1.3 * LENGTH, steps)
    deepest = LENGTH * optimize.brentq(lambda d: law(d * LENGTH) / PREFACTOR - 0.126, 0.9, 1.0)
    assert ends.min() / deepest == pytest.approx(1, rel=1e-9)
    # On a slope contact is at r0 along the normal, not at the vertical gap r0.
    np.testing.assert_allclose(landed(1.3 * LENGTH, steps, 0.8), ends, rtol=1e-12)
    # No distance changes by more than two fifths.
    np.testing.assert_allclose(landed(3 * LENGTH, -2.9 * LENGTH), 1.8 * LENGTH)
    np.testing.assert_allclose(landed(3 * LENGTH, 2.9 * LENGTH), 4.2 * LENGTH)
    # Attracted although closer than r0, as over a hollow: from where it is, as softly.
    held = landed(0.98 * LENGTH, -0.3 * LENGTH, force=-1e-10)
    np.testing.assert_allclose(held, 0.98 * deepest, rtol=1e-9)


def test_sliding_to_another_height_is_part_of_the_step():
    # The surface tilts under the moved atom: distance counts along the new normal.
    end = landed(1.5 * LENGTH, 0.1 * LENGTH, cosine=1.0, after=0.9)
    np.testing.assert_allclose(end, 1.6 * LENGTH, rtol=1e-12)


def curved(hessian, gradient_z, gap, cosine=1.0, fading=0.0):
    shape = (1, 1)
    gradient = np.zeros((3, *shape))
    gradient[2] = gradient_z
    given = np.reshape(hessian, (6, *shape)).astype(float)
    diagonal = np.empty((6, *shape), np.float32)
    raise_curvature(
        given,
        gradient,
        np.full(shape, gap),
        np.full(shape, cosine),
        fading,
        LENGTH,
        DEFAULTS.smallest_distance,
        diagonal,
    )
    return diagonal[:, 0, 0]


def test_springs_of_attracted_atoms_end_at_their_goal():
    attracted = [0.1, 0.2, -0.3, 0.01, 0.02, 0.03]
    force = 1e-10
    # Drawn to contact, r0 along the normal: 1.5 r0 / 0.8 off.
    drawn = curved(attracted, force, 2 * LENGTH, 0.8)
    lift = force / ((2 - 1 / 0.8) * LENGTH)
    np.testing.assert_allclose(drawn, attracted + np.array([lift, lift, lift, 0, 0, 0]), rtol=1e-6)
    away = curved(attracted, -force, 2 * LENGTH, 0.8)
    np.testing.assert_allclose(away[2], -0.3 + force / (2 * LENGTH), rtol=1e-6)
    close = curved(attracted, force, 1.01 * LENGTH)
    np.testing.assert_allclose(close[2], -0.3 + force / (0.03 * LENGTH), rtol=1e-6)
    # In balance, and in repulsion, the Hessian itself.
    np.testing.assert_allclose(curved(attracted, 0.0, 2 * LENGTH), attracted, rtol=1e-6)
    repelled = [0.1, 0.2, 0.3, 0.01, 0.02, 0.03]
    np.testing.assert_allclose(curved(repelled, force, 0.95 * LENGTH), repelled, rtol=1e-6)


@pytest.mark.parametrize("fading", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("zz", [-0.3, 0.05])
def test_fading_takes_its_share_of_the_negative_curvature(fading, zz):
    components = [-0.1, 0.2, zz, 0.05, 0.08, 0.03]

    def lowest(six):
        xx, yy, zz, xy, xz, yz = six
        return np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])[0]

    found = lowest(curved(components, 0.0, 2 * LENGTH, fading=fading))
    assert found == pytest.approx((1 - fading) * lowest(components), abs=1e-7)


def test_prefactor_is_that_of_a_flat_layer():
    atoms = (13, 13)
    interface = interface_of(atoms, None)
    u, force = np.zeros((3, *atoms)), np.empty((3, *atoms))
    for distance in (0.95, 1.2):
        u[2] = distance * LENGTH
        interface.evaluate(u, force)
        s = 1 / distance
        # Discrete sites and the cutoff: a few per cent of the attraction.
        assert np.mean(force[2]) == pytest.approx(interface.force_prefactor * (s**11 - s**5), rel=0.04)


def test_cosine_of_the_tilt_is_that_of_the_surface():
    interface = interface_of((40, 40), rough_coefficients(modes=3, rms=2e-10))
    u = np.random.default_rng(0).uniform(-3e-10, 3e-10, (3, 40, 40))
    gap, cosine = interface.gap_and_cosine(u)
    np.testing.assert_array_equal(gap, interface.gap(u))
    h = 1e-13
    slopes = []
    for component in (0, 1):
        ahead, behind = u.copy(), u.copy()
        ahead[component] += h
        behind[component] -= h
        slopes.append((interface.gap(behind) - interface.gap(ahead)) / (2 * h))
    # The difference quotient of a cubic: h² over the square of its spacing, and rounding of heights over h.
    np.testing.assert_allclose(cosine, 1 / np.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2), rtol=1e-6)
    assert cosine.min() < 0.95
