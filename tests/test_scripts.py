"""The scripts that write the documentation's tables print what they compute."""

import re
from argparse import Namespace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import contact_study
from contact_study.physics import process_zone
from contact_study.study.case import realise
from contact_study.study.study import make_study, read_study
from research import (
    contact_challenge,
    dmt_limit,
    edge_flow_convergence,
    edge_flow_ensemble,
    edge_flow_kernels,
    edge_flow_trials,
    gap_distributions,
    non_adhesive_shelf,
    persson_choices,
    polymer_contact,
    trapped_edges,
    two_starts_with_adhesion,
)
from scripts import sphere_path, validate_energies, validate_spheres, validate_waves
from theory import LennardJones104, PerssonTheory, SelfAffineSpectrum, criteria, edge_flow, separation_curve
from theory import references as reference

MEANS = ["branch", "model", "quantity", "ratio", "pressure_GPa", "mean", "standard_error", "surfaces", "points"]


def table_of(**models):
    """Means of four surfaces; on the way back twice the mean of the way in."""
    return pd.DataFrame(
        [
            ("H = 0.5", branch, model, name, ratio, p, mean(p) * (1 if branch == "loading" else 2), 0.02, 4, 64)
            for branch in ("loading", "unloading")
            for name in ("relative_contact_area", "mean_gap")
            for ratio in (1.0, 8.0)
            for p in (0.1, 1.0, 5.0)
            for model, mean in models.items()
        ],
        columns=["setting", *MEANS],
    )


def test_errors_of_the_theories_over_an_ensemble():
    flows = {"gap_flow": lambda p: 0.3 if p > 0.1 else 9.0, "edge_flow": lambda p: 0.2 * (1 - 0.1 * p)}
    table = table_of(continuum=lambda p: 0.2, **flows)
    _, *rows = edge_flow_ensemble.rows(table.drop(columns="setting"))
    # The lowest and the highest pressure have lines of their own; 10 and 50 % below count as errors of their size.
    assert rows[0] == "| ≤ 2 ε0 | loading | 0.2 to 5 | A | 50.0 (50.0) % | 30.0 (50.0) % | 10.0 % | 4 |"
    assert rows[4] == "| ≤ 2 ε0 | loading | 0.1 | A | 4400.0 (4400.0) % | 1.0 (1.0) % | 10.0 % | 4 |"
    assert rows[8] == "| ≤ 2 ε0 | loading | 5 | A | 50.0 (50.0) % | 50.0 (50.0) % | 10.0 % | 4 |"
    assert rows[12] == "| ≤ 2 ε0 | unloading | 0.2 to 5 | A | 50.0 (50.0) % | 30.0 (50.0) % | 5.0 % | 4 |"
    _, *rows = edge_flow_ensemble.rows(table)
    assert len(rows) == 8
    assert rows[2].startswith("| H = 0.5 | 8 ε0 | loading | A | ")
    assert rows[5].startswith("| H = 0.5 | 1 ε0 | unloading | ū | ")


def test_trials_start_from_the_edge_flow_and_part_from_it():
    spectrum = SelfAffineSpectrum(0.8, 1e-9, 6.04e7, 1.81e8, 7.25e8)
    flow = edge_flow(spectrum, 93.7e9, LennardJones104(2.77, 3.28e-10), highest_pressure=2e9, gaps=60, scales=16)
    state = next(one for one in flow.equilibria if one.gap < 3)
    near = flow._problem.gaps < 1.12

    def area_and_energy(**change):
        found, _ = edge_flow_trials.TrialProblem(flow._problem, edge_flow_trials.Trial("", **change)).solve(
            state.gap, state.response
        )
        assert found.change < 1e-3
        return float(found.weights[near].sum()), found.elastic

    area, energy = float(state.weights[near].sum()), state.elastic
    # The trial's sweeps stop at a change of 1e-5, the edge flow's at 1e-6.
    assert area_and_energy() == pytest.approx((area, energy), rel=1e-4)
    assert area_and_energy(phase=True)[0] != pytest.approx(area, rel=1e-2)
    approach, retraction = (area_and_energy(branch=branch)[0] for branch in ("loading", "unloading"))
    assert approach < 0.97 * area < 1.03 * area < retraction


