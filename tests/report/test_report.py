"""The numbers of the report: tiles, tables, changes along the sweep; of comparisons and of one dataset."""

import dataclasses

import numpy as np
import pytest
import xarray as xr

from contact_study.plots.curves import dissipated_energy
from contact_study.report import tables
from contact_study.report.align.cases import scales, series, sweep_points
from contact_study.report.align.deviations import compute_deviations
from contact_study.report.align.regime import compute_regime
from contact_study.report.facts import overview
from contact_study.report.facts.ranking import rank_models
from contact_study.report.page import settings, starts
from contact_study.report.read.datasets import read_inputs
from tests.report import synthetic
from tests.report.panels import reported, run
from tests.report.synthetic import AREA_FACTOR, GAP_SHIFT, MODULUS, SEEDS, area, gap, read, write, write_all

H_RMS, SINGLE, STUDY = synthetic.H_RMS, synthetic.SINGLE, synthetic.STUDY


def words(value, how):
    return f"{value:{how}}".replace("-", "−")


def cells(table, **wanted):
    """Cells by head of the one row whose cells are exported as given."""
    heads = [column.export or str(column.head) for column in table.columns]
    rows = [dict(zip(heads, row, strict=True)) for row in table.rows]
    (row,) = [row for row in rows if all(row[head].value == value for head, value in wanted.items())]
    return row


@pytest.mark.parametrize("pressure", synthetic.PRESSURES[8])
@pytest.mark.parametrize("model", AREA_FACTOR)
def test_all_numbers_by_hand(inputs, model, pressure):
    table = tables.all_numbers(inputs, compute_deviations(inputs.models, "pressure"))
    assert len(table.rows) == 7 * len(AREA_FACTOR)
    row = cells(table, well_depth_ratio=8.0, model=model, **{"applied_pressure (Pa)": pressure})
    shown, contact = row["applied_pressure (Pa)"].text, area(8, pressure, model=model)
    assert (shown.physical, shown.reduced) == (words(pressure / 1e9, ".5g"), words(pressure / MODULUS, ".4g"))
    assert row["relative_contact_area (1)"].text == words(contact, ".4f")
    assert row["relative_contact_area (1)"].value == pytest.approx(contact, rel=1e-12)
    assert row["state"].text == "converged"
    if model == "persson" and pressure < 0:
        assert row["mean_gap (m)"].text == "–"
        return
    own, shown = gap(8, pressure, model=model), row["mean_gap (m)"].text
    assert (shown.physical, shown.reduced) == (words(own / 1e-10, ".4g"), words(own / H_RMS, ".3f"))
    area_cell, gap_cell = list(row.values())[-3:-1]
    if model == "atomistic":
        assert (area_cell.text, gap_cell.text) == ("–", "–")
        return
    relative, shift = 100 * (AREA_FACTOR[model] / 0.9 - 1), GAP_SHIFT[model] - GAP_SHIFT["atomistic"]
    assert area_cell.text == f"{words(relative, '+.0f')} %"
    assert gap_cell.text.reduced == words(shift / H_RMS, "+z.3f")
    assert gap_cell.text.physical == words(shift / 1e-10, "+z.3f")
    assert gap_cell.value == pytest.approx(shift, abs=1e-22)


def test_prescribed_gaps_and_states_in_their_units(tmp_path):
    table = tables.all_numbers(read(tmp_path, synthetic.GAP_STUDY), None)
    head = table.columns[1]
    assert (head.head.physical, head.head.reduced, head.export) == ("ū (nm)", "ū/h_rms", "applied_gap (m)")
    shown = [row[1].text for row in table.rows if row[3].value == "atomistic" and row[0].value == 1.0]
    assert [own.physical for own in shown] == ["1", "0.7", "0.3", "0.2"]
    assert [own.reduced for own in shown] == ["1.429", "1", "0.4286", "0.2857"]
    assert "mean_pressure (Pa)" in [column.export for column in table.columns]


