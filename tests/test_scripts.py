"""What the scripts compute whose tables the documentation's check does not run from the start."""

import itertools
import re
from argparse import Namespace

import numpy as np
import pandas as pd
import pytest

import contact_study
from contact_study.physics import process_zone
from contact_study.study.case import realise
from contact_study.study.study import make_study
from research import (
    contact_challenge,
    edge_flow_convergence,
    edge_flow_ensemble,
    edge_flow_kernels,
    edge_flow_trials,
    gap_distributions,
    non_adhesive_shelf,
    persson_choices,
    trapped_edges,
    two_starts_with_adhesion,
)
from scripts import validate_spheres, validate_waves
from tests.bem_adhesion.paper_system import study_table
from theory import LennardJones104, PerssonTheory, SelfAffineSpectrum, edge_flow
from theory import references as reference


@pytest.mark.validation
def test_trials_start_from_the_edge_flow_and_part_from_it():
    spectrum = SelfAffineSpectrum(0.8, 1e-9, 6.04e7, 1.81e8, 7.25e8)
    flow = edge_flow(spectrum, 93.7e9, LennardJones104(2.77, 3.28e-10), highest_pressure=2e9, gaps=60, scales=16)
    state = next(one for one in flow.equilibria if one.gap < 3)
    near = flow._problem.gaps < 1.12

    def area(**change):
        problem = edge_flow_trials.TrialProblem(flow._problem, edge_flow_trials.Trial("", **change))
        found, _ = problem.solve(state.gap, state.response)
        assert found.change < 1e-3
        return float(found.weights[near].sum())

    own = float(state.weights[near].sum())
    # The trial's sweeps stop at a change of 1e-5, the edge flow's at 1e-6.
    assert area() == pytest.approx(own, rel=1e-4)
    assert area(phase=True) != pytest.approx(own, rel=1e-2)
    assert area(branch="loading") < 0.97 * own < 1.03 * own < area(branch="unloading")


@pytest.mark.validation
@pytest.mark.filterwarnings("ignore")  # coarse grids are quick; what they miss is not the point
def test_a_setting_goes_in_and_back(monkeypatch):
    monkeypatch.setattr(edge_flow_ensemble, "PRESSURES", (0.5, 5.0))
    monkeypatch.setitem(edge_flow_ensemble.SETTINGS, "H = 0.5", (edge_flow_ensemble.SETTINGS["H = 0.5"][0], [4.0]))
    table = edge_flow_ensemble.ensemble(Namespace(surfaces=2, points=32, settings=["H = 0.5"]))
    assert (table["surfaces"] == 2).all()
    chosen = table[(table["model"] == "continuum") & (table["quantity"] == "relative_contact_area")]
    at = chosen.pivot_table(index="pressure_GPa", columns="branch", values="mean")
    # The turning point is one state; contact is left no earlier than it is made.
    assert at.loc[5.0, "loading"] == at.loc[5.0, "unloading"]
    assert at.loc[0.5, "unloading"] >= at.loc[0.5, "loading"]


@pytest.mark.validation
def test_shelf_of_theories_without_adhesion_on_small_surfaces(capsys):
    assert non_adhesive_shelf.main(["--surfaces", "2", "--points", "64"]) == 0
    rows = [row.replace("−", "-").split(" | ") for row in capsys.readouterr().out.splitlines()[2:]]
    errors = {tuple(row[:2]): [float(cell.split(" %")[0]) for cell in row[4:]] for row in rows}
    # At 5 GPa the plain theory has a fifth too little area, its corrections some per cent too much.
    plain, *corrected, paper = errors["| 5", "A"]
    assert -30 < plain == paper < -10
    assert all(abs(error) < 8 for error in corrected)
    # Its contact is also too stiff under heavy load and has too much area under high stress; the paper's weight of the
    # energy mends the stiffness alone. Both surfaces scatter by some per cent.
    assert errors["| 10", "-dp/dū"][0] > 30 > 15 > abs(errors["| 10", "-dp/dū"][-1])
    assert 5 < errors["| 2", "A(σ > s)"][0] == errors["| 2", "A(σ > s)"][-1] < 20


