from functools import partial

import numpy as np
import pytest

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.adhesive.local_newton import MOST, LocalNewton, _largest_of_tiles, find_subdomains
from bem_adhesion.adhesive.newton import CLOSE, NewtonSolver
from bem_adhesion.linear.conjugate_gradients import LinearisedContact, preconditioner_for
from bem_adhesion.operators import Load, Work, periodic
from bem_adhesion.solution import Outcome
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import HalfSpace, Tabulated
from tests.bem_adhesion.paper_system import E_STAR, law, relative_contact_area, stepped, surface

UNIT = HalfSpace(1.0)
MODULUS = 93.7348e9


@pytest.mark.parametrize("spring", [0.0, 5e17])
@pytest.mark.parametrize("shape", [(16, 16), (15, 21), (16, 9)])
def test_maps_are_those_of_numpys_transform(shape, spring):
    grid = Grid(shape, (3e-8, 1e-7))
    field = np.random.default_rng(1).standard_normal(grid.shape)
    y, x = (2 * np.pi * np.fft.fftfreq(n, step) for n, step in zip(grid.shape, grid.spacing, strict=True))
    stiffness_q = 0.5 * MODULUS * np.hypot(y[:, None], x[None, :])
    stiffness_q[0, 0] = spring
    expected = np.fft.ifft2(stiffness_q * np.fft.fft2(field)).real
    work = Work(4 * grid.points)  # counted on a grid of four times the points
    solid, single = (periodic(HalfSpace(MODULUS), spring, work=work)(grid, dtype) for dtype in (np.float64, np.float32))
    assert solid.largest == pytest.approx(stiffness_q.max(), rel=1e-14)
    solid.field[...] = single.field[...] = field
    total = solid.apply_and_sum(solid.stiffness)
    np.testing.assert_allclose(solid.field, expected, rtol=0, atol=1e-13 * np.abs(expected).max())
    assert total == pytest.approx(np.vdot(field, expected), rel=1e-13)
    bent = field - field.mean()
    np.testing.assert_allclose(solid.apply(solid.compliance), bent, atol=1e-13 * np.abs(bent).max())
    assert work.pairs == 2 / 4
    np.testing.assert_allclose(single.apply(single.stiffness), expected, atol=1e-5 * np.abs(expected).max())
    assert work.pairs == 2.5 / 4
    solid.field[...] = expected + 1e18 * field
    np.testing.assert_allclose(solid.apply(solid.inverse_shifted(1e18)), field, atol=1e-13 * np.abs(field).max())


def test_an_interpolated_field_goes_through_the_coarser_one():
    coarse, fine = Grid((12, 20), (1.0, 2.0)), Grid((24, 40), (1.0, 2.0))
    values, work = np.random.default_rng(3).standard_normal(coarse.shape), Work(fine.points)
    make = periodic(UNIT, work=work)  # the spectra of both lie in one memory
    single, under = make(fine, np.float32), make(coarse, np.float32)
    under.field[...] = values
    found = single.interpolate(under)
    assert work.pairs == 0.25 * (1 + 0.25)
    np.testing.assert_allclose(found[::2, ::2], values, atol=1e-5)  # rounding of single precision
    np.testing.assert_allclose(found, fourier.interpolate(values, fine.shape), atol=1e-5)


@pytest.mark.parametrize("shape", [(128, 64), (64, 65), (62, 64), (32, 128)])
def test_conjugate_gradients_need_as_many_iterations_with_a_bed_on_a_coarser_grid(shape):
    rng, work = np.random.default_rng(1), Work(shape[0] * shape[1])
    make = periodic(UNIT, 0.3, work=work)
    operator = make(Grid(shape, (120.0, 70.0)), np.float32)
    bed = preconditioner_for(operator, make, 0.02)
    bed.apply_and_sum()
    # In single precision, and no coarser than 32 points along an axis: one halving of the first grid, none of others.
    halved = shape == (128, 64)
    assert work.pairs == (0.5 / 4 if halved else 0.5)
    if not halved:
        return
    patches = np.repeat(np.repeat(rng.random((16, 8)), 8, axis=0), 8, axis=1)
    curvature = np.where(patches < 0.3, 3.0, -0.01).astype(np.float32)
    right_side = np.ones(shape, np.float32)  # a change of the load
    full, coarse = LinearisedContact(operator, 0.02), LinearisedContact(operator, 0.02, bed)
    expected, found = (each.solve(right_side, curvature, 1.0, 1e-3, 60) for each in (full, coarse))
    assert not found.negative_curvature
    assert found.iterations <= expected.iterations + 1
    # Both to a residual of 1e-3, over the softest stiffness.
    np.testing.assert_allclose(coarse.solution, full.solution, atol=1e-2 * np.abs(full.solution).max())


POINTS = 256
SCALED = law().scaled(law().length, E_STAR)


def relaxed(start, load):
    grid = Grid((POINTS, POINTS), (POINTS * 0.5, POINTS * 0.5))
    work = Work(grid.points)
    whole = NewtonSolver(periodic(UNIT), SCALED, 0.05, grid)
    local = LocalNewton(grid, partial(NewtonSolver, periodic(UNIT, work=work), SCALED, 0.05))
    worst, out = whole.evaluate(start, load).largest, np.empty_like(start)
    assert local.correct(start, whole.solid.field.copy(), load, whole._right_side, out)
    assert 0 < work.pairs < 2  # some ten pairs on a sixteenth of the points
    return whole, worst, out