def test_agreement_is_over_shared_states(tmp_path):
    paths = write_all(tmp_path, STUDY, ("atomistic", "theory"))
    inputs = read_inputs([write(tmp_path / "c.nc", "continuum", STUDY, unconverged=[(0, 0)]), *paths])
    deviations = compute_deviations(inputs.models, "pressure")
    # The theory is far off where the continuum has no state.
    here = {"pair": "persson - atomistic", "well_depth_ratio": 1, "step": 0}
    deviations["relative_contact_area_relative_deviation"].loc[here] = -0.87
    rankings = rank_models(inputs.models, deviations, compute_regime(inputs))
    assert [ranking.states for ranking in rankings] == [2, 4]
    rows = {row[0].text: row[1:] for row in tables.agreement_table(inputs, rankings).rows}
    assert [(cell.text, cell.grade) for cell in rows["continuum"]] == [("11 %", "fair")] * 2
    assert [(cell.text, cell.grade) for cell in rows["Persson's theory"]] == [("44 %", "poor")] * 2
    gaps = {row[0].text: row[1:] for row in tables.agreement_table(inputs, rankings, gaps=True).rows}[
        "Persson's theory"
    ]
    assert [(cell.text.physical, cell.text.reduced) for cell in gaps] == [("1.500 Å", "0.214 h_rms")] * 2
    found = overview.agreement(inputs, deviations)
    assert (found.model, found.reference, found.states) == ("continuum", "atomistic", 6)
    assert (found.worst.value, found.mean) == pytest.approx((1 / 9, 1 / 9), rel=1e-9)
    assert list(overview.mean_distances(rankings)) == ["continuum", "gap_flow", "persson"]


def test_material_and_regime_by_hand(inputs, tmp_path):
    table = tables.constants_table(inputs.models)
    heads = ["", "model", "E* (GPa)", "Δγ (J/m²)", "d_eq (Å)", "σ_max (GPa)", "h_rms (Å)", "rms gradient"]
    assert [column.head for column in table.columns] == heads
    texts = [[cell.text for cell in row] for row in table.rows]
    # The gap-flow theory stands in the file of Persson's, whose constants are its own.
    assert [row[1] for row in texts] == 2 * ["atoms", "continuum", "Persson's theory"]
    slope, case = inputs.models["continuum"]["rms_slope"].values.max(), inputs.cases[1]
    expected = (MODULUS / 1e9, case.work_of_adhesion, 3.28, case.law.peak_tensile_stress / 1e9, 7.0, slope)
    assert texts[4] == ["ε = 8 ε₀", "continuum", *(f"{value:.5g}" for value in expected)]
    regime = compute_regime(inputs)
    table, check = tables.regime_table(inputs.models, regime), overview.grid_check(inputs, regime)
    assert table.columns[2].head == "process zone (nm)"
    for row, case in zip(table.rows, inputs.cases, strict=True):
        zone = MODULUS * case.work_of_adhesion / case.law.peak_tensile_stress**2
        spacing = 416e-10 / 24 / zone
        assert [cell.text for cell in row][2:4] == [f"{zone / 1e-9:.1f}", f"{spacing:.2f}"]
        assert check.coarse[row[0].text] == pytest.approx(spacing)
    assert (check.points, check.finest) == (2, pytest.approx(spacing))
    fine = regime.assign(pixel_over_process_zone=0.2 + 0 * regime["pixel_over_process_zone"])
    assert not overview.grid_check(inputs, fine).coarse
    zones = inputs.models["continuum"].assign(surface_size_y=104e-9, surface_size_x=52e-9)
    wide = dataclasses.replace(inputs, models={"continuum": zones})
    at = regime.assign(process_zone=5.13e-10 + 0 * regime["process_zone"])
    assert overview.grid_check(wide, at).shape == (864, 432), "a finer grid is proposed"
    assert overview.grid_check(read(tmp_path, STUDY, ("theory",)), regime) is None


def test_errors_over_seeds_have_digits(tmp_path):
    seeded = read(tmp_path, synthetic.SEEDED)
    table = tables.all_numbers(seeded, compute_deviations(seeded.models, "pressure"))
    row = cells(table, well_depth_ratio=1.0, model="atomistic", **{"applied_pressure (Pa)": 0.1e9})
    values, error = area(1, 0.1e9, SEEDS, "atomistic"), row["relative_contact_area_standard_error (1)"].value
    assert row["relative_contact_area (1)"].value == pytest.approx(values.mean(), rel=1e-12)
    assert error == pytest.approx(synthetic.standard_error(values), rel=1e-9)
    assert row["samples"].text == "3"
    part = seeded.models["continuum"].isel(well_depth_ratio=0)
    one = part["mean_gap"].isel(seed=0, drop=True)
    for scatter, counts in ((1e-15, False), (1e-6, True)):  # rounding is no scatter
        found = series(part.assign(mean_gap=one * (1 + scatter * part["seed"])), "mean_gap").standard_error[:3]
        np.testing.assert_allclose(found, one[:3] * scatter / np.sqrt(3) if counts else [np.nan] * 3, rtol=1e-6)