def test_errors_of_trials_have_their_sign(capsys, tmp_path, monkeypatch):
    table_of(continuum=lambda p: 1.0).to_csv(tmp_path / "truth.csv", index=False)
    monkeypatch.setattr(edge_flow_trials, "SIMULATIONS", tmp_path / "truth.csv")
    columns = ["model", "ratio", "pressure_GPa", "relative_contact_area", "mean_gap", "pressures", "surfaces"]
    found = [("phase", 8.0, pressure, 1.5, 0.5, 1.2, 2) for pressure in (0.1, 1.0, 5.0)]
    found += [("nothing", 8.0, 1.0, np.nan, np.nan, np.nan, 2)]
    pd.DataFrame(found, columns=columns).to_csv(tmp_path / "found.csv", index=False)
    assert edge_flow_trials.main(["--from", str(tmp_path / "found.csv")]) == 0
    rows = ["| phase | 8 ε0 | +50.0 % | −25.0 % | −50.0 % | −75.0 % | 1.20 |", "| nothing | 8 ε0 | – | – | – | – | – |"]
    assert capsys.readouterr().out.splitlines()[2:] == rows


@pytest.mark.filterwarnings("ignore")  # coarse grids are quick; what they miss is not the point
def test_a_setting_goes_in_and_back(monkeypatch):
    for setting, (_, ratios) in edge_flow_ensemble.SETTINGS.items():
        made = make_study(edge_flow_ensemble.study(2, 32, ratios, setting))
        cutoff = made.cases[0].surface.cutoff_mode
        assert made.cases[0].surface.shape[0] >= (10 * cutoff if cutoff > 12 else 32)
        assert len(made.cases) == 2 * len(ratios)
        assert made.cases[0].loading.unload
    only = {"H = 0.5": (edge_flow_ensemble.SETTINGS["H = 0.5"][0], [4.0])}
    monkeypatch.setattr(edge_flow_ensemble, "PRESSURES", (0.5, 5.0))
    monkeypatch.setattr(edge_flow_ensemble, "SETTINGS", only)
    table = edge_flow_ensemble.ensemble(Namespace(surfaces=2, points=32, settings=["H = 0.5"]))
    assert (table["surfaces"] == 2).all()
    chosen = table[(table["model"] == "continuum") & (table["quantity"] == "relative_contact_area")]
    at = chosen.pivot_table(index="pressure_GPa", columns="branch", values="mean")
    # The turning point is one state; contact is left no earlier than it is made.
    assert at.loc[5.0, "loading"] == at.loc[5.0, "unloading"]
    assert at.loc[0.5, "unloading"] >= at.loc[0.5, "loading"]


def test_shelf_of_theories_without_adhesion_on_small_surfaces(capsys):
    assert non_adhesive_shelf.main(["--surfaces", "2", "--points", "64"]) == 0
    _, _, *rows = capsys.readouterr().out.splitlines()
    assert len(rows) == 5 * len(non_adhesive_shelf.PRESSURES)
    cells = {tuple(row.split(" | ")[:2]): row.replace("−", "-").split(" | ")[4:] for row in rows}

    def errors(*at):
        return [float(cell.split(" %")[0]) for cell in cells[at]]

    # At 5 GPa the plain theory has a fifth too little area, its corrections some per cent too much.
    plain, *corrected, paper = errors("| 5", "A")
    assert -30 < plain == paper < -10
    # Its contact is also too stiff under heavy load and has too much area under high stress; the paper's weight of the
    # energy mends the stiffness alone. Both surfaces scatter by some per cent.
    plain, *_, paper = errors("| 10", "−dp/dū")
    assert plain > 30
    assert -15 < paper < 15
    plain, *_, paper = errors("| 2", "A(σ > s)")
    assert 5 < plain == paper < 20
    assert all(abs(error) < 8 for error in corrected)


def test_convergence_of_the_edge_flow(capsys):
    assert edge_flow_convergence.main(["data/yang2008_quick.toml", "--finest", "120"]) == 0
    areas = [float(row.split(" | ")[2]) for row in capsys.readouterr().out.splitlines()[2:]]
    assert len(areas) == 3
    assert areas == sorted(areas)
    # Errors of 0.16, 0.04 and 0.01: second order; the same values over and over have none.
    assert edge_flow_convergence.order([9.0, 1.16, 1.04, 1.01]) == "2.0"
    assert edge_flow_convergence.order([1.0, 1.0, 1.0]) == "–"


