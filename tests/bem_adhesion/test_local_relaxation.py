from functools import partial

import numpy as np
import pytest

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.adhesive.local_newton import MOST, LocalNewton, _largest_of_tiles, find_subdomains
from bem_adhesion.adhesive.newton import CLOSE, NewtonSolver
from bem_adhesion.operators import Load, Work, periodic
from bem_adhesion.solution import Outcome
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import HalfSpace, Tabulated
from tests.bem_adhesion.paper_system import E_STAR, law, relative_contact_area, stepped, surface

UNIT = HalfSpace(1.0)
POINTS = 256
SCALED = law().scaled(law().length, E_STAR)


def relaxed(start, load):
    grid = Grid((POINTS, POINTS), (POINTS * 0.5, POINTS * 0.5))
    work = Work(grid.points)
    whole, local = (
        NewtonSolver(periodic(UNIT), SCALED, 0.05, grid),
        LocalNewton(grid, partial(NewtonSolver, periodic(UNIT, work=work), SCALED, 0.05)),
    )
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
    largest = _largest_of_tiles(field, (2, 2))
    assert largest.shape == (35, 33)
    assert largest[34, 32] == 2.0
    assert largest[5, 1] == 1.0
    assert largest.sum() == 3.0


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
