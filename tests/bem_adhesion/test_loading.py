import tracemalloc
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.fft import irfft2, rfft2

from bem_adhesion.adhesive.contact import AdhesiveContact, reach
from bem_adhesion.adhesive.multigrid import MOST, LocalNewton, MultigridSolver, _largest_of_tiles, find_subdomains
from bem_adhesion.adhesive.newton import NewtonSolver
from bem_adhesion.adhesive.options import NewtonOptions
from bem_adhesion.contacts.rough_contact import contact_between, rough_contact
from bem_adhesion.linear.conjugate_gradients import LinearisedContact, preconditioner_for
from bem_adhesion.operators import Load, Work, periodic
from bem_adhesion.solution import Outcome
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import Exponential, HardWall
from contact_study.physics.process_zone import process_zone
from contact_study.physics.solids import HalfSpace, Layer, Tabulated
from tests.bem_adhesion.paper_system import E_STAR, R0, SIZE, law, relative_contact_area, self_affine, stepped, surface

CLOSE = NewtonOptions().close


def contact_of(the_law, points=64, control="pressure", size=SIZE, **options):
    rough = surface(points, size=size)
    return AdhesiveContact(rough.sampled, rough.grid, E_STAR, the_law, control, **options)


def test_loading_is_hysteretic_and_tension_ends_in_detachment():
    contact = contact_of(law(8.0), 96, size=800e-10)
    there, _, back, pulled, *apart, again = stepped(contact, [0.2e9, 3e9, 0.2e9, -0.5e9, -12e9, 0.0, 0.2e9])
    assert relative_contact_area(back.gap) > relative_contact_area(there.gap) + 0.05
    assert back.gap.mean() < there.gap.mean()
    assert pulled.pressure.mean() == pytest.approx(-0.5e9, abs=1e-8 * E_STAR)
    assert [solution.outcome for solution in apart] == [Outcome.DETACHED, Outcome.APART]
    assert "start the loading path with a positive pressure" in apart[1].message
    for solution in apart:
        assert (solution.detached, solution.converged, solution.pressure.any()) == (True, True, False)
        assert np.all(np.isinf(solution.gap))
    np.testing.assert_array_equal(there.gap, again.gap)


def test_the_separated_block_is_out_of_reach_of_the_law():
    contact = contact_of(law(), 32)
    nearest = (contact.separated() - contact.height).min()
    assert nearest == pytest.approx(reach(contact.law), rel=1e-12)
    # The tension falls with every larger gap, so that nowhere more than a thousandth of the peak acts.
    assert contact.law.traction(nearest) == pytest.approx(1e-3 * contact.law.peak_tensile_stress, rel=1e-4)