def test_spheres_against_closed_forms(capsys):
    """Two spheres, coarse: the search leaves 0.1 %, the grid less than 1 %."""
    assert validate_spheres.main(["maugis", "--tabor", "0.1", "0.5"]) == 0
    _, _, *rows = capsys.readouterr().out.splitlines()
    for row, tabor in zip(rows, (0.1, 0.5), strict=True):
        pull_off = reference.maugis_dugdale_pull_off(reference.maugis_parameter(tabor**3 / 0.02**2, 1.0, 0.02, 0.02))
        cells = [float(cell.strip(" %")) for cell in row.replace("²", "").split("|")[1:-1]]
        assert cells[0] == tabor
        assert cells[6] == pytest.approx(pull_off, abs=6e-4)  # three digits
        assert max(abs(cells[7]), abs(cells[8]) / 2, abs(cells[9]) / 0.02) < 1


def test_figures_of_closed_forms_have_the_solver_on_them():
    """To twice the errors that the page's tables have, the coarsest grid's pressures and the widest zone's areas."""
    sphere, wave = (np.ones((4, count)) for count in (5, 2))
    left, right = validate_spheres.hertz_figure(sphere).axes
    coarse, *_, hertz = (line.get_xydata() for line in left.lines)
    inside = coarse[coarse[:, 0] < 0.9]
    np.testing.assert_allclose(inside[:, 1], np.interp(*inside.T[:1], *hertz.T), atol=0.02)
    assert [len(line.get_xdata()) for line in right.lines] == [4] * 5
    left, right = validate_waves.wave_figure(wave, wave).axes
    westergaard, found, johnson, sticking = (line.get_xydata() for line in left.lines)
    np.testing.assert_allclose(found[:, 1], np.interp(found[:, 0], *westergaard.T), atol=0.01)
    np.testing.assert_allclose(sticking[:, 1], np.interp(sticking[:, 0], *johnson.T), atol=0.03)


def test_spheres_are_read_as_they_were_written(tmp_path, capsys):
    path = tmp_path / "spheres.csv"
    theory = validate_spheres.theory_of(0.5)
    assert theory.parameter == pytest.approx(reference.maugis_parameter(0.5**3, 1.0, 1.0, 1.0), rel=1e-12)
    states = [(2.0, 2.1, 1.0), (0.0, 1.5, 0.25), (-1.7, 0.6, -0.5)]
    for tabor, held in ((0.5, 1.5), (0.1, 1.75)):
        sphere = validate_spheres.Sphere(
            tabor, validate_spheres.theory_of(tabor), 0.05, 96, 8.0, held, held + 0.1, states, 7, 12
        )
        validate_spheres.written(sphere).to_csv(path, mode="a", header=not path.exists(), index=False)
    low, high = validate_spheres.read(path)
    assert (low.tabor, high.tabor, low.pull_off) == (0.1, 0.5, pytest.approx(1.8))
    assert high.theory == theory
    assert high.states == states
    figure = tmp_path / "spheres.png"
    assert validate_spheres.main(["maugis", "--from", str(path), "--figure", str(figure)]) == 0
    rows = capsys.readouterr().out.splitlines()[2:]
    assert [row.split(" | ")[5] for row in rows[:2]] == ["1.800", "1.550"]
    assert figure.stat().st_size > 10_000


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_the_contact_mechanics_challenge(capsys):
    assert contact_challenge.main(["--size", "2 um", "--points", "48", "96", "--pressures", "1 MPa", "4 MPa"]) == 0
    said = capsys.readouterr().out
    head, _, _, _, *rows, _, _, _, warning = said.splitlines()
    assert warning.startswith("The process zone has 0.1 of the finest spacing")
    assert "rms slope 1.000" in head
    split = [[cell.strip() for cell in row.split("|")[1:-1]] for row in rows]
    cells = {(pressure, name): values for pressure, name, *values in split}
    for pressure in ("1000", "4000"):
        coarse, fine, limit = map(float, cells[pressure, "A/A₀"][:3])
        # First order: as far beyond the finer grid as that is from the coarser one.
        assert limit == pytest.approx(2 * fine - coarse, abs=2e-3 * fine)  # four digits
        assert float(cells[pressure, "A/A₀"][3].split()[0]) == pytest.approx(100 * (fine / limit - 1), abs=0.1)
    assert float(cells["4000", "A/A₀"][1]) > float(cells["1000", "A/A₀"][1])
    assert float(cells["4000", "ū (µm)"][1]) < float(cells["1000", "ū (µm)"][1])