def test_convergence_of_the_edge_flow(capsys):
    assert edge_flow_convergence.main(["data/yang2008_quick.toml", "--finest", "120"]) == 0
    areas = [float(row.split(" | ")[2]) for row in capsys.readouterr().out.splitlines()[2:]]
    assert len(areas) == 3
    assert areas == sorted(areas)
    assert edge_flow_convergence.order([9.0, 1.16, 1.04, 1.01]) == "2.0"  # errors of 0.16, 0.04 and 0.01


def test_spheres_against_closed_forms(capsys):
    """Two spheres, coarse: the search leaves 0.1 %, the grid less than 1 %."""
    assert validate_spheres.main(["maugis", "--tabor", "0.1", "0.5"]) == 0
    for row, tabor in zip(capsys.readouterr().out.splitlines()[2:], (0.1, 0.5), strict=True):
        pull_off = reference.maugis_dugdale_pull_off(reference.maugis_parameter(tabor**3 / 0.02**2, 1.0, 0.02, 0.02))
        cells = [float(cell.strip(" %")) for cell in row.replace("²", "").split("|")[1:-1]]
        assert cells[0] == tabor
        assert cells[6] == pytest.approx(pull_off, abs=6e-4)  # three digits
        assert max(abs(cells[7]), abs(cells[8]) / 2, abs(cells[9]) / 0.02) < 1


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_the_contact_mechanics_challenge(tmp_path, capsys):
    asked = ["--size", "2 um", "--table", str(tmp_path / "table.csv"), "--pressures", "1 MPa", "4 MPa"]
    assert contact_challenge.main([*asked, "--points", "48", "96"]) == 0
    head, _, _, _, *rows, _, _, _, warning = capsys.readouterr().out.splitlines()
    assert warning.startswith("The process zone has 0.1 of the finest spacing")
    assert "rms slope 1.000" in head
    split = [[cell.strip() for cell in row.split("|")[1:-1]] for row in rows]
    cells = {(pressure, name): values for pressure, name, *values in split}
    for pressure in ("1000", "4000"):
        coarse, fine, limit = map(float, cells[pressure, "A/A₀"][:3])
        # First order: as far beyond the finer grid as that is from the coarser one.
        assert limit == pytest.approx(2 * fine - coarse, abs=2e-3 * fine)  # four digits
    assert float(cells["4000", "A/A₀"][1]) > float(cells["1000", "A/A₀"][1])
    assert float(cells["4000", "ū (µm)"][1]) < float(cells["1000", "ū (µm)"][1])