def test_a_first_gap_from_separation_is_on_the_separated_branch():
    """A soft sphere of 8 nm radius under the paper's law: it snaps in on approach and holds on in retraction."""
    points, size, radius = 64, 24e-9, 8e-9
    grid = Grid((points, points), (size, size))
    y, x = (axis - size / 2 for axis in grid.coordinates)
    height = -(y[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)
    contact = AdhesiveContact(height - height.mean(), grid, 5e9 / (1 - 0.42**2), law(), "gap")
    gaps = np.arange(10e-9, 5e-9, -0.25e-9)
    approached = stepped(contact, gaps)
    areas = np.array([np.mean(solution.gap < R0 * 2 ** (1 / 6)) for solution in approached])
    snap_in = int(np.argmax(areas > 0))
    retracted = contact.step(approached[snap_in], gaps[snap_in - 1])
    # Just before the snap-in there are two states; the far one is what separation leads to, alone or on a path.
    assert np.mean(retracted.gap < R0 * 2 ** (1 / 6)) > areas[snap_in - 1] == 0
    # Residuals of 1e-8 E* over the softest stiffness.
    alone = stepped(contact, [gaps[snap_in - 1]])[0]
    np.testing.assert_allclose(alone.gap, approached[snap_in - 1].gap, atol=1e-4 * R0)


def test_flat_surfaces_do_not_rest_on_top_of_the_barrier():
    # Held 3 Å above equilibrium, where the law softens, the uniform state is an equilibrium but no minimum.
    grid = Grid((32, 32), (520e-10, 520e-10))
    contact = AdhesiveContact(np.zeros(grid.shape), grid, E_STAR, law(8.0), "gap")
    finest, flat = contact.levels.finest, np.full(grid.shape, (R0 + 3e-10) / R0)
    tension = float(contact._law.traction(flat[0, 0]))
    held = contact._load(-tension - contact._spring * flat[0, 0])
    uniform = finest.evaluate(flat, held)
    assert uniform.largest < 1e-12
    assert finest.evaluate(contact.levels.leave_saddle(flat, held), held).energy < uniform.energy
    found = stepped(contact, [3e-10])[0]
    assert found.outcome is Outcome.CONVERGED
    assert found.elastic_energy + found.interaction_energy < 2 * contact.law.potential(R0 + 3e-10) < 0


def test_saddles_without_end_meet_the_iteration_limit(monkeypatch):
    contact = contact_of(law(), 32, max_iterations=40)
    monkeypatch.setattr(contact.levels, "leave_saddle", lambda gap, load: gap)
    found = stepped(contact, [1e9])[0]
    assert (found.outcome, found.iterations) == (Outcome.ITERATION_LIMIT, 41)


def test_a_state_in_balance_costs_its_residual_and_a_search_for_saddles_on_a_coarser_grid():
    contact = contact_of(law(), 64, size=250e-10)  # the coarser grid has 5.3 points a process zone
    found = contact.step(contact.separated(), 1e9)
    again = contact.step(found, 1e9)
    assert again.iterations == 0
    # One pair; for the search at most eight iterations of two pairs, in single precision on a quarter of the points.
    assert again.fft_pairs <= 1 + 8 * 2 / 2 / 4


@pytest.mark.parametrize("control", ["gap", "approach"])
def test_a_given_displacement_costs_little_more_than_a_given_pressure(control):
    rough = surface(128)
    solid = HalfSpace(E_STAR) if control == "gap" else Layer(E_STAR, 0.3, 0.25 * SIZE)
    by_pressure, held = (
        AdhesiveContact(rough.sampled, rough.grid, solid, law(), kind) for kind in ("pressure", control)
    )
    pressed = stepped(by_pressure, np.array([0.2, 1, 5]) * 1e9)
    top = rough.sampled.max() + by_pressure.law.equilibrium_distance
    planes = [each.displacement.mean() - solid.compression(each.pressure.mean()) for each in pressed]
    targets = [each.mean_gap for each in pressed] if control == "gap" else [top - plane for plane in planes]
    moved = stepped(held, targets)
    for one, other in zip(pressed, moved, strict=True):
        # Residuals of 1e-8 E* over the softest stiffness.
        np.testing.assert_allclose(other.gap, one.gap, atol=1e-6 * R0)
    assert sum(each.fft_pairs for each in moved) < 1.3 * sum(each.fft_pairs for each in pressed)


def test_further_tangent_steps_close_in_within_the_same_limit():
    contact = contact_of(law(), 96, size=800e-10)
    solver, start = contact.levels.finest, contact.step(contact.separated(), 1e9).gap / contact.law.length
    load = contact._load(1.01e9 / contact.elasticity.contact_modulus)
    target = solver.solve(start.copy(), load, 1e-10, 50).gap
    one, three = (solver.follow_tangent(start, load, 0.1, steps) for steps in (1, 3))
    # Each linear solve goes to a tenth of the residual.
    assert np.abs(three - target).max() < 0.1 * np.abs(one - target).max()
    assert solver.follow_tangent(start, load, 1e-9) is start
    # The limit is on the whole way: between the first step's change and the second's there is none after it.
    limit = 0.999 * np.abs(target / start - 1).max()
    assert 0 < np.abs(solver.follow_tangent(start, load, limit, 9) / start - 1).max() < limit


@pytest.mark.parametrize("target", [0.8e9, 1.2e9])
def test_a_prediction_stays_behind_its_load(target, monkeypatch):
    contact, loads = contact_of(law(), 96, size=800e-10), []
    start, coarser = contact.step(contact.separated(), 1e9), contact.levels.coarser
    descend = coarser._descend
    monkeypatch.setattr(coarser, "_descend", lambda gap, load, *rest: loads.append(load) or descend(gap, load, *rest))
    contact.step(start, target)
    assert min(1e9, target) < loads[0].pressure * E_STAR < max(1e9, target)


@pytest.mark.parametrize("change", [-0.1, 0.1])
def test_a_prediction_stays_behind_its_gap(change, monkeypatch):
    contact, loads = contact_of(law(), 96, size=800e-10, control="gap"), []
    start, coarser = contact.step(contact.separated(), 3e-10), contact.levels.coarser
    descend = coarser._descend
    monkeypatch.setattr(coarser, "_descend", lambda gap, load, *rest: loads.append(load) or descend(gap, load, *rest))
    contact.step(start, 3e-10 + change * R0)
    before = float((start.gap[::2, ::2] / R0).mean())
    assert 0 < (loads[0].mean_gap - before) / change < 1


STICKY = Exponential(0.69, 1.74e-10)


def test_a_prediction_touches_where_the_coarse_grid_does():
    contact = contact_of(Exponential(0.1, 1.74e-10), 128)
    grids, load = contact.levels, contact._load(5e9 / E_STAR)
    gap = contact._gap_of(contact.separated())
    grids.finest.press(gap, load)
    touching = grids._predict(grids.coarser, gap, load, 2000, True) == 0
    found = contact.step(contact.separated(), 5e9)
    # The two differ at the edges alone. Where interpolation rounds points off the wall half of the contact is missing.
    assert np.mean(touching) == pytest.approx(np.mean(found.gap == 0), rel=0.1)


def test_points_that_touch_still_touch_in_a_state_that_was_rounded():
    contact = contact_of(STICKY)
    found = contact.step(contact.separated(), 5e9)
    for towards in (-np.inf, np.inf):
        rounded = np.nextafter(found.state, towards)
        np.testing.assert_array_equal(contact.step(rounded, 5e9).gap == 0, found.gap == 0)
        # Touching points are pinned; a last digit is 1e-15 of the gaps.
        assert contact.stiffness(replace(found, state=rounded)) == pytest.approx(contact.stiffness(found), rel=1e-6)
    with pytest.raises(ValueError, match="gaps < 0"):
        contact.step(found.state - 1e-12 * STICKY.length, 5e9)


def test_full_contact_is_met_by_either_control():
    pressed, released = stepped(contact_of(STICKY), [200e9, 5e9])
    np.testing.assert_array_equal(pressed.gap, 0)
    assert 0 < np.mean(released.gap == 0) < 1
    # Almost closed the contact is far stiffer than the spring: a mean gap of 1/1700 of the range.
    almost, closed, opened = stepped(contact_of(STICKY, control="gap"), [1e-13, 0.0, 2e-11])
    assert all(each.converged for each in (released, almost, closed, opened))
    assert almost.gap.mean() == pytest.approx(1e-13, abs=1e-8 * STICKY.length)
    np.testing.assert_array_equal(closed.gap, 0)
    # At the least pressure: one point more would be pulled off.
    assert closed.pressure.min() == pytest.approx(-STICKY.peak_tensile_stress, rel=1e-9)
    assert opened.gap.mean() == pytest.approx(2e-11, abs=0, rel=1e-6)
    assert opened.pressure.mean() < closed.pressure.mean()


def test_a_contact_that_a_wall_carries_at_every_point_opens_again():
    """Nothing is out of balance at its first step but the mean gap."""
    axis = np.cos(2 * np.pi * np.arange(32) / 32)
    waves = rough_contact(3.2e-9 * np.outer(axis, axis), 1.4e-7, 1e9, Exponential(0.045, 3e-9), control="gap")
    open_before, closed, opened = stepped(waves, [1e-9, 0.0, 1e-9])
    assert open_before.converged
    np.testing.assert_array_equal(closed.gap, 0)
    assert opened.converged
    # A long range has one state at each gap; the solver's tolerance of the pressure is 1e-6 of its largest.
    assert opened.pressure.mean() == pytest.approx(open_before.pressure.mean(), abs=1e-6 * closed.pressure.mean())


UNIT = HalfSpace(1.0)


def scaled_problem(points, ratio, seed=1, size=SIZE, pressure=1e9):
    """Grid, law and load in units of r0 and E*, and the gap of the separated state."""
    grid = Grid((points, points), (size / R0, size / R0))
    height = surface(points, seed, size).heights((points, points)) / R0
    stiffness_q = UNIT.stiffness_on(grid)
    load = irfft2(stiffness_q * rfft2(height), s=height.shape) + pressure / E_STAR
    return grid, law(ratio).scaled(R0, E_STAR), load, height.max() + 1 - height


def test_energy_and_gradient_are_those_of_the_discrete_functional(monkeypatch):
    grid, the_law, load, gap = scaled_problem(26, 4.0)
    stiffness_q = UNIT.stiffness_on(grid)
    gap = 1.2 + 0.1 * np.sin(np.random.default_rng(0).standard_normal(gap.shape))
    elastic = irfft2(stiffness_q * rfft2(gap), s=gap.shape)
    energy = np.sum(0.5 * gap * elastic + load * gap + the_law.potential(gap))
    gradient = elastic + the_law.traction(gap) + load
    solver = NewtonSolver(periodic(UNIT), the_law, 0.01, grid)
    state = solver.evaluate(gap, Load(load - 0.01, pressure=0.01))  # a field and a number
    assert state.energy == pytest.approx(energy, rel=1e-13)
    assert state.largest == pytest.approx(np.abs(gradient).max(), rel=1e-12)
    assert state.square == pytest.approx(np.sum(gradient**2), rel=1e-12)
    assert state.total == pytest.approx(gradient.sum(), rel=1e-10)
    np.testing.assert_allclose(solver._right_side, -gradient, atol=1e-6 * np.abs(gradient).max())
    # As heights in another unit the load is K h and its energy is that of the field, block by block.
    monkeypatch.setattr("bem_adhesion.kernels.law.BLOCK", 100)
    height = 4 * np.random.default_rng(1).standard_normal(gap.shape)
    flattening = irfft2(stiffness_q * rfft2(height / 4), s=gap.shape)
    heights = Load.of_heights(solver.solid, height, 0.25)
    by_heights, by_field = solver.evaluate(gap, heights), solver.evaluate(gap, Load(flattening))
    assert heights.energy == pytest.approx(-0.5 * 0.25 * np.vdot(flattening, height), rel=1e-12)
    for one, other in zip(by_heights, by_field, strict=True):
        assert one == pytest.approx(other, rel=1e-10)


def test_linear_solver_against_a_dense_matrix():
    grid, rng = Grid((15, 18), (60.0, 50.0)), np.random.default_rng(2)
    curvature = np.where(rng.random(grid.shape) < 0.3, 2.0, -0.01).astype(np.float32)
    right_side = rng.standard_normal(grid.shape).astype(np.float32)
    units = np.eye(grid.points).reshape(-1, *grid.shape)
    dense = irfft2(UNIT.stiffness_on(grid) * rfft2(units), s=grid.shape) + curvature.astype(float) * units
    expected = np.linalg.solve(dense.reshape(grid.points, -1), right_side.ravel()).reshape(grid.shape)
    solver = LinearisedContact(periodic(UNIT)(grid, np.float32), 0.02)
    result = solver.solve(right_side, curvature, 1.0, 1e-5, 200)
    assert not result.negative_curvature
    assert result.iterations < 60
    # Residual 1e-5 times the condition number of a few tens.
    np.testing.assert_allclose(solver.solution, expected, atol=1e-3 * np.abs(expected).max())
    # With a mean that a uniform stress holds: the same matrix, bordered by ones.
    bordered = np.ones((grid.points + 1, grid.points + 1))
    bordered[:-1, :-1], bordered[-1, -1] = dense.reshape(grid.points, -1), 0.0
    *bent, stress = np.linalg.solve(bordered, np.append(right_side.ravel(), 0.7 * grid.points))
    held = solver.solve(right_side, curvature, 1.0, 1e-5, 200, mean=0.7)
    assert (held.negative_curvature, held.iterations < 60) == (False, True)
    np.testing.assert_allclose(solver.solution.ravel(), bent, atol=1e-3 * np.abs(bent).max())
    assert held.stress == pytest.approx(stress, rel=1e-4)
    # Softer than the half-space holds, which is E* q / 2 = 0.05.
    assert solver.solve(right_side, np.full_like(curvature, -1.0), 1.0, 0.1, 50).negative_curvature


def test_coarse_grids_stop_where_they_cannot_bridge_the_process_zone():
    the_law = law().scaled(R0, E_STAR)
    zone, make = process_zone(1.0, the_law), partial(NewtonSolver, periodic(UNIT), the_law, 0.01)
    level = MultigridSolver(Grid((96, 96), (24 * zone, 12 * zone)), make)
    # Spacing zone/4, then zone/2; at a whole zone there are fewer points than a prediction needs.
    assert level.coarser.finest.grid.shape == (48, 48)
    assert level.coarser.coarser is MultigridSolver(Grid((95, 96), (2 * zone, 2 * zone)), make).coarser is None


def test_not_a_number_is_never_taken_for_a_solution():
    grid, the_law, load, gap = scaled_problem(26, 1.0)
    found = NewtonSolver(periodic(UNIT), the_law, 0.01, grid).solve(gap, Load(np.nan * load), 1e-8, 20)
    assert found.outcome in (Outcome.STALLED, Outcome.ITERATION_LIMIT)


def test_a_residual_by_changes_is_that_of_the_gap_within_what_it_says():
    grid, the_law, field, start = scaled_problem(128, 4.0)
    load, solver = Load(field), NewtonSolver(periodic(UNIT), the_law, 0.02, grid)
    result = solver.solve(start, load, 1e-8, 500)
    assert result.outcome is Outcome.CONVERGED
    # What rounding in float32 may leave in it is a hundredth of the tolerance.
    assert result.residual == pytest.approx(solver.evaluate(result.gap, load).largest, abs=1e-10)
    moved, before = result.gap * (1 + 0.1 * np.random.default_rng(0).random(grid.shape)), solver.solid.field.copy()
    solver._evaluate_change(result.gap, moved, load)
    by_change, said = solver.solid.field.copy(), solver._rounded
    solver.solid.field -= solver.single.field
    scale = solver.solid.largest * np.abs(moved - result.gap).max()
    np.testing.assert_allclose(solver.solid.field, before, rtol=0, atol=1e-15 * scale)  # roundings of float64
    assert 1e-9 * scale < np.abs(by_change - solver.press(moved, load)).max() < said


@pytest.mark.parametrize(("the_law", "most"), [(law(), 10.5), (HardWall(), 10)])
def test_memory_of_a_step_stays_within_so_many_arrays(the_law, most):
    """Numbers in double precision a point beside the heights: solver, state to start from, fields of the solution."""
    height, grid = self_affine(512)

    def solved():
        return stepped(contact_between(height, grid, E_STAR, the_law), [1e9])[0]

    solved()  # compiled and planned
    tracemalloc.start()
    found = solved()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found.converged
    assert peak <= most * height.nbytes


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
    work = Work(shape[0] * shape[1])
    make = periodic(UNIT, 0.3, work=work)
    operator = make(Grid(shape, (120.0, 70.0)), np.float32)
    bed = preconditioner_for(operator, make, 0.02, 1.5)
    bed.apply_and_sum()
    # In single precision, and no coarser than 32 points along an axis: one halving of the first grid, none of others.
    assert work.pairs == (0.5 / 4 if shape == (128, 64) else 0.5)
    if shape == (128, 64):
        patches = np.repeat(np.repeat(np.random.default_rng(1).random((16, 8)), 8, axis=0), 8, axis=1)
        curvature = np.where(patches < 0.3, 3.0, -0.01).astype(np.float32)
        full, coarse = LinearisedContact(operator, 0.02), LinearisedContact(operator, 0.02, bed)
        change = np.ones(shape, np.float32)  # of the load
        expected, found = (each.solve(change, curvature, 1.0, 1e-3, 60) for each in (full, coarse))
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


def flat_contact(spring=0.0):
    return NewtonSolver(periodic(UNIT, spring), SCALED, 0.05, Grid((16, 16), (16.0, 16.0)))


def test_surfaces_far_apart_do_not_come_together_in_small_steps_alone():
    contact = flat_contact()
    start = np.full(contact.grid.shape, 12.0)
    found = contact.solve(start, Load(np.zeros(start.shape), pressure=1e-6), 1e-8, 200)
    assert found.outcome is Outcome.CONVERGED
    # A step along negative curvature is 0.1 of the length, 110 to go: after 50 in a row damped steps go further.
    assert found.iterations < 70


def test_newton_goes_on_from_a_corrected_gap_as_it_starts_from_there():
    """Flat surfaces on a spring 1.5 times as stiff as the law softens: no minimum were it twice as soft."""
    rest = np.full((16, 16), 1.3)
    spring = -1.5 * float(SCALED.stiffness(rest[0, 0]))
    load, near = Load(-SCALED.traction(rest) - spring * rest), rest + 1e-3

    def correct(gap, pressing, load, right_side, out):
        out[...] = near
        return True

    alone, contact = flat_contact(spring).solve(near.copy(), load, 1e-8, 50), flat_contact(spring)
    contact.corrector = SimpleNamespace(correct=correct)
    found = contact.solve(rest + 0.7, load, 1e-8, 50)
    assert found.iterations == alone.iterations == 2
    # The tolerance over the stiffness that is left, a third of the spring's.
    np.testing.assert_allclose(found.gap, rest, atol=1e-8 / (spring / 3))


def test_squares_cover_what_is_out_of_balance_and_are_few():
    tiles, pair, many = np.zeros((3, 32, 32))
    tiles[3, 3], tiles[3, 5], tiles[0, 31], tiles[20, 20] = 1.0, 0.5, 0.9, 0.3
    tiles[10, 10] = 0.1  # less than a fifth of the worst
    corners = find_subdomains(tiles, CLOSE)
    assert len(corners) == 3
    for row, column in [(3, 3), (3, 5), (0, 31), (20, 20)]:
        assert any(1 <= (row - r) % 32 <= 6 and 1 <= (column - c) % 32 <= 6 for r, c in corners)
    assert (20 - corners[2][0]) % 32 in (3, 4)  # alone it is in the middle
    pair[10, 10], pair[10, 15], pair[5, 10] = 1.0, 0.5, 0.5
    assert find_subdomains(pair, CLOSE) == [(4, 9)]  # the one that has all three within its rim
    many[:: 32 // MOST, ::8] = 1.0
    assert find_subdomains(many, CLOSE) is find_subdomains(0.5 * CLOSE * tiles, CLOSE) is None


def test_tiles_of_a_grid_that_they_do_not_divide():
    field = np.zeros((70, 65), np.float32)
    field[69, 64], field[10, 3] = -2.0, 1.0
    expected = np.zeros((35, 33))
    expected[34, 32], expected[5, 1] = 2.0, 1.0
    np.testing.assert_array_equal(_largest_of_tiles(field, (2, 2)), expected)


def test_squares_are_for_periodic_contacts_under_pressure_with_points_enough():
    rough = surface(POINTS)
    table = Tabulated(E_STAR, rough.grid, HalfSpace(E_STAR).stiffness_on(rough.grid))

    def corrector(rough, solid=E_STAR, **options):
        return AdhesiveContact(rough.sampled, rough.grid, solid, law(4.0), **options).levels.finest.corrector

    assert corrector(rough) is not None
    assert corrector(rough, control="gap") is corrector(surface(POINTS // 2)) is corrector(rough, table) is None
