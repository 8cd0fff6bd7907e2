"""The command from end to end: files, report, refusals, exit status."""

import contextlib
import io
import re

import numpy as np
import pytest
import xarray as xr

from contact_study.report import figures
from contact_study.report.align.deviations import compute_deviations
from contact_study.report.read.datasets import read_inputs
from tests.report.panels import reported, run, text_of
from tests.report.synthetic import HARD, SEEDED, SINGLE, STUDY, write, write_all


@pytest.fixture(scope="module")
def compared(files, tmp_path_factory):
    """A folder with all outputs, whose names were printed."""
    folder = tmp_path_factory.mktemp("compared")
    outputs = ["-o", folder / "a" / "comparison.nc", "--figures", folder / "f", "--report", folder / "r.html"]
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        assert run(*files[1:], files[0], *outputs) == 0
    named = printed.getvalue().splitlines()
    assert named[0] == str(folder / "a" / "comparison.nc")
    assert sorted(named) == sorted(str(path) for path in folder.rglob("*") if path.is_file())
    assert len(named) == 7
    return folder


def test_the_dataset_holds_everything_with_units(compared, files):
    with xr.open_datatree(compared / "a" / "comparison.nc", decode_timedelta=False) as tree:
        assert {node.path for node in tree.subtree} == {
            *("/", "/atomistic", "/continuum", "/theory", "/theory/metastable", "/deviations", "/regime"),
        }
        for node in tree.subtree:
            for name, variable in node.to_dataset().variables.items():
                assert variable.attrs.get("units"), (node.path, name)
                assert variable.attrs.get("long_name"), (node.path, name)
        for name in ("Conventions", "title", "source", "history", "references", "study_toml", "git_commit"):
            assert tree.attrs[name], name
        assert tree.attrs["schema_version"]
        with xr.open_dataset(files[0], decode_timedelta=False) as original:
            kept = tree["continuum"].to_dataset()
            xr.testing.assert_equal(kept, original.drop_vars(["gap"])[list(kept.variables)])
        for name in ("state", "branch"):
            flags = tree["deviations"][name]
            assert flags.dtype == np.int8, name
            assert np.isin(flags, flags.attrs["flag_values"]).all(), name
            assert (flags == -1).any(), "a padded point is marked, not missing"
        table = compute_deviations(read_inputs(files).models, "pressure")
        xr.testing.assert_equal(tree["deviations"].to_dataset(), table)
    with xr.open_dataset(compared / "a" / "comparison.nc", group="theory/metastable") as group:
        assert "applied_pressure" in group.coords, "a group stands by itself"


def test_the_page_stands_alone_and_says_what_was_run(compared):
    page = (compared / "r.html").read_text(encoding="utf-8")
    assert page.count('<svg role="img"') == 9, "four figures in two systems of units, and the maps"
    assert not re.search(r'(src|href)="(?!data:|#)', page), "nothing from outside"
    text = text_of(page)
    for words in (
        "material.youngs_modulus77.2 GPa",
        "surface.shape24 × 24",
        "interaction.well_depth18.6 meV",
        "A theory fed with the target spectrum uses no surface",
        "100 MPa, −498.7 MPa, 779.9 MPa, 5.8725 GPa",
        "a grid too coarse",
        "distances from the atoms: the continuum (11 % and 0.071",
        "Continuum and atoms within 11 %",
        "xr.open_datatree",
        "41.6 nm × 41.6 nm · hrms 7 Å",
        "4 models",
        "Solver 28 / 28 converged all models; none detached; 3 warnings",
    ):
        assert words in text, words


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
def test_report_of_seeds_unconverged_steps_and_a_title_that_is_no_text(tmp_path):
    odd = SEEDED.replace('title = "synthetic"', "title = '<script>&'").replace("[1, 2, 3]", "[1, 2]")
    paths = [
        write(tmp_path / "c.nc", "continuum", odd),
        write(tmp_path / "a.nc", "atomistic", odd, unconverged=[(0, 1), (2, 1)]),
    ]
    status, text = reported(tmp_path, *paths, options=("--reference-pressure", "5 GPa"))
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert status == 2
    assert "<script>&" not in page
    assert "&lt;script&gt;&amp;" in page
    assert "surface.seed1 and 2" in text
    assert "Curves are means over the seeds" in text
    assert "surface of the first seed (1)" in text
    assert "Persson" not in text
    assert "standard errors over seeds" in text
    assert "2 steps did not reach the tolerance" in text
    assert "(a) each point of the sweep at p = 5.8725 GPa" in text, "the pressure of the path nearest to 5 GPa"


LARGE = (
    SINGLE.replace('well_depth = "18.6 meV"', 'law = "lennard_jones_9_3"\nwork_of_adhesion = "0.05 J/m^2"')
    .replace('"416 angstrom"', '"4 mm"')
    .replace('rms_height = "7 angstrom"', 'rms_height = "5 um"')
    .replace('lattice_constant = "2.6 angstrom"', "")
)


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
@pytest.mark.parametrize(
    ("text", "other", "there", "absent"),
    [
        (
            HARD,
            "atomistic",
            ["positive pressure, is black"],
            ["Persson", "flow", "10-4", "Tabor", "minimum", "Pull-off"],
        ),
        (LARGE, "theory", ["interaction.law9-3", "hrms (µm)", "or a longer range of the law"], ["10-4"]),
    ],
)
def test_contacts_of_other_laws(tmp_path, text, other, there, absent):
    status, page = reported(tmp_path, *write_all(tmp_path, text, ("continuum", other)))
    assert status == 0
    assert [words for words in there if words not in page] == []
    assert [words for words in absent if words in page] == []


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
def test_a_point_of_the_sweep_that_one_model_lacks(tmp_path, capsys):
    paths = [
        write(tmp_path / "c.nc", "continuum", STUDY.replace("[1, 8]", "[1, 4]").split("[[override]]")[0]),
        write(tmp_path / "t.nc", "theory", STUDY.replace("[1, 8]", "[1, 4, 8]")),
    ]
    assert reported(tmp_path, *paths)[0] == 0
    assert "share 2 points of their sweeps" in capsys.readouterr().err
    with xr.open_datatree(tmp_path / "out.nc") as tree:
        np.testing.assert_array_equal(tree["deviations/well_depth_ratio"], [1, 4])
        np.testing.assert_array_equal(tree["regime/well_depth_ratio"], [1, 4, 8])
        known = tree["regime/tabor_parameter"].notnull()
        assert known.all(), "the theory's study knows the surface of the third"