@pytest.mark.validation
def test_slow_motion_and_one_step_part_where_the_grid_is_coarser_than_the_process_zone(tmp_path, capsys):
    asked = ["--points", "24", "--seeds", "1", "--laws", "exponential", "-o", str(tmp_path / "states.csv")]
    assert trapped_edges.main([*asked, "--ratios", "0.2", "2", "--figure", str(tmp_path / "figure.png")]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert rows[3].endswith("| = |")
    assert float(re.search(r"\| (\S+) %, ", rows[2])[1]) > 5
    assert rows[-1].startswith("- exponential, 24²: the same states from 2 on")


def test_gap_distributions_against_the_wall():
    table = gap_distributions.ensemble(Namespace(surfaces=1, points=32))
    found = table.set_index(["model", "pressure_GPa", "distance_angstrom"])["mean"]
    assert found["continuum"].groupby("pressure_GPa").is_monotonic_increasing.all()
    for model in gap_distributions.MODELS[1:]:
        # One coarse surface: the theories are of its spectrum, within a third where most gaps are.
        assert found[model, 1.0, 10.0] == pytest.approx(found["continuum", 1.0, 10.0], rel=0.33), model


def test_kernels_of_the_edge_flow_are_those_of_the_mean_over_directions():
    found = edge_flow_kernels.kernels()
    assert found["the edge flow's"] == (0.25, 0.0, 4.0)
    p = np.array([1e-2, 2.0])
    for words, curvature in (("c = 0", 0.0), ("c = K", 1.0), ("c = 1000 K", 1e3)):
        own, exact = edge_flow_kernels.rational(p, found[words]), edge_flow_kernels.exact(p, curvature)
        assert own[1] == pytest.approx(exact[1], rel=1e-9)
        assert own[0] == pytest.approx(exact[0], abs=10 * p[0] ** 4)  # of fourth order, the growth itself is of second
    # A wave without a law: <|q + p|> for p = q is 4/π.
    assert float(edge_flow_kernels.exact(1.0, 1e6)) == pytest.approx(4 / np.pi, rel=1e-5)


def test_what_slow_loading_loses_is_what_the_table_says():
    table = pd.read_csv(contact_challenge.TRAPPED_EDGES)
    assert pytest.approx(trapped_edges.less(table).max(), abs=0.005) == process_zone.LESS_CONTACT


def test_choices_of_perssons_theory():
    """The default choice is the theory's own state; the best one is named."""
    study = study_table(32, surface={"roll_off_mode": 2, "cutoff_mode": 6, "rms_height": 5e-10, "size": 2e-8})
    study["interaction"] = {"law": "lennard_jones_10_4", "work_of_adhesion": 0.05, "length": "0.5 nm"}
    dataset = contact_study.run({**study, "sweep": {"interaction.well_depth_ratio": [1]}})
    (choices,) = persson_choices.scan(dataset).values()
    assert len(choices) == 4 * 4 * 3 * 2
    case = make_study(study).cases[0]
    theory = PerssonTheory(realise(case).measured_spectrum(), case.solid, case.law.work_of_adhesion)
    expected = abs(theory.at_pressure(1e9).relative_contact_area / dataset.relative_contact_area.item() - 1)
    default = next(one for one in choices if (one.alpha, one.beta, one.true_area, one.capped) == (1, 0.4, "persson", 0))
    assert default.deviation == pytest.approx(expected, rel=1e-12)
    best = min(choices, key=lambda one: one.deviation)
    assert f"α = {best.alpha:g}, β = {best.beta:g}, area {best.true_area}" in persson_choices.table({1.0: choices})


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_two_starts_under_adhesion_are_in_balance_and_approach_goes_further(capsys):
    assert two_starts_with_adhesion.main(["--points", "128"]) == 0
    rows = [line.strip("| ").split(" | ") for line in capsys.readouterr().out.splitlines()[2:]]
    assert [row[2] for row in rows] == ["separation", "the hard wall"]
    approach, pressed = ([float(cell) for cell in row[3:]] for row in rows)
    for area, bare, _, residual, _ in (approach, pressed):
        assert area > 1.1 * bare
        assert residual < 1e-8
    assert approach[0] > pressed[0]


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_adhesive_wave_converges_to_johnson_s():
    errors = [validate_waves.adhesive_wave_errors(zone) for zone in validate_waves.ZONES[:3]]
    for zone, each in zip(validate_waves.ZONES[:3], errors, strict=True):
        # Johnson's edge lies within the process zone on either side of the contact, never inside the contact.
        assert np.all(each[:, 0] < 0)
        assert np.all(each[:, 0] > -2 * zone)
    area, gap = np.array([validate_waves.root_mean_square(each) for each in errors]).T
    # Measured on four zones 0.6 (counted in points, eight to a zone) and 1.0: the energy of an edge goes with its zone.
    assert validate_waves.order(validate_waves.ZONES[:3], area) > 0.4
    assert validate_waves.order(validate_waves.ZONES[:3], gap) > 0.8
    assert gap[-1] < 5e-4


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_adhesive_crossed_waves_converge(monkeypatch):
    monkeypatch.setattr(validate_waves, "POINTS_PER_ZONE", 4)
    states = [validate_waves.adhesive_crossed_states(zone) for zone in validate_waves.ZONES[:3]]
    one, two = (validate_waves.root_mean_square(fine - coarse) for coarse, fine in itertools.pairwise(states))
    # Half of the zone, half of the difference: 0.75 for the area counted in points.
    assert np.all(two < 0.85 * one)
    assert two[1] < 0.65 * one[1]


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_crossed_waves_open_where_the_hollow_reaches_the_greatest_tension():
    # Exact: a hollow lies on a point of the grid, and of full contact the pressure is the linear one.
    expected, closed, opened = validate_waves.opening_pressures(32, validate_waves.ZONES[0])
    assert opened < expected < closed
    assert closed - opened < 2.1e-3  # the pressures that are tried
