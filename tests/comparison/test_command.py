"""The command from end to end: files, report, refusals, exit status."""

import contextlib
import html
import io
import re

import numpy as np
import pytest
import xarray as xr

from contact_study.comparison.command import main
from contact_study.comparison.datasets import read_inputs
from contact_study.comparison.deviations import compute_deviations
from contact_study.comparison.wording import percent
from tests.comparison.synthetic import STUDY, write, write_all


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return write_all(tmp_path_factory.mktemp("inputs"), warnings="a grid too coarse")


@pytest.fixture(scope="module")
def compared(files, tmp_path_factory):
    """A folder with all outputs, and what was printed."""
    folder = tmp_path_factory.mktemp("compared")
    outputs = ["-o", folder / "a" / "comparison.nc", "--figures", folder / "f", "--report", folder / "r.html"]
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        assert run(*files[1:], files[0], *outputs) == 0
    return folder, printed.getvalue()


@pytest.fixture(scope="module")
def special(tmp_path_factory):
    """Exit status and report of two seeds, one unconverged step, another pressure and a title that is no text."""
    folder = tmp_path_factory.mktemp("special")
    odd = STUDY.replace('title = "synthetic"', "title = '<script>&'")
    odd = odd.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2]\n')
    paths = [
        write(folder / "c.nc", "continuum", odd),
        write(folder / "a.nc", "atomistic", odd, unconverged=[(0, 1), (2, 1)]),
    ]
    report = folder / "r.html"
    status = run(*paths, "-o", folder / "out.nc", "--report", report, "--reference-pressure", "5 GPa")
    return status, report.read_text(encoding="utf-8")


def run(*arguments):
    return main([str(argument) for argument in arguments])


def test_names_what_it_writes(compared):
    folder, printed = compared
    named = printed.splitlines()
    assert named[0] == str(folder / "a" / "comparison.nc")
    assert sorted(named) == sorted(str(path) for path in folder.rglob("*") if path.is_file())
    assert len(named) == 7


