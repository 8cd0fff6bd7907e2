import numpy as np
import pytest

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.adhesive.local_newton import MOST, LocalNewton, _largest_of_tiles, find_subdomains
from bem_adhesion.adhesive.newton import NewtonSolver
from bem_adhesion.adhesive.options import NewtonOptions
from bem_adhesion.operators.fourier import periodic
from bem_adhesion.operators.load import Load
from bem_adhesion.solution import Outcome
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import HalfSpace, Tabulated
from tests.bem_adhesion.paper_system import E_STAR, law, relative_contact_area, surface

UNIT = HalfSpace(1.0)
POINTS = 256
CLOSE = NewtonOptions.close


def corners_of(tiles):
    return find_subdomains(tiles, CLOSE)


@pytest.mark.parametrize("place", [(0, 3), (130, 85)])  # one of them around the corner of the cell
def test_a_place_out_of_balance_relaxes_as_in_the_whole(place):
    the_law = law().scaled(law().length, E_STAR)
    grid = Grid((POINTS, POINTS), (POINTS * 0.5, POINTS * 0.5))
    whole = NewtonSolver(grid, periodic(UNIT), the_law, 0.05)
    y, x = np.indices(grid.shape)
    away = [np.minimum((i - at) % POINTS, (at - i) % POINTS) for i, at in zip((y, x), place, strict=True)]
    bump = 0.05 * np.exp(-(away[0] ** 2 + away[1] ** 2) / 50.0)
    start = np.full(grid.shape, 1.0)  # flat surfaces at the law's equilibrium
    load = Load(-the_law.traction(start) + bump)
    assert whole.evaluate(start, load).largest == pytest.approx(0.05)

    local, out = LocalNewton(grid, periodic(UNIT), the_law, 0.05), np.empty_like(start)
    assert local.correct(start, whole.solid.field.copy(), load, whole._right_side, out)
    expected = whole.solve(start, load, 1e-10, 50).gap
    changed = np.abs(expected - start).max()
    # Equilibrium of the square is to CLOSE, a fiftieth of the load.
    assert np.abs(out - expected).max() < 2 * CLOSE / 0.05 * changed
    beyond = (away[0] > 44) | (away[1] > 44)  # a square has 64 points, and the bump is in its middle part
    assert not (out != start)[beyond].any()
    assert whole.evaluate(out, load).largest < 1.2 * CLOSE
    assert 0 < local.solver.equivalent_pairs(grid) < 2  # some ten pairs on a sixteenth of the points


def test_the_rim_stays_where_nothing_else_holds_it():
    the_law = law().scaled(law().length, E_STAR)
    grid = Grid((POINTS, POINTS), (POINTS * 0.5, POINTS * 0.5))
    whole = NewtonSolver(grid, periodic(UNIT), the_law, 0.05)
    start = np.full(grid.shape, the_law.peak_distance)  # there the law has no stiffness
    push = np.zeros(grid.shape)
    push[120:128, 120:128] = 0.02
    load = Load(push - the_law.traction(start))
    whole.evaluate(start, load)
    local, out = LocalNewton(grid, periodic(UNIT), the_law, 0.05), np.empty_like(start)
    assert local.correct(start, whole.solid.field.copy(), load, whole._right_side, out)
    change = np.abs(out - start)
    rows = np.flatnonzero(change.any(axis=1))
    # A spring as stiff as the shortest wave lets through what the pressure at the rim is over its K, (8/32)³ of 0.02.
    assert change[rows[[0, -1]]].max() < 0.02 * change.max()


def test_springs_that_hold_the_rim_leave_negative_curvature_to_the_descent():
    the_law = law().scaled(law().length, E_STAR)
    contact = NewtonSolver(Grid((32, 32), (16.0, 16.0)), periodic(UNIT), the_law, 0.05)
    start = np.full(contact.grid.shape, 1.3)  # beyond the peak: balanced, but for a push, and unstable
    load = Load(-the_law.traction(start), pressure=1e-4)
    for stalls, outcome in [(True, Outcome.STALLED), (False, Outcome.CONVERGED)]:
        contact.set_anchor_springs(np.full(contact.grid.shape, 1e-3), start, stalls)
        assert contact.solve(start, load, 1e-8, 100).outcome is outcome


def test_squares_cover_what_is_out_of_balance_and_are_few():
    tiles = np.zeros((32, 32))
    tiles[3, 3], tiles[3, 5], tiles[0, 31], tiles[20, 20] = 1.0, 0.5, 0.9, 0.3
    tiles[10, 10] = 0.1  # less than a fifth of the worst
    corners = corners_of(tiles)
    assert len(corners) == 3
    for row, column in [(3, 3), (3, 5), (0, 31), (20, 20)]:
        assert any(1 <= (row - r) % 32 <= 6 and 1 <= (column - c) % 32 <= 6 for r, c in corners)
    assert (20 - corners[2][0]) % 32 in (3, 4)  # alone it is in the middle
    pair = np.zeros((32, 32))
    pair[10, 10], pair[10, 15], pair[5, 10] = 1.0, 0.5, 0.5
    assert corners_of(pair) == [(4, 9)]  # the one that has all three within its rim
    many = np.zeros((32, 32))
    many[:: 32 // MOST, ::8] = 1.0
    assert corners_of(many) is None
    assert corners_of(0.5 * CLOSE * tiles) is None


def test_tiles_of_a_grid_that_they_do_not_divide():
    field = np.zeros((70, 65), np.float32)
    field[69, 64], field[10, 3] = -2.0, 1.0
    largest = _largest_of_tiles(field, (2, 2))
    assert largest.shape == (35, 33)
    assert largest[34, 32] == 2.0
    assert largest[5, 1] == 1.0
    assert largest.sum() == 3.0


def test_a_path_with_jumps_takes_fewer_pairs_to_the_same_states():
    def path(relaxing):
        rough = surface(POINTS)
        contact = AdhesiveContact(rough.sampled, rough.grid, E_STAR, law(4.0))
        finest = contact.levels.finest
        assert finest.corrector is not None
        if not relaxing:
            finest.corrector = None
        state, found = contact.separated(), []
        for pressure in (0.2e9, 0.5e9, 1e9):
            found.append(contact.step(state, pressure))
            state = found[-1].state
        assert all(each.converged for each in found)
        return [relative_contact_area(each.gap) for each in found], sum(each.fft_pairs for each in found[1:])

    areas, pairs = path(True)
    plain_areas, plain_pairs = path(False)
    assert areas == plain_areas  # the same minima, to 1e-8 of balance
    assert pairs < 0.9 * plain_pairs  # 0.78


def test_squares_are_for_periodic_contacts_under_pressure_with_points_enough():
    rough = surface(POINTS)
    held = AdhesiveContact(rough.sampled, rough.grid, E_STAR, law(), control="gap")
    assert held.levels.finest.corrector is None
    coarse = surface(POINTS // 2)
    assert AdhesiveContact(coarse.sampled, coarse.grid, E_STAR, law()).levels.finest.corrector is None


def test_a_table_of_the_grids_waves_does_without_squares():
    """Parts of the grid have other waves; on 256² points and more a closed form is relaxed on them."""
    rough = surface(256)
    height, solid = rough.heights(rough.shape), HalfSpace(E_STAR)
    table = Tabulated(E_STAR, rough.grid, solid.stiffness_on(rough.grid))
    whole, plain = (AdhesiveContact(height, rough.grid, one, law(4.0)) for one in (table, solid))
    assert plain.levels.finest.corrector is not None
    assert whole.levels.finest.corrector is None