def test_changes_along_the_sweep_are_paired(tmp_path):
    text = SINGLE + '[sweep]\n"surface.seed" = [1, 2, 3]\n"interaction.well_depth_ratio" = [1, 2, 8]\n'
    found = overview.differences(read(tmp_path, text, ("continuum",), unconverged=[(0, 2)]).models)
    assert [(one.before.label, one.after.label) for one in found] == [("ε = ε₀", "ε = 2 ε₀"), ("ε = 2 ε₀", "ε = 8 ε₀")]
    pressure = np.array([0.1e9, 0.7799e9, 5.8725e9])
    for one, (low, high), states in zip(found, ((1, 2), (2, 8)), (2, 3), strict=True):
        assert (one.states, one.samples) == (states, 3), "a state that one sample lacks is left out"
        for made, own in ((area, one.area), (gap, one.gap)):
            change = made(high, pressure, SEEDS[:, None]) - made(low, pressure, SEEDS[:, None])
            change = change[:, :states].mean(axis=1)
            assert own == pytest.approx((change.mean(), change.std(ddof=1) / np.sqrt(3)), rel=1e-9)
    assert np.isnan(overview.differences(read(tmp_path).models)[0].area[1])
    assert overview.differences(read(tmp_path, SINGLE).models) == []


def test_loops_have_a_pull_off_or_none(tmp_path):
    inputs = read(tmp_path, synthetic.LOOP, ("continuum",))
    (found,) = overview.loops(inputs)
    assert not found.reached
    assert found.lowest == pytest.approx(0.1e9)
    assert tables.pull_off_words(found, MODULUS).physical == "not reached down to 100 MPa"
    assert overview.loops(read(tmp_path, SINGLE, ("continuum",))) == []
    own = inputs.models["continuum"].assign(
        mean_separation=("step", 1e-9 * np.array([3.0, 2.0, 1.0, 2.5, 3.5])),
        **{"pull_off_pressure": -0.3e9, "pull_off_pressure_resolution_error": 0.05e9},
        **{"surface_size_y": 2e-8, "surface_size_x": 1e-8},
    )
    inputs.models["continuum"] = own
    (found,) = overview.loops(inputs)
    assert found.force == pytest.approx(-0.3e9 * 2e-16)
    assert found.dissipated == pytest.approx(dissipated_energy(own))
    assert list(overview.cycles(inputs)) == [""]
    assert tables.pull_off_words(found, MODULUS).physical == "−350 to −300 MPa"
    row = [str(cell.text) for cell in tables.loop_table(inputs, [found]).rows[0]]
    assert row[1:4] == ["continuum", "−350 to −300 MPa", "−60 nN"]


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
@pytest.mark.parametrize("kind", ["continuum", "atomistic", "theory"])
def test_one_dataset_is_reported_on(tmp_path, kind):
    status, text = reported(tmp_path, write(tmp_path / "one.nc", kind), options=("--figures", tmp_path / "figures"))
    assert status == 0
    with xr.open_datatree(tmp_path / "out.nc", decode_timedelta=False) as tree:
        assert set(tree.groups) - {"/theory/metastable"} == {"/", f"/{kind}", "/regime"}
    assert "Deviation" not in text
    model, name = ("persson", "Persson's theory") if kind == "theory" else (kind, kind.replace("atomistic", "atoms"))
    low, high = (100 * area(*at, model=model) for at in ((1, 0.1e9), (8, 5.8725e9)))
    assert f"Contact area, {name} {low:.1f} % → {high:.0f} % of the nominal area, 0.1 to 5.872 GPa" in text
    drawn = {path.stem.partition("_")[2].partition("_")[2] for path in (tmp_path / "figures").iterdir()}
    every = {"stress_distribution", "gap_distribution", "contact_area", "mean_gap"}
    assert drawn == (every if kind == "theory" else {*every, "gap_map", "interface"})


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
def test_unconverged_and_detached_states_are_counted_and_left_out(tmp_path):
    path = write(tmp_path / "one.nc", "continuum", unconverged=[(0, 0), (1, 2)], detached=[(1, 2), (1, 3)])
    status, text = reported(tmp_path, path)
    models = read_inputs([path]).models
    areas, gaps = (overview.extent(models, "continuum", name) for name in ("relative_contact_area", "mean_gap"))
    assert [at.value for at in areas] == pytest.approx([area(1, 0.7799e9), area(1, 5.8725e9)])
    assert areas[0].prescribed == pytest.approx(0.7799e9)
    assert gaps[1].value == pytest.approx(gap(1, 0.7799e9))
    assert status == 2
    assert "⚠ Solver 6 / 7 converged 1 step did not reach the tolerance" in text
    states = [row[-1].text for row in tables.all_numbers(read_inputs([path]), None).rows]
    assert [states.count(words) for words in ("not converged", "detached", "converged")] == [1, 2, 4]
    # Seven steps of seven iterations and half a second each.
    (row,) = tables.effort_table(models).rows
    assert [cell.text for cell in row] == ["continuum", "7", "1", "2", "1.0e−09", "49", "4"]
    assert overview.effort(*2 * [*models.values()]) == (14, 2, 4)


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
def test_one_theory_of_a_file_and_a_dataset_without_fields(files, tmp_path):
    with xr.open_dataset(files[2], decode_timedelta=False) as dataset:
        for name, chosen in (("cut", ["persson"]), ("scalar", "persson")):
            dataset.sel(theory=chosen).to_netcdf(tmp_path / f"{name}.nc")
            assert list(read_inputs([tmp_path / f"{name}.nc"]).models) == ["persson"]
    status, text = reported(tmp_path, tmp_path / "cut.nc")
    assert status == 0
    assert "The area is its real contact area at the highest magnification." in text
    assert "Local gap u" not in text
    with xr.open_dataset(files[0], decode_timedelta=False) as dataset:
        dataset.drop_vars(["gap", "pressure", "height", "y", "x"]).to_netcdf(tmp_path / "bare.nc")
    assert run(tmp_path / "bare.nc", "-o", tmp_path / "bare_out.nc", "--figures", tmp_path / "bare") == 0
    assert len(list((tmp_path / "bare").iterdir())) == 4