@pytest.mark.parametrize("place", [(0, 3), (130, 85)])  # one of them around the corner of the cell
def test_a_place_out_of_balance_relaxes_as_in_the_whole(place):
    y, x = np.indices((POINTS, POINTS))
    away = [np.minimum((i - at) % POINTS, (at - i) % POINTS) for i, at in zip((y, x), place, strict=True)]
    start = np.full(y.shape, 1.0)  # flat surfaces at the law's equilibrium
    load = Load(-SCALED.traction(start) + 0.05 * np.exp(-(away[0] ** 2 + away[1] ** 2) / 50.0))
    whole, worst, out = relaxed(start, load)
    assert worst == pytest.approx(0.05)
    expected = whole.solve(start.copy(), load, 1e-10, 50).gap
    # Equilibrium of the square is to CLOSE, a fiftieth of the load.
    assert np.abs(out - expected).max() < 2 * CLOSE / 0.05 * np.abs(expected - start).max()
    beyond = (away[0] > 44) | (away[1] > 44)  # a square has 64 points, and the bump is in its middle part
    assert not (out != start)[beyond].any()
    assert whole.evaluate(out, load).largest < 1.2 * CLOSE


def test_the_rim_stays_where_nothing_else_holds_it():
    start = np.full((POINTS, POINTS), SCALED.peak_distance)  # there the law has no stiffness
    push = np.zeros(start.shape)
    push[120:128, 120:128] = 0.02
    change = np.abs(relaxed(start, Load(push - SCALED.traction(start)))[2] - start)
    rows = np.flatnonzero(change.any(axis=1))
    # A spring as stiff as the shortest wave lets through what the pressure at the rim is over its K, (8/32)³ of 0.02.
    assert change[rows[[0, -1]]].max() < 0.02 * change.max()


def test_springs_that_hold_the_rim_leave_negative_curvature_to_the_descent():
    contact = NewtonSolver(periodic(UNIT), SCALED, 0.05, Grid((32, 32), (16.0, 16.0)))
    start = np.full(contact.grid.shape, 1.3)  # beyond the peak: balanced, but for a push, and unstable
    load = Load(-SCALED.traction(start), pressure=1e-4)
    for stalls, outcome in [(True, Outcome.STALLED), (False, Outcome.CONVERGED)]:
        contact.set_anchor_springs(np.full(contact.grid.shape, 1e-3), start, stalls)
        assert contact.solve(start.copy(), load, 1e-8, 100).outcome is outcome


def test_squares_cover_what_is_out_of_balance_and_are_few():
    tiles = np.zeros((32, 32))
    tiles[3, 3], tiles[3, 5], tiles[0, 31], tiles[20, 20] = 1.0, 0.5, 0.9, 0.3
    tiles[10, 10] = 0.1  # less than a fifth of the worst
    corners = find_subdomains(tiles)
    assert len(corners) == 3
    for row, column in [(3, 3), (3, 5), (0, 31), (20, 20)]:
        assert any(1 <= (row - r) % 32 <= 6 and 1 <= (column - c) % 32 <= 6 for r, c in corners)
    assert (20 - corners[2][0]) % 32 in (3, 4)  # alone it is in the middle
    pair = np.zeros((32, 32))
    pair[10, 10], pair[10, 15], pair[5, 10] = 1.0, 0.5, 0.5
    assert find_subdomains(pair) == [(4, 9)]  # the one that has all three within its rim
    many = np.zeros((32, 32))
    many[:: 32 // MOST, ::8] = 1.0
    assert find_subdomains(many) is None
    assert find_subdomains(0.5 * CLOSE * tiles) is None


def test_tiles_of_a_grid_that_they_do_not_divide():
    field = np.zeros((70, 65), np.float32)
    field[69, 64], field[10, 3] = -2.0, 1.0
    expected = np.zeros((35, 33))
    expected[34, 32], expected[5, 1] = 2.0, 1.0
    np.testing.assert_array_equal(_largest_of_tiles(field, (2, 2)), expected)


def contact_of(points=POINTS, solid=E_STAR, **options):
    rough = surface(points)
    return AdhesiveContact(rough.sampled, rough.grid, solid, law(4.0), **options)


def test_a_path_with_jumps_takes_fewer_pairs_to_the_same_states():
    relaxing, plain = contact_of(), contact_of()
    assert relaxing.levels.finest.corrector is not None
    plain.levels.finest.corrector = None
    found, expected = (stepped(each, (0.2e9, 0.5e9, 1e9)) for each in (relaxing, plain))
    for one, other in zip(found, expected, strict=True):
        assert one.converged
        assert other.converged
        # The same minima, to 1e-8 of balance.
        assert relative_contact_area(one.gap) == relative_contact_area(other.gap)
    pairs, plain_pairs = (sum(each.fft_pairs for each in path[1:]) for path in (found, expected))
    assert pairs < 0.9 * plain_pairs  # 0.78


def test_squares_are_for_periodic_contacts_under_pressure_with_points_enough():
    grid = surface(POINTS).grid
    table = Tabulated(E_STAR, grid, HalfSpace(E_STAR).stiffness_on(grid))
    for other in (contact_of(control="gap"), contact_of(POINTS // 2), contact_of(solid=table)):
        assert other.levels.finest.corrector is None
