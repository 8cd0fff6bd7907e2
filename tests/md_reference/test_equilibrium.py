"""Equilibria of the bottom layer: minima, gap control, limits, light loads; the scripts that set them by others."""

import numpy as np
import pytest
import tomli_w
import xarray as xr

from md_reference import rough_contact
from md_reference.solution import Outcome
from md_reference.statics.contact import at_mean_gap
from md_reference.statics.energy import BlockEnergy, Load, separated
from md_reference.statics.newton import solve
from research import continuum_against_atoms, two_starts
from tests.bem_adhesion.paper_system import random_heights
from tests.md_reference.systems import (
    AREA,
    E_STAR,
    R0,
    SAMPLED,
    SPACING,
    apply,
    interface_of,
    rough_heights,
    stiffness_of,
    touching,
)


def solver_of(atoms, ratio=1.0, held=False):
    interface = interface_of(atoms, rough_heights(rms=1.2e-10), ratio)
    energy = BlockEnergy(stiffness_of(atoms), interface, E_STAR, held)
    return interface, lambda start, pressure=0.0, most=2000: solve(energy, start, pressure, 1e-8, most)


@pytest.mark.parametrize(("atoms", "ratio"), [((45, 32), 4), ((40, 56), 8)])
def test_forces_balance_on_every_atom_and_the_energy_is_a_minimum(atoms, ratio):
    pressure = 5e8
    interface, solver = solver_of(atoms, ratio)
    found = solver(separated(interface), pressure)
    assert found.outcome is Outcome.CONVERGED
    u, stiffness, nominal = found.displacement, stiffness_of(atoms), AREA * atoms[0] * atoms[1]
    force = np.empty_like(u)
    energy, elastic = interface.evaluate(u, force), apply(stiffness, u, True)
    left = elastic - force
    left[2] += pressure * AREA
    # The solver's tolerance is 1e-8 E*; 1.5 leaves room for another order of summation.
    assert np.abs(left).max() < 1.5e-8 * E_STAR * AREA
    assert np.mean(force[2]) / AREA == pytest.approx(pressure, abs=1e-8 * E_STAR)
    np.testing.assert_allclose([*found.shear_stress, found.pressure], force / AREA, rtol=0, atol=1e-9 * pressure)
    assert found.interaction_energy == pytest.approx(energy / nominal, rel=1e-12)
    assert found.elastic_energy == pytest.approx(0.5 * np.sum(u * elastic) / nominal, rel=1e-9)
    assert np.abs(u[:2]).max() > 0.01 * R0  # the lateral freedom is used

    def total(u):
        interaction = interface.evaluate(u, np.empty_like(u))
        return 0.5 * np.sum(u * apply(stiffness, u, True)) + interaction + pressure * AREA * np.sum(u[2])

    rng = np.random.default_rng(0)
    for size in (1e-3, 1e-2, 5e-2):
        assert total(u + size * R0 * rng.standard_normal((3, *atoms))) > total(u)


def test_gap_control_holds_the_mean_height():
    interface, solver = solver_of((48, 48), 8, True)
    _, free = solver_of((48, 48), 8)

    def held_at(mean_gap):
        start = at_mean_gap(interface, touching(interface), mean_gap)
        found = solver(start)
        assert found.outcome is Outcome.CONVERGED
        assert np.mean(found.displacement[2]) == pytest.approx(np.mean(start[2]), rel=1e-12)
        assert np.mean(found.pressure) < 0  # held apart against attraction
        return found, free(found.displacement, float(np.mean(found.pressure)))

    # The same state is an equilibrium: its softest mode has 0.030 N/m then ...
    assert held_at(0.8e-10)[1].force_evaluations == 1
    # ... and further out −0.021 N/m, which only the held height keeps from closing (both by the full eigenproblem).
    saddle, closed = held_at(1e-10)
    assert closed.outcome is Outcome.CONVERGED
    assert np.mean(closed.displacement[2]) < np.mean(saddle.displacement[2]) - 0.1 * R0


def test_a_start_within_attraction_is_solved_as_fast_as_one_out_of_reach():
    interface, solver = solver_of((32, 32), 8)
    far, near = separated(interface), np.zeros((3, 32, 32))
    most = solver(far, 5e8).force_evaluations
    for lift in (2.0, 3.0):  # nothing touches, and everything is drawn down: jumps into contact are to come
        near[2] = interface.rest_heights().max() + lift * R0
        found = solver(near, 5e8)
        assert found.outcome is Outcome.CONVERGED
        # Measured 12 and 13 of 14; with curvatures left negative 23 and 33.
        assert found.force_evaluations <= most


