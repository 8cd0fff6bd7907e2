import tracemalloc
from functools import partial

import numpy as np
import pytest
from scipy.fft import irfft2, rfft2

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.adhesive.multigrid import MultigridSolver
from bem_adhesion.adhesive.newton import NewtonSolver
from bem_adhesion.contacts.rough_contact import contact_between
from bem_adhesion.linear.conjugate_gradients import LinearisedContact
from bem_adhesion.operators import Load, periodic
from bem_adhesion.solution import Outcome
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import Exponential, HardWall
from contact_study.physics.process_zone import process_zone
from contact_study.physics.solids import HalfSpace
from tests.bem_adhesion.paper_system import E_STAR, R0, SIZE, law, self_affine, stepped, surface

UNIT = HalfSpace(1.0)


def energy_and_gradient(gap, load, stiffness_q, the_law):
    """The discrete functional written independently: SciPy's transforms, the law's plain formulas."""
    elastic = irfft2(stiffness_q * rfft2(gap), s=gap.shape)
    energy = np.sum(0.5 * gap * elastic + load * gap + the_law.potential(gap))
    return energy, elastic + the_law.traction(gap) + load


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
    energy, gradient = energy_and_gradient(gap, load, stiffness_q, the_law)

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
    shape = (15, 18)
    grid = Grid(shape, (60.0, 50.0))
    rng = np.random.default_rng(2)
    points = grid.points
    curvature = np.where(rng.random(shape) < 0.3, 2.0, -0.01).astype(np.float32)
    right_side = rng.standard_normal(shape).astype(np.float32)
    stiffness_q = UNIT.stiffness_on(grid)
    dense = np.array([irfft2(stiffness_q * rfft2(e.reshape(shape)), s=shape).ravel() for e in np.eye(points)])
    dense += np.diag(curvature.ravel().astype(float))
    expected = np.linalg.solve(dense, right_side.ravel()).reshape(shape)
    solver = LinearisedContact(periodic(UNIT)(grid, np.float32), 0.02)
    result = solver.solve(right_side, curvature, 1.0, 1e-5, 200)
    assert not result.negative_curvature
    assert result.iterations < 60
    # Residual 1e-5 times the condition number of a few tens.
    np.testing.assert_allclose(solver.solution, expected, atol=1e-3 * np.abs(expected).max())


def test_linear_solver_finds_negative_curvature():
    grid = Grid((16, 16), (20.0, 20.0))
    curvature = np.full(grid.shape, -1.0, np.float32)  # softer than the half-space holds: E* q / 2 = 0.16
    solver = LinearisedContact(periodic(UNIT)(grid, np.float32), 0.02)
    right_side = np.random.default_rng(0).standard_normal(grid.shape).astype(np.float32)
    assert solver.solve(right_side, curvature, 1.0, 0.1, 50).negative_curvature
    assert not solver.solve(right_side, np.abs(curvature), 1.0, 0.1, 50).negative_curvature


@pytest.mark.parametrize("the_law", [law(), Exponential(0.69, 1.74e-10)])
@pytest.mark.parametrize("fraction", [3.0, -0.9, -0.999, -1.001])
def test_flat_surfaces_stay_uniform_and_part_at_the_peak_of_the_law(the_law, fraction):
    # Stiff enough (half-space against softening) that the flat state is stable up to the peak.
    contact = AdhesiveContact(np.zeros((8, 8)), Grid((8, 8), (4e-9, 4e-9)), E_STAR, the_law)
    solution = contact.step(np.full((8, 8), the_law.equilibrium_distance), fraction * the_law.peak_tensile_stress)
    assert solution.outcome is (Outcome.CONVERGED if fraction > -1 else Outcome.DETACHED)
    if fraction > -1:
        np.testing.assert_allclose(solution.gap, solution.gap[0, 0], rtol=1e-12)
        assert solution.gap[0, 0] <= the_law.peak_distance + (1e-3 if the_law.has_wall else 0) * the_law.length
        assert solution.elastic_energy == pytest.approx(0, abs=1e-9 * the_law.work_of_adhesion)


def test_coarse_grids_stop_where_they_cannot_bridge_the_process_zone():
    the_law = law().scaled(R0, E_STAR)
    zone = process_zone(1.0, the_law)
    assert zone * R0 == pytest.approx(41e-10, rel=0.01)  # 41 Å by hand from the formula
    make = partial(NewtonSolver, periodic(UNIT), the_law, 0.01)
    level = MultigridSolver(Grid((96, 96), (24 * zone, 12 * zone)), make)
    shapes = []
    while level is not None:
        shapes.append(level.finest.grid.shape)
        level = level.coarser
    # Spacing zone/4, then zone/2; at a whole zone there are fewer points than a prediction needs.
    assert shapes == [(96, 96), (48, 48)]
    assert MultigridSolver(Grid((95, 96), (2 * zone, 2 * zone)), make).coarser is None


def test_not_a_number_is_never_taken_for_a_solution():
    grid, the_law, load, gap = scaled_problem(26, 1.0)
    found = NewtonSolver(periodic(UNIT), the_law, 0.01, grid).solve(gap, Load(np.nan * load), 1e-8, 20)
    assert found.outcome in (Outcome.STALLED, Outcome.ITERATION_LIMIT)


def test_a_residual_by_changes_is_that_of_the_gap_within_what_it_says():
    grid, the_law, field, start = scaled_problem(128, 4.0)
    load = Load(field)
    solver = NewtonSolver(periodic(UNIT), the_law, 0.02, grid)
    result = solver.solve(start, load, 1e-8, 500)
    assert result.outcome is Outcome.CONVERGED
    anew = NewtonSolver(periodic(UNIT), the_law, 0.02, grid).evaluate(result.gap, load)
    # What rounding in float32 may leave in it is a hundredth of the tolerance.
    assert result.residual == pytest.approx(anew.largest, abs=1e-10)

    moved = result.gap * (1 + 0.1 * np.random.default_rng(0).random(grid.shape))
    solver.evaluate(result.gap, load)
    before = solver.solid.field.copy()
    solver._evaluate_change(result.gap, moved, load)
    by_change, said = solver.solid.field.copy(), solver._rounded
    solver.solid.field -= solver.single.field
    scale = solver.solid.largest * np.abs(moved - result.gap).max()
    np.testing.assert_allclose(solver.solid.field, before, rtol=0, atol=1e-15 * scale)  # roundings of float64
    error = np.abs(by_change - solver.press(moved, load)).max()
    assert 1e-9 * scale < error < said


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