def test_the_challenge_goes_on_from_its_table(tmp_path, capsys, monkeypatch):
    asked = ["--size", "2 um", "--pressures", "1 MPa", "--no-adhesion", "--table", str(tmp_path / "table.csv")]
    assert contact_challenge.main([*asked, "--points", "64"]) == 0
    rows = [row.strip("| ").split(" | ") for row in capsys.readouterr().out.splitlines()[4:-2]]
    found = {name: float(value) for _, name, value in rows}
    assert found["A/A₀"] * found["mean stress in contact (MPa)"] == pytest.approx(1, rel=2e-3)  # four digits
    assert found["A/A₀ with σ > 1·E*/2"] > found["A/A₀ with σ > 2·E*/2"]
    # Half-spaces without adhesion: 1.1 to 1.4 times Persson's area at loads this light.
    assert 1 < found["A/A₀"] / found["A/A₀, Persson's theory of the hard wall"] < 1.6
    solved, path = [], contact_challenge.path
    monkeypatch.setattr(contact_challenge, "path", lambda *given: solved.append(given[1]) or path(*given))
    assert contact_challenge.main([*asked, "--points", "64", "96"]) == 0
    assert contact_challenge.main([*asked, "--points", "64", "--seed", "2"]) == 0
    assert solved == [96, 64]


@pytest.mark.parametrize(("order", "limit"), [(1, 3.0), (2, 3.0)])
def test_richardson_finds_the_order_of_three_grids(order, limit):
    spacing = [0.4, 0.2, 0.1]
    values = [limit + 5 * h**order for h in spacing]
    assert contact_challenge.extrapolated(values, spacing) == pytest.approx(limit, rel=1e-12)
    assert contact_challenge.extrapolated([1.0, 1.0, 1.0], spacing) == 1.0
    for wild in ([3.0, 2.0, 1.99], [3.0, 2.0, 1.2], [1.0, 3.0, 2.0]):  # sixth order, a third, none
        assert contact_challenge.extrapolated(wild, spacing) == pytest.approx(2 * wild[-1] - wild[-2])


def test_the_work_of_separation_of_maugis_becomes_that_of_jkr():
    """F = a³ − √(6a³) and δ = a² − ⅔√(6a) from F = 0, a³ = 6, to the least approach, a³ = 1/6: −∫F dδ."""

    def primitive(a):
        return 0.4 * a**5 - 2 / 3 * np.sqrt(6) * a**3.5 + a**2

    work = primitive((1 / 6) ** (1 / 3)) - primitive(6 ** (1 / 3))
    expected = work * np.pi * (3 * np.pi / 4) ** (2 / 3)
    # What a range leaves: 5e-4 at λ = 20, a quarter at 40.
    assert sphere_path.maugis_work(40.0) == pytest.approx(expected, rel=1e-3)


