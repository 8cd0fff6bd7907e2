"""The example studies that come with the package: --example, and what the shell completes."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from bem_adhesion.run import MODEL
from contact_study.campaign.command import main
from contact_study.campaign.examples import example, example_names
from contact_study.problem.study import read_study

MEASURED = "measured"  # waits for the map of a user


@pytest.mark.parametrize("name", example_names())
def test_an_example_is_a_study(name, tmp_path, capsys):
    assert main(MODEL, ["--example", name]) == 0
    printed = capsys.readouterr().out
    (tmp_path / "study.toml").write_text(printed)
    if name == MEASURED:
        np.save(tmp_path / "afm.npy", np.random.default_rng(1).standard_normal((32, 32)))
    study = read_study(tmp_path / "study.toml")
    assert study.cases
    assert study.title != "untitled study"


def test_without_a_name_all_are_listed(capsys):
    assert main(MODEL, ["--example"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == example_names()
    assert {"first", "yang2008", "rubber", "sphere", MEASURED} <= {*example_names()}
    assert all(len(line.split()) > 2 for line in lines), "each with its title"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--example", "yang208"], "--example yang208: unknown (did you mean yang2008?); known: first,"),
        (["--example", "../keys"], "known: first,"),
        (["--example", "first", "-o", "first.toml"], "--example NAME > study.toml"),
        (["study.toml", "--example", "first"], "--example NAME > study.toml"),
    ],
)
def test_what_is_no_example(arguments, words, capsys):
    assert main(MODEL, arguments) == 1
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.out == ""
    assert captured.err.count("\n") == 1


def test_the_sphere_comes_off_where_jkr_says():
    """The pull-off pressure that the first line names, -3/2 pi R w over the cell, is between the last points."""
    table = read_study(Path(__file__).parents[2] / "contact_study/example_studies/sphere.toml")
    (case,) = table.cases
    pull_off = -1.5 * np.pi * case.surface.radius * case.work_of_adhesion / np.prod(case.surface.size)
    assert f"here {pull_off / 1e6:.1f} MPa" in example("sphere").splitlines()[0]
    before, after = [value for value, _ in case.path[-2:]]
    assert before > pull_off > after


def completions(line, tmp_path):
    """What the shell is offered behind a line."""
    command = Path(sys.executable).with_name(line.split()[0])
    answer = tmp_path / "answer"
    shell = {"_ARGCOMPLETE": "1", "COMP_LINE": line, "COMP_POINT": str(len(line)), "COMP_TYPE": "9"}
    shell |= {"_ARGCOMPLETE_STDOUT_FILENAME": str(answer), "_ARGCOMPLETE_IFS": "\n", "_ARGCOMPLETE_SUPPRESS_SPACE": "1"}
    subprocess.run([command], env={**os.environ, **shell}, cwd=tmp_path, check=False, capture_output=True)
    return answer.read_text().split("\n") if answer.exists() else []


def test_the_shell_completes_keys_and_examples(tmp_path):
    pytest.importorskip("argcomplete")
    assert "--surface.rms_height" in completions("bem-adhesion study.toml --surface.rms", tmp_path)
    assert "hard_wall" in completions("bem-adhesion study.toml --interaction.law hard", tmp_path)
    assert completions("bem-adhesion study.toml --theory.spectrum an", tmp_path) == ["analytic"]
    assert completions("bem-adhesion --example yang", tmp_path) == ["yang2008", "yang2008_quick"]
    assert "--scatter" in completions("contact-compare --sca", tmp_path)[0]
    assert "--along" in completions("contact-merge --al", tmp_path)[0]
