"""The verbs on one small study, as a user would run them."""

import io
import re
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import numpy as np
import pandas as pd
import pytest
import xarray as xr

from contact_study import plots
from contact_study.campaign import expectation
from contact_study.command_line import frame
from contact_study.command_line.program import VERBS
from contact_study.command_line.verbs.plot import PICTURES
from contact_study.start import bem_adhesion as program
from contact_study.study.schema.dotted_keys import SECTIONS
from contact_study.study.schema.keys import keys_of

STUDY = """
study = { title = "small" }
material = { youngs_modulus = "77.2 GPa", poissons_ratio = 0.42, lattice_constant = "2.6 angstrom" }
loading = { path = ["0.5 GPa", "2 GPa"] }
output = { fields = true }
sweep = { "interaction.well_depth_ratio" = [1, 4] }
[surface]
kind = "self_affine"
size = "83.2 angstrom"
shape = [32, 32]
rms_height = "2 angstrom"
roll_off_mode = 2
cutoff_mode = 4
seed = 3
normalisation = "realised"
[interaction]
well_depth = "18.6 meV"
length = "3.28 angstrom"
contact_distance = "3.68 angstrom"
[[override]]
when = { "interaction.well_depth_ratio" = 4 }
"loading.path" = ["0.5 GPa", "-0.2 GPa", "2 GPa"]
"""
MODELS = {"bem": "continuum", "md": "atoms", "theory": "theory"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the datasets of all models and their comparison."""
    folder = tmp_path_factory.mktemp("chain")
    (folder / "study.toml").write_text(STUDY)
    outputs = [folder / f"{name}.nc" for name in MODELS]
    for model, output in zip(MODELS.values(), outputs, strict=True):
        start = ["--start-from", outputs[0]] if model == "atoms" else []
        # Two cases as small as these are done before a second process has started.
        given = ["run", folder / "study.toml", "-o", output, "--model", model, "--workers", 1, *start]
        assert program([*map(str, given)]) == 0
    assert program(["compare", *map(str, outputs), "-o", str(folder / "comparison")]) == 0
    return folder


def test_everything_is_written_and_nothing_else(folder):
    models = [f"{model}.nc{end}" for model in MODELS for end in ("", ".restart")]
    assert {path.name for path in folder.iterdir()} == {"study.toml", "comparison", *models}
    assert {path.name for path in (folder / "comparison").iterdir()} == {"comparison.nc", "figures", "report.html"}
    assert "continuum&#39;s gap field (bem.nc)" in (folder / "comparison" / "report.html").read_text()
    with xr.open_dataset(folder / "bem.nc") as bem, xr.open_dataset(folder / "md.nc") as md:
        np.testing.assert_allclose(bem.height, md.height, atol=1e-20)
        # Same surface, same criterion: areas within a tenth, which the paper-size runs meet with a margin of three.
        assert np.nanmax(np.abs(bem.relative_contact_area - md.relative_contact_area)) < 0.1


@pytest.mark.parametrize("name", MODELS)
def test_datasets_describe_themselves(folder, name):
    with xr.open_dataset(folder / f"{name}.nc") as dataset:
        assert (dataset.converged.isel(well_depth_ratio=0, step=slice(2)) == 1).all()
        assert dataset.attrs["Conventions"].startswith("CF-")
        for variable in dataset.variables.values():
            assert {"units", "long_name"} <= set(variable.attrs)


def test_theories_stand_side_by_side(folder):
    with xr.open_datatree(folder / "theory.nc", decode_timedelta=False) as tree:
        root, branches = tree.to_dataset(), tree["metastable"].to_dataset()
        theories = ["persson", "gap_flow", "edge_flow"]  # on the surface's own spectrum, then on its target
        assert root.theory.values.tolist() == [*theories, *(f"{theory}@analytic" for theory in theories)]
        for name in ("gap_pdf", "local_mean_pressure"):
            told = root[name].sel(theory=theories).notnull().any([dim for dim in root[name].dims if dim != "theory"])
            assert told.values.tolist() == [False, True, True]
        # The branches enclose the equilibrium, to the error of the theory's grids.
        low, areas, high = (
            found.relative_contact_area.sel(theory="gap_flow").values
            for found in (branches.sel(metastable_branch="loading"), root, branches.sel(metastable_branch="unloading"))
        )
        there = np.isfinite(areas)
        assert (low <= areas * (1 + 1e-3))[there].all()
        assert (high >= areas * (1 - 1e-3))[there].all()


@pytest.mark.parametrize("name", ["bem", "md"])
def test_simulations_balance_and_count(folder, name):
    with xr.open_dataset(folder / f"{name}.nc") as dataset:
        applied, found = dataset.applied_pressure.values, dataset.mean_pressure.values
        present = np.isfinite(applied)
        # The mean of the residual cannot exceed its largest value, the tolerance 1e-8 E*.
        modulus = 77.2e9 / (1 - 0.42**2)
        assert np.abs(found - applied)[present].max() < 1e-8 * modulus
        assert dataset.residual.values[present].max() < 1e-8 * 1.001  # E* of the atoms differs by 1e-4
        # Every gap and pressure lies inside the automatic bins.
        for pdf, edges in (("pressure_pdf", "pressure_bin"), ("gap_pdf", "gap_bin")):
            width = float(dataset[edges][1] - dataset[edges][0])
            np.testing.assert_allclose(dataset[pdf].sum(edges).values[present] * width, 1.0, rtol=1e-12)


@pytest.mark.validation
def test_own_path_reaches_the_predicted_states(folder, tmp_path):
    """In two processes and without the continuum's gap field the atoms end in the same states, to the tolerance."""
    command = [Path(sys.executable).with_name("md-reference"), folder / "study.toml", "-o", tmp_path / "own.nc"]
    assert subprocess.check_output(command, text=True) == f"{command[-1]}\n"
    with xr.open_dataset(folder / "md.nc") as predicted, xr.open_dataset(tmp_path / "own.nc") as own:
        # One atom of 1024; residual 1e-8 E* over the softest stiffness of the system, E* q_L / 2, is 3e-17 m.
        for name, within in (("relative_contact_area", 1 / 1024), ("mean_gap", 1e-15)):
            difference = np.abs(predicted[name] - own[name]).values[np.isfinite(own.applied_pressure.values)]
            assert difference.max() <= within, name


@pytest.mark.validation
@pytest.mark.parametrize("name", MODELS)
def test_smaller_study_is_widened_to_the_whole(folder, tmp_path, name):
    """One law, one pressure; then all of the study: the numbers are those of a run that asked for all at once."""
    smaller = STUDY[: STUDY.index("[[override]]")].replace('"0.5 GPa", "2 GPa"', '"0.5 GPa"').replace("[1, 4]", "[1]")
    (tmp_path / "smaller.toml").write_text(smaller)
    arguments = ["-o", str(tmp_path / "out.nc"), "--workers", "1", "--model", MODELS[name]]
    arguments += ["--predictor", str(folder / "bem.nc")] if name == "md" else []
    assert program(["run", str(tmp_path / "smaller.toml"), *arguments]) == 0
    assert program(["run", str(folder / "study.toml"), *arguments, "--resume"]) == 0
    with xr.open_datatree(folder / f"{name}.nc") as whole, xr.open_datatree(tmp_path / "out.nc") as widened:
        assert ("other bins" in widened.attrs["warnings"]) == (name != "theory")
        binned = ["wall_time", "pressure_pdf", "gap_pdf"]
        for group in {*whole.groups, *widened.groups}:
            own, other = (tree[group].to_dataset().drop_vars(binned, errors="ignore") for tree in (whole, widened))
            xr.testing.assert_equal(own, other)


@pytest.fixture
def verb(folder, monkeypatch, capsys):
    """Type a verb in the folder of the datasets; returns the exit status and what was said."""
    monkeypatch.chdir(folder)

    def typed(*words):
        status = program([str(word) for word in words])
        shown = capsys.readouterr()
        return status, shown.out, shown.err

    return typed


def test_check_says_what_the_datasets_then_have(folder, verb):
    before = sorted(folder.iterdir())
    status, said, errors = verb("check", "study.toml")
    assert (status, errors) == (0, "")
    assert "study.toml: small\n2 cases of 2 to 3 load steps, 5 in all (well_depth_ratio: 1, 4)\n32 x 32 points" in said
    for model in MODELS.values():
        assert re.search(rf"^{model} +yes +\d", said, re.MULTILINE)
    assert len(re.findall("^(?:grid points|theta|Tabor|area without)", said, re.MULTILINE)) == 4
    with xr.open_dataset(folder / "bem.nc") as bem, xr.open_datatree(folder / "comparison/comparison.nc") as tree:
        regime = tree["regime"].to_dataset()
        first = {
            "grid points per process zone": float((bem.process_zone / bem.pixel).min()),
            # The report counts the true area, the check the projected one.
            "theta": float((regime.adhesion_over_elastic_energy / regime.area_factor).min()),
            "Tabor": float(regime.tabor_parameter.min()),
        }
    for words, expected in first.items():
        found = float(re.search(rf"^{words}.*?  +([\d.e+-]+)", said, re.MULTILINE)[1])
        # Three digits; the report's roughness is that of one sample of a few waves.
        assert found == pytest.approx(expected, rel=0.005 if words.startswith("grid") else 0.25, abs=0), words
    assert "too coarse" in said
    assert "warning (continuum): grid too coarse" in said
    assert sorted(folder.iterdir()) == before


def test_limits_are_those_of_the_page_on_choosing():
    titles = [*expectation.meanings()]
    for number, value, words in (
        *((0, 4.0, "resolves"), (0, 3.9, "trapped on unloading"), (0, 0.9, "factor of two")),
        *((1, 1.1, "stick completely"), (1, 0.9, "partial")),
        *((2, 3.1, "will differ"), (2, 2.9, "may differ"), (2, 0.09, "agree")),
        *((3, 19.0, "light contact, in"), (3, 21.0, "beyond")),
    ):
        ((_, _, said),) = expectation.rows([{titles[number]: value}])
        assert words in said


def test_check_refuses_what_a_run_refuses(verb, tmp_path):
    changed = ["--interaction.law", "exponential", "--interaction.work_of_adhesion", "0.1 J/m^2"]
    given = ["check", tmp_path / "plain.toml", *changed, "--loading.path", "1 GPa"]
    given[1].write_text(STUDY.replace('well_depth = "18.6 meV"\n', ""))
    status, said, _ = verb(*given)
    assert status == 0
    assert re.search(r'^atoms +no +interaction.law = "exponential"', said, re.MULTILINE)
    status, said, errors = verb(*given, "--model", "atoms")
    assert (status, said, errors.count("\n")) == (1, "", 1)
    status, said, errors = verb(*given, "--surface.shape", "1000000,1000000")
    assert (status, errors) == (1, "bem-adhesion: no model can run this study\n")
    assert said.count(" no ") == 3


@pytest.mark.parametrize("picture", ["area", "gap", "map", "contact", "section", "heights", "stresses"])
def test_a_picture_is_drawn(verb, tmp_path, picture):
    status, said, errors = verb("plot", "bem.nc", picture, "-o", tmp_path / "a.png")
    assert (status, said) == (0, f"{tmp_path / 'a.png'}\n")
    assert matplotlib.image.imread(tmp_path / "a.png").shape[1] > 400
    one_state = picture not in ("area", "gap", "heights")
    # The last load step in contact of the last case.
    assert ("well_depth_ratio=4 (of 1, 4), step 2 (of 0 to 2)" in errors) == one_state


def test_the_state_that_is_asked_for_is_drawn(folder, verb, monkeypatch, tmp_path):
    shown = []
    draw = plots.gap_map
    monkeypatch.setattr(plots, "gap_map", lambda dataset: shown.append(dataset) or draw(dataset), raising=False)
    asked = ["--case", "well_depth_ratio=1", "--step", "0", "-o", tmp_path / "a.pdf"]
    assert verb("plot", "bem.nc", "map", *asked)[0] == 0
    assert float(shown[0].well_depth_ratio) == 1
    assert float(shown[0].applied_pressure) == 0.5e9
    assert (tmp_path / "a.pdf").read_bytes()[:4] == b"%PDF"


def test_the_table_has_every_case_and_step(folder, verb, tmp_path):
    table = tmp_path / "bem.csv"
    assert verb("export", "bem.nc", "--csv", "-o", table) == (0, f"{table}\n", "")
    frame = pd.read_csv(table)
    assert frame.columns[:4].tolist() == ["well_depth_ratio", "step", "applied_pressure (Pa)", "branch"]
    assert frame.branch.tolist() == 5 * ["loading"]
    with xr.open_dataset(folder / "bem.nc") as dataset:
        gaps = dataset.mean_gap.sel(well_depth_ratio=4)
        np.testing.assert_allclose(frame["mean_gap (m)"][frame.well_depth_ratio == 4], gaps, rtol=1e-8)  # nine digits
    assert verb("export", "bem.nc", "--csv", "-o", table)[0] == 1
    assert verb("export", "bem.nc", "--csv", "-o", table, "--overwrite", "--case", "well_depth_ratio=1")[0] == 0
    assert len(pd.read_csv(table)) == 2


def test_fields_of_a_case_go_to_paraview(verb, tmp_path):
    pytest.importorskip("pyevtk")
    given = ["export", "bem.nc", "--vtk", "-o", tmp_path / "fields.pvd"]
    status, _, errors = verb(*given)
    assert status == 1
    assert "--case well_depth_ratio=" in errors
    assert verb(*given, "--case", "well_depth_ratio=1")[0] == 0
    assert len(list((tmp_path / "fields").iterdir())) == 2


def test_keys_are_those_of_the_schema(verb):
    assert {name for name, *_ in PICTURES.values()} <= {*plots.__all__}
    _, said, _ = verb("keys")
    assert [line.split()[0] for line in said.splitlines()[1:] if not line.startswith(" ")] == list(SECTIONS)
    _, said, _ = verb("keys", "surface", "--kind", "file")
    kind = SECTIONS["surface"].declared["file"]
    assert re.findall(r"^surface\.(\w+)", said, re.MULTILINE) == list(keys_of(kind))
    _, said, _ = verb("keys", "loading.resolution")
    assert re.search(r"^loading.resolution +number +0.01 +least adaptive step", said, re.MULTILINE)
    _, said, _ = verb("keys", "material")
    assert re.search(r"^material.youngs_modulus +Pa +required +Young's", said, re.MULTILINE)


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["rnu", "study.toml"], "(did you mean run?)"),
        (["run", "study.toml", "--ouput", "a.nc"], "(did you mean --output?)"),
        (["run", "study.toml", "-o", "a.nc", "--surface.sede", "3"], "(did you mean --surface.seed?); see"),
        (["run", "study.toml", "-o", "a.nc", "--surface.rms_height", "1 GPa"], "surface.rms_height"),
        (["run", "study.toml", "-o", "a.nc", "--surface.kind", "file", "--surface.path", "no.npy"], "no.npy"),
        (["run", "study.toml", "-o", "a.nc", "--surface.seed"], "--surface.seed: expected a value"),
        (["run", "study.toml", "-o", "a.nc", "--start-from", "bem.nc"], "use --model atoms"),
        (["run", "study.toml", "-o", "a.nc", "--model", "atomz"], "atoms"),
        (["keys", "surfce"], "(did you mean surface?)"),
        (["keys", "rms_height"], "(did you mean surface.rms_height?)"),
        (["keys", "surface", "--kind", "flie"], "(did you mean file?)"),
        (["plot", "bem.nc", "mpa"], "map"),
        (["plot", "bem.nc", "--case", "well_depth=4"], "(did you mean well_depth_ratio?)"),
        (["plot", "bem.nc", "--case", "well_depth_ratio=3"], "has well_depth_ratio 1, 4"),
        (["plot", "bem.nc", "map", "--step", "7"], "load steps 0 to 2"),
        (["plot", "bem.nc", "loop"], "bem.nc: "),
        (["plot", "comparison/comparison.nc"], "give the dataset of a run"),
        (["plot", "bem.nc", "-o", "bem.nc"], "expected a name that ends in"),
        (["export", "md.nc", "--xyz", "--case", "well_depth_ratio=4"], "output.atoms"),
        (["export", "bem.nc"], "--csv"),
    ],
)
def test_a_mistake_is_one_line_with_what_is_meant(folder, verb, words, meant):
    before = sorted(folder.iterdir())
    status, said, errors = verb(*words)
    assert (status, said) == (1, "")
    assert meant in errors
    assert errors.count("\n") == 1
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize("name", [*VERBS, ""])
def test_help_fits_a_screen(verb, name):
    status, said, _ = verb(*([name] if name else []), "--help")
    assert status == 0
    lines = said.splitlines()
    assert max(map(len, lines)) <= 100
    assert len(lines) <= (30 if name == "run" else 45)
    assert "examples:" in said
    assert "exit status: 0 done   1 invalid input" in said
    solves = name in ("", "run", "compare", "merge")
    assert ("2 some steps not converged" in said) == solves


def test_colours_are_for_terminals(verb, monkeypatch):
    """The same words by rich and without; colours where they are wanted only."""
    console = pytest.importorskip("rich.console").Console
    _, plain, _ = verb("keys", "surface")
    for variables, coloured in (({}, True), ({"NO_COLOR": "1"}, False)):
        stream = io.StringIO()
        made = console(file=stream, width=100, force_terminal=True, color_system="standard", _environ=variables)
        monkeypatch.setattr(frame, "_console", lambda made=made: made)
        _, beside, _ = verb("keys", "surface")
        assert ("\x1b[36m" in stream.getvalue()) == coloured
        words = re.sub(r"\x1b\[[\d;]*m", "", stream.getvalue() + beside).split()
        assert sorted(words) == sorted(plain.split()), "and no colour in what is plain"


HELP = "from contact_study.start import bem_adhesion as run; run(['run', '--help'])"


@pytest.mark.parametrize(("code", "library"), [(HELP, "numpy"), ("import bem_adhesion", "numba")])
def test_no_library_is_imported_that_takes_longer_than_all_else(code, library):
    subprocess.run([sys.executable, "-c", f"import sys; {code}; assert '{library}' not in sys.modules"], check=True)