def test_a_step_too_long_is_shortened_until_the_energy_falls():
    atoms, stiffness = (16, 16), stiffness_of((16, 16))
    energy = BlockEnergy(stiffness, interface_of(atoms), E_STAR, False)
    wave, start = np.zeros((3, *atoms)), separated(energy.interaction)
    wave[2] = 0.1 * R0 * np.cos(2 * np.pi * np.arange(16) / 16)
    start[2] += R0  # out of reach: the energy is that of the wave, a parabola along its amplitude
    state = energy.evaluate(start + wave)
    fraction = energy.search(state, -3 * wave, Load(0.0))
    assert 0 < fraction < 2 / 3  # the whole step would end at -2 of the amplitude, two thirds of it at -1
    before, after = (0.5 * np.sum(u * apply(stiffness, u, True)) for u in (start + wave, state.displacement))
    assert after / before == pytest.approx((1 - 3 * fraction) ** 2, rel=1e-9)  # nothing but rounding


def test_limits_and_impossible_starts_are_reported(monkeypatch):
    interface, solver = solver_of((32, 32), 8)
    start = separated(interface)
    assert solver(start, 1e9, 3).outcome is Outcome.ITERATION_LIMIT
    with pytest.raises(ValueError, match="inside the substrate"):
        solver(start - 20 * R0, 1e9)
    monkeypatch.setattr(BlockEnergy, "leave_saddle", lambda *_: True)
    interface, solver = solver_of((8, 8))
    found = solver(touching(interface), 1e9, 30)
    assert (found.outcome, found.iterations) == (Outcome.ITERATION_LIMIT, 31)


def test_a_balance_found_by_expansion_is_that_of_the_atoms(monkeypatch):
    # Forces on the way may be off by a tenth of the residual: what is returned is evaluated, wherever the solve ends.
    interface, solver = solver_of((40, 40), 4)
    monkeypatch.setattr("md_reference.statics.newton._EXPANSION", 0.1)
    for most, outcome in ((12, Outcome.ITERATION_LIMIT), (2000, Outcome.CONVERGED)):
        found = solver(separated(interface), 1e9, most)
        force = np.empty_like(found.displacement)
        interface.evaluate(found.displacement, force, np.empty((6, 40, 40)))
        np.testing.assert_array_equal(found.pressure, force[2] / AREA)
        assert found.force_evaluations < found.iterations
        assert found.outcome is outcome


@pytest.mark.parametrize(
    ("well_depth", "loads"),
    [(2.98e-21, (1.0, 100.0, 2e3)), (2.98e-23, (1.0, 100.0, 2e3)), (2.98e-21, (1e8, 1e3, -10.0, 1.0))],
)
def test_atoms_carry_a_light_load(well_depth, loads):
    height, given = 4e-10 * random_heights((32, 32), 2.3, 1)[0], (77.2e9, 0.42, well_depth, R0)
    block = rough_contact(height, 32 * SPACING, SPACING, *given, max_iterations=100)
    state = block.separated()
    for load in loads:
        found = block.step(state, load)
        state = found.state if len(loads) == 4 else state
        assert found.converged, found.message
        # Far below tolerance × E*; what may be missing of a load: contact_study.numerics.balance.
        assert found.pressure.mean() == pytest.approx(load, rel=1.01e-5)
        assert found.pressure.max() > load


STUDY = {
    **{name: SAMPLED[name] for name in ("material", "interaction")},
    "surface": {**SAMPLED["surface"], "rms_height": "2 angstrom", "cutoff_mode": 4},
    "loading": {"path": ["0.5 GPa"]},
}


def test_increments_lead_from_continuum_to_atoms(tmp_path):
    (tmp_path / "study.toml").write_text(tomli_w.dumps(STUDY))
    pressures = [str(tmp_path / "study.toml"), "--ratios", "1", "4", "--pressures", "0.5 GPa", "2 GPa"]
    for script in (two_starts, continuum_against_atoms):
        assert script.main([*pressures, "-o", str(tmp_path / f"{script.__name__}.nc")]) == 0
    starts, found = (
        xr.load_dataset(tmp_path / f"{each.__name__}.nc") for each in (two_starts, continuum_against_atoms)
    )
    assert starts["converged"].all()
    # A residual of 1e-8 E* a² over the softest mode, as above.
    assert float(starts["largest_gap_difference"].max()) < 3e-16
    # Over the path: a single late step may take as many from either start.
    assert starts["evaluations_predicted"].sum() < starts["evaluations_own"].sum()
    assert found.sizes == {"well_depth_ratio": 2, "pressure": 2, "model": 8}
    assert found["converged"].all()
    area, gap = found["relative_contact_area"], found["mean_gap"]
    steps = found["relative_contact_area_increment"].sum("model")
    np.testing.assert_allclose(area.sel(model="continuum") + steps, area.sel(model="atoms"), rtol=1e-12)
    # One set of equations, two minimisers: the same state to what a residual of 1e-8 E* leaves of the gap. The
    # continuum's solver has the lattice's own stiffness by then.
    assert float(abs(found["mean_gap_increment"].sel(model="other_minimiser")).max()) < 1e-16
    assert not found["relative_contact_area_increment"].sel(model="other_minimiser").any()
    assert (gap.sel(model="tilted_law") > gap.sel(model="lattice_stiffness")).all()
    assert (gap.sel(model="atoms") < gap.sel(model="pair_sums")).all()
    assert (found["measured_work_of_adhesion"] < found["work_of_adhesion"]).all()