def test_the_method_lists_what_was_set_and_where_states_start(tmp_path):
    predictor = f"bem-1.nc sha256:{'0' * 64}\nbem-2.nc sha256:{'1' * 64}"
    joined = read(tmp_path, STUDY, ("atomistic",), predictor=predictor)
    assert "the continuum's gap field (bem-1.nc and bem-2.nc)" in " ".join(starts(joined))
    found = dict(settings(joined))
    assert found["interaction.well_depth_ratio"] == "1 and 8"
    assert found["surface.size"] == "41.6 nm × 41.6 nm"
    assert found["surface.rms_height"] == "7 Å"
    assert "solver.tolerance" not in found, "a default"
    held = read(tmp_path, synthetic.GAP_STUDY, ("continuum",))
    assert dict(settings(held))["loading.path"] == "1 nm, 7 Å, 3 Å, 2 Å"
    gaps = ["1 nm", "1.1 nm", "1 nm", "9 Å"]  # of a cycle of 1 Å about 1 nm
    for cycles, path in ((5, [*5 * gaps, "1 nm"]), (6, [*gaps, "1 nm", "… 19 more …", "1 nm"])):
        wave = f'history = "sine"\npoints_per_cycle = 4\namplitude = "1 angstrom"\ncycles = {cycles}\npath = ["1 nm"]\n'
        loading = synthetic.GAP_STUDY.index("path ="), synthetic.GAP_STUDY.index("[output]")
        text = synthetic.GAP_STUDY[: loading[0]] + wave + synthetic.GAP_STUDY[loading[1] :]
        found = dict(settings(read(tmp_path, text, ("continuum",))))
        assert found["loading.path"] == ", ".join(path)
        assert found["loading.amplitude"] == "1 Å"


def test_constants_of_swept_keys_are_the_models_own(tmp_path):
    """Where h_rms is swept, gaps are in units of the roughness that the model has."""
    models = read(tmp_path, synthetic.HEIGHTS.replace('"realised"', '"spectrum"'), ("continuum",)).models
    realised = float(models["continuum"]["realised_rms_height"][0])
    assert scales(models, sweep_points(models)[0]).rms_height == realised != pytest.approx(9e-10, rel=1e-3)


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
def test_two_datasets_of_one_model(tmp_path):
    finer = STUDY.replace("shape = [24, 24]", "shape = [48, 48]")
    paths = write(tmp_path / "coarse.nc", "continuum", STUDY), write(tmp_path / "fine.nc", "continuum", finer)
    inputs = read_inputs(paths)
    assert list(inputs.models) == ["continuum:coarse", "continuum:fine"]
    assert "surface.shape is [24, 24] in the one and [48, 48] in the other" in "".join(inputs.notes)
    status, text = reported(tmp_path, *paths)
    assert status == 0
    assert "Continuum (fine) and continuum (coarse) within 0.0 % in contact area" in text
    # Several of one name are called after their folders; two versions of the program are told apart.
    for name, commit in (("a", "0"), ("b", "1")):
        (tmp_path / name).mkdir()
        write(tmp_path / name / "bem.nc", "continuum", STUDY, git_commit=commit * 40)
    both = read_inputs([tmp_path / "a/bem.nc", tmp_path / "b/bem.nc"])
    assert list(both.models) == ["continuum:a_bem", "continuum:b_bem"]