def test_existing_files_are_kept_unless_told(compared, files, tmp_path, capsys):
    folder = compared
    before = {path: path.read_bytes() for path in (*files, *folder.rglob("*")) if path.is_file()}
    assert run(*files, "-o", folder / "a" / "comparison.nc") == 1
    assert run(*files, "-o", folder / "new.nc", "--figures", folder / "f") == 1
    assert run(*files, "-o", folder / "new.nc", "--report", folder / "r.html") == 1
    (tmp_path / "figure_3_contact_area.svg").write_text("precious")
    assert run(*files, "-o", folder / "new.nc", "--figures", tmp_path, "--figure-format", "svg") == 1
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 4
    assert all("--overwrite" in line for line in errors)
    assert run(*files, "-o", files[0], "--overwrite") == 1
    assert "is one of the datasets" in capsys.readouterr().err
    assert {path: path.read_bytes() for path in (*files, *folder.rglob("*")) if path.is_file()} == before
    assert (tmp_path / "figure_3_contact_area.svg").read_text() == "precious"


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
def test_overwriting_leaves_other_files_of_the_folder(files, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "figure_4_mean_gap.png").write_text("old")
    assert run(*files[:2], "-o", tmp_path / "c.nc", "--figures", tmp_path, "--overwrite") == 0
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert (tmp_path / "figure_4_mean_gap.png").read_bytes().startswith(b"<svg")


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        ([], "-o"),
        (["-o", "{}/c.nc", "--figure", "x"], "--figure"),
        (["-o", "{}/c.nc", "--reference-pressure", "1 nm"], "--reference-pressure"),
        (["-o", "{}/c.nc", "--report", "{}/c.nc"], "named twice"),
        (["-o", "{}/c.csv"], "c.csv: a comparison is written as NetCDF"),
        (["-o", "{}/c.nc/"], "c.nc/: is the name of a folder"),
        (["-o", "{}/c.nc", "--report", "{}/r.html/"], "r.html/: is the name of a folder"),
        (["{first}", "-o", "{}/c.nc", "--figures", "{}/f"], "is given twice"),
    ],
)
def test_wrong_arguments_write_nothing(files, tmp_path, capsys, arguments, culprit):
    assert run(*files, *(argument.format(tmp_path, first=files[0]) for argument in arguments)) == 1
    error = capsys.readouterr().err
    assert error.startswith("contact-compare: error: ")
    assert error.count("\n") == 1
    assert culprit in error
    assert not list(tmp_path.iterdir())


def test_no_common_point_is_refused_an_unconverged_step_counts_and_detachment_does_not(tmp_path, capsys):
    path, out = write(tmp_path / "c.nc", "continuum", SINGLE), tmp_path / "out.nc"
    other = SINGLE.replace('"0.1 GPa", "0.7799 GPa", "5.8725 GPa"', '"0.3 GPa", "3 GPa"')
    for options, status, words in (
        ({"text": other}, 1, "no point of their loading paths in common"),
        ({"text": SINGLE, "unconverged": [(0, 1)], "detached": [(0, 1)]}, 0, ""),
        ({"text": SINGLE, "unconverged": [(0, 1)]}, 2, "1 of the inputs' steps did not converge"),
    ):
        assert run(path, write(tmp_path / "a.nc", "atomistic", **options), "-o", out, "--overwrite") == status
        assert words in capsys.readouterr().err
        assert out.exists() == (status != 1)


@pytest.mark.validation
def test_figures_in_other_formats(tmp_path, monkeypatch):
    """PDF and SVG beside PNG or alone, text as text, equal runs equal bytes; the report keeps its own."""
    monkeypatch.setattr(figures.curves, "distributions", lambda *_: [])
    monkeypatch.setattr(figures.states, "read_gaps", lambda *_: {})
    folder, report = tmp_path / "figures", tmp_path / "report.html"
    paths = write_all(tmp_path, SINGLE, ("continuum", "theory"))
    arguments = [*paths, "-o", tmp_path / "c.nc", "--figures", folder, "--overwrite"]
    formats = ["--figure-format", "pdf", "--figure-format", "svg"]
    assert run(*arguments, *formats, "--report", report) == 0
    names = sorted(path.name for path in folder.iterdir())
    assert names == [f"figure_{name}.{kind}" for name in ("3_contact_area", "4_mean_gap") for kind in ("pdf", "svg")]
    first = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert first["figure_3_contact_area.pdf"].startswith(b"%PDF")
    assert b"Persson" in first["figure_3_contact_area.svg"]
    assert '<svg role="img"' in report.read_text()
    assert run(*arguments, *formats, "--figure-format", "png") == 0
    assert {name: (folder / name).read_bytes() for name in names} == first
    assert (folder / "figure_3_contact_area.png").read_bytes().startswith(b"\x89PNG")