def test_slow_motion_and_one_step_part_where_the_grid_is_coarser_than_the_process_zone(tmp_path, capsys):
    table, figure = tmp_path / "states.csv", tmp_path / "figure.png"
    asked = ["--points", "24", "--seeds", "1", "--laws", "exponential", "-o", str(table)]
    assert trapped_edges.main([*asked, "--ratios", "0.2", "2"]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert rows[3].endswith("| = |")
    assert float(re.search(r"\| (\S+) %, ", rows[2])[1]) > 5
    assert rows[-1].startswith("- exponential, 24²: the same states from 2 on")
    # The zone that it says is that of the solver.
    words = "process zone 9.76 nm"
    with pytest.warns(UserWarning, match=words):
        contact_study.run(trapped_edges.study("exponential", 24, 0.2, 1))
    assert trapped_edges.main([*asked, "--ratios", "0.2", "--figure", str(figure)]) == 0
    assert figure.stat().st_size > 1000


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_the_work_of_the_load_goes_into_the_energies(capsys):
    assert validate_energies.main(["--points", "32", "--steps", "4", "8"]) == 0
    _, _, coarse, fine, order = (row.strip("| ").split(" | ") for row in capsys.readouterr().out.splitlines())
    for one, half, shown in zip(*(map(float, row[1:]) for row in (coarse, fine)), map(float, order[1:]), strict=True):
        # The trapezoidal rule's second order, as two digits and few points that touch show it; 2e-3 on 64² points.
        assert 0 < half < one < 6e-3
        assert shown == pytest.approx(2, abs=0.5)


def test_adhesion_steepens_the_polymer_contact_by_a_fifth_at_its_threshold():
    spectrum = polymer_contact.Shape().spectrum()
    assert spectrum.rms_slope == pytest.approx(0.1, rel=1e-12)
    flat, sphere = polymer_contact.slope_ratios(spectrum, 0.2)
    # The value on four times the nodes and eight times the cells; the difference quotient over 0.4 in ln p is of second
    # order.
    assert flat == pytest.approx(1.1789, abs=3e-4)
    # ∫ p dū from the mean gap itself, ū over falling pressure: its ratio is the sphere's.
    work = 0.2 / criteria.persson_tosatti_ratio(spectrum, 1.0, 1.0)
    loads = []
    for each in (0.0, work):
        curve = separation_curve(PerssonTheory(spectrum, 1.0, each), 1e-8, tolerance=1e-9)
        pressure = np.geomspace(1e-8, 2e-4, 400)
        loads.append(-np.trapezoid(pressure, curve.mean_gap(pressure)))
    # Trapezoids of 1/40 decade, and what is below a pressure of 1e-8.
    assert sphere == pytest.approx(loads[0] / loads[1], rel=1e-3)


def test_gap_distributions_against_the_wall():
    table = gap_distributions.ensemble(Namespace(surfaces=1, points=32))
    assert list(table["model"].unique()) == list(gap_distributions.MODELS)
    continuum = table[table["model"] == "continuum"].set_index(["pressure_GPa", "distance_angstrom"])["mean"]
    assert continuum.groupby("pressure_GPa").is_monotonic_increasing.all()
    for model in gap_distributions.MODELS[1:]:
        found = table[table["model"] == model].set_index(["pressure_GPa", "distance_angstrom"])["mean"]
        # One coarse surface: the theories are of its spectrum, within a third where most gaps are.
        assert found[1.0, 10.0] == pytest.approx(continuum[1.0, 10.0], rel=0.33), model
    shown = list(gap_distributions.lines(table.assign(standard_error=0.01)))
    assert len(shown) == 1 + len(gap_distributions.PRESSURES) * len(gap_distributions.DISTANCES)


def test_dmt_limit_beside_the_edge_flow(monkeypatch):
    monkeypatch.setattr(dmt_limit, "BARE_PRESSURES", (1.0,))
    weak = read_study(Path(__file__).parent.parent / "data" / "yang2008.toml").cases[0]
    (row,) = dmt_limit.rows(weak)
    work, tabor, bare, gap, limit, whole = (float(cell) for cell in row.strip("| ").split(" | "))
    assert (work, tabor, bare) == (0.692, 0.30, 1.0)
    # ū/h_rms of the bare contact at ln(p/E*) = −4.54 lies between 0.818 and 1.297, of −4 and −5.
    assert 0.818 < gap < 1.297
    # The paper's weakest adhesion, μ = 0.3: adhesion takes a third of the load, in both within a tenth of it.
    assert limit == pytest.approx(whole, abs=0.1)
    assert whole < 0.8


def test_kernels_of_the_edge_flow_are_those_of_the_mean_over_directions():
    found = edge_flow_kernels.kernels()
    assert found["the edge flow's"] == (0.25, 0.0, 4.0)
    small = 1e-2
    for words, curvature in (("c = 0", 0.0), ("c = K", 1.0), ("c = 1000 K", 1e3)):
        own = edge_flow_kernels.rational(np.array([small, 2.0]), found[words])
        exact = edge_flow_kernels.exact(np.array([small, 2.0]), curvature)
        assert own[1] == pytest.approx(exact[1], rel=1e-9)
        # Of fourth order in p, the growth itself is of second.
        assert own[0] == pytest.approx(exact[0], abs=10 * small**4)
    # A wave without a law: <|q + p|> for p = q is 4/π.
    assert float(edge_flow_kernels.exact(1.0, 1e6)) == pytest.approx(4 / np.pi, rel=1e-5)
    fitted = edge_flow_kernels.rational(np.array([1.0, 4.0, 8.0]), found["c = K, fitted"])
    assert fitted == pytest.approx(edge_flow_kernels.exact(np.array([1.0, 4.0, 8.0]), 1.0), rel=0.2)


def test_what_slow_loading_loses_is_what_the_table_says(tmp_path):
    """The warning's share is the largest of the trials, the page's that at the process zone of its grid."""
    table = pd.read_csv(contact_challenge.TRAPPED_EDGES)
    assert pytest.approx(trapped_edges.less(table).max(), abs=0.005) == process_zone.LESS_CONTACT
    own = table[(table.law == "exponential") & (table.ratio == 0.2)].assign(less=trapped_edges.less)
    coarse, fine = (100 * rows.less.mean() for _, rows in own.groupby("points"))
    words = f"at 0.2 of a spacing {coarse:.0f} % on 64² points and {fine:.0f} % on 128² points"
    assert contact_challenge.slow_loading(0.18) == words


def test_choices_of_perssons_theory():
    """The default choice is the theory's own state; the best one is named."""
    waves = {"rms_height": "0.5 nm", "roll_off_mode": 2, "cutoff_mode": 6}
    study = {
        "surface": {"kind": "self_affine", "size": "20 nm", "shape": [32, 32], **waves},
        "material": {"youngs_modulus": "50 GPa", "poissons_ratio": 0.3},
        "interaction": {"work_of_adhesion": "0.05 J/m^2", "length": "0.5 nm"},
        "loading": {"path": ["1 GPa"]},
    }
    dataset = contact_study.run({**study, "sweep": {"interaction.well_depth_ratio": [1]}})
    (choices,) = persson_choices.scan(dataset).values()
    assert len(choices) == 4 * 4 * 3 * 2
    case = make_study(study).cases[0]
    theory = PerssonTheory(realise(case).measured_spectrum(), case.solid, case.law.work_of_adhesion)
    expected = abs(theory.at_pressure(1e9).relative_contact_area / dataset.relative_contact_area.item() - 1)
    default = next(one for one in choices if (one.alpha, one.beta, one.true_area, one.capped) == (1, 0.4, "persson", 0))
    assert default.deviation == pytest.approx(expected, rel=1e-12)
    assert len({one.deviation for one in choices}) > 20
    best = min(choices, key=lambda one: one.deviation)
    assert f"α = {best.alpha:g}, β = {best.beta:g}, area {best.true_area}" in persson_choices.table({1.0: choices})


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_two_starts_under_adhesion_are_in_balance_and_approach_goes_further(capsys):
    wave = 1e-9 * np.cos(2 * np.pi * np.arange(128) / 128) * np.ones((128, 1))
    curvature = 1e-9 * (2 * np.pi / two_starts_with_adhesion.CELL) ** 2 / 2 / np.sqrt(2)
    assert two_starts_with_adhesion.rms_curvature(wave) == pytest.approx(curvature, rel=1e-9)
    assert two_starts_with_adhesion.main(["--points", "128"]) == 0
    rows = [line.strip("| ").split(" | ") for line in capsys.readouterr().out.splitlines()[2:]]
    assert [row[2] for row in rows] == ["separation", "the hard wall"]
    approach, pressed = ([float(cell) for cell in row[3:]] for row in rows)
    for area, bare, _, residual, _ in (approach, pressed):
        assert area > 1.1 * bare
        assert residual < 1e-8
    assert approach[0] > pressed[0]
    # Energies differ by a part of the adhesion of the area between the two, 5 mJ/m² of it.
    assert abs(approach[2] - pressed[2]) < 5.0 * (approach[0] - pressed[0])