def test_the_dataset_holds_everything_with_units(compared, files):
    with xr.open_datatree(compared[0] / "a" / "comparison.nc", decode_timedelta=False) as tree:
        assert {node.path for node in tree.subtree} == {
            *("/", "/atomistic", "/continuum", "/theory", "/theory/gap_flow", "/deviations", "/regime"),
            *("/theory/gap_flow/loading", "/theory/gap_flow/unloading"),
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
        table = compute_deviations(read_inputs(files).models, "pressure")
        # Read back, the fill value of a padded point is NaN.
        table["state"] = table["state"].where(table["state"] >= 0)
        xr.testing.assert_equal(tree["deviations"].to_dataset(), table)
    with xr.open_dataset(compared[0] / "a" / "comparison.nc", group="theory/gap_flow") as group:
        assert "applied_pressure" in group.coords, "a group stands by itself"


def test_report_holds_the_numbers(compared, files):
    page = (compared[0] / "r.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 5
    assert not re.search(r'(src|href)="(?!data:|#)', page), "nothing from outside"
    text = html.unescape(re.sub(r"<[^>]+>", "", page)).replace("\u00a0", " ")
    table = compute_deviations(read_inputs(files).models, "pressure")
    for value in table["relative_contact_area_relative_deviation"].values.ravel():
        if np.isfinite(value):
            assert percent(value) in text
    with xr.open_dataset(files[1], decode_timedelta=False) as atomistic:
        for value in atomistic["relative_contact_area"].values.ravel():
            if np.isfinite(value):
                assert f"{value:.4f}" in text
    for words in (
        "ε = 8 ε₀",
        "E = 77.2 GPa",
        "24 × 24 points",
        "160 × 160 atoms",
        "0.1, −0.4987, 0.7799, 5.8725 GPa",
        "a grid too coarse",
        "nearest to the atoms: the continuum (11 %), then the gap-flow theory (39 %), then Persson's theory (44 %)",
        "p/E* = −0.00532, 0.00832, 0.06265",
        "[surface]",
        "xr.open_datatree",
    ):
        assert words in text, words


def test_text_of_a_study_cannot_break_the_page(special):
    _, page = special
    assert "<script>" not in page
    assert "&lt;script&gt;&amp;" in page


def test_report_of_seeds_and_of_unconverged_steps(special):
    status, page = special
    assert status == 2
    assert "2 realisations (seed 1, 2)" in page
    assert " ± " in page
    assert "standard errors over seeds" in page
    assert "not converged" in page
    text = page.replace("\u00a0", " ")
    assert "for each point of the sweep at p/E* = 0.06265" in text, "the pressure of the path nearest to 5 GPa"
    assert "Not shown" not in text


def test_existing_files_are_kept_unless_told(compared, files, tmp_path, capsys):
    folder, _ = compared
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    figures = folder / "f"
    assert run(*files, "-o", folder / "a" / "comparison.nc") == 1
    assert run(*files, "-o", folder / "new.nc", "--figures", figures) == 1
    assert run(*files, "-o", folder / "new.nc", "--report", folder / "r.html") == 1
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 3
    assert all("--overwrite" in line for line in errors)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def test_overwriting_leaves_other_files_of_the_folder(files, tmp_path):
    (tmp_path / "f").mkdir()
    (tmp_path / "f" / "notes.txt").write_text("mine")
    (tmp_path / "f" / "figure_4_mean_gap.png").write_text("old")
    assert run(*files[:2], "-o", tmp_path / "c.nc", "--figures", tmp_path / "f", "--overwrite") == 0
    assert (tmp_path / "f" / "notes.txt").read_text() == "mine"
    assert (tmp_path / "f" / "figure_4_mean_gap.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        ([], "-o"),
        (["-o", "{}/c.nc", "--figure", "x"], "--figure"),
        (["-o", "{}/c.nc", "--reference-pressure", "1 nm"], "--reference-pressure"),
        (["-o", "{}/c.nc", "--report", "{}/c.nc"], "named twice"),
        (["-o", "{}"], "is a folder"),
    ],
)
def test_wrong_arguments_write_nothing(files, tmp_path, capsys, arguments, culprit):
    assert run(*files, *(argument.format(tmp_path) for argument in arguments)) == 1
    error = capsys.readouterr().err
    assert error.startswith("contact-compare: error: ")
    assert error.count("\n") == 1
    assert culprit in error
    assert not list(tmp_path.iterdir())


def test_an_input_is_never_the_output(files, capsys):
    before = files[0].read_bytes()
    assert run(*files, "-o", files[0], "--overwrite") == 1
    assert "is one of the datasets" in capsys.readouterr().err
    assert files[0].read_bytes() == before


def test_wrong_input_writes_nothing(files, tmp_path, capsys):
    assert run(files[0], "-o", tmp_path / "c.nc", "--figures", tmp_path / "f") == 1
    assert "at least two models" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_paths_without_a_common_point_are_refused(files, tmp_path, capsys):
    single = STUDY[: STUDY.index("[sweep]")]
    other = single.replace('"0.1 GPa", "0.7799 GPa", "5.8725 GPa"', '"0.3 GPa", "3 GPa"')
    paths = [write(tmp_path / "c.nc", "continuum", single), write(tmp_path / "a.nc", "atomistic", other)]
    assert run(*paths, "-o", tmp_path / "out.nc") == 1
    assert "no point of their loading paths in common" in capsys.readouterr().err
    assert not (tmp_path / "out.nc").exists()


def test_unconverged_input_gives_status_two_and_detachment_does_not(files, tmp_path, capsys):
    detached = write(tmp_path / "d.nc", "atomistic", unconverged=[(1, 1)], detached=[(1, 1)])
    assert run(files[0], detached, "-o", tmp_path / "one.nc") == 0
    failed = write(tmp_path / "f.nc", "atomistic", unconverged=[(0, 1)])
    assert run(files[0], failed, "-o", tmp_path / "two.nc") == 2
    assert "1 of the inputs' steps did not converge" in capsys.readouterr().err
    assert (tmp_path / "two.nc").exists()
