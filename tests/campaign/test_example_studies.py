import io
import os
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from contact_study.start import bem_adhesion, contact_compare
from contact_study.study.examples import example, example_names
from contact_study.study.study import read_study
from tests.campaign.conftest import fail

MEASURED = "measured"  # waits for the map of a user


@pytest.mark.parametrize("name", example_names())
def test_an_example_is_a_study(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert bem_adhesion(["init", name]) == 0
    assert capsys.readouterr().out == f"{name}.toml\n"
    if name == MEASURED:
        np.save(tmp_path / "afm.npy", np.random.default_rng(1).standard_normal((32, 32)))
    study = read_study(tmp_path / f"{name}.toml")
    assert study.cases
    assert study.title != "untitled study"
    assert bem_adhesion(["--example", name]) == 0  # its name in earlier versions
    assert capsys.readouterr().out == (tmp_path / f"{name}.toml").read_text()


def test_without_a_name_all_are_listed(capsys):
    assert bem_adhesion(["init"]) == bem_adhesion(["--example"]) == 0
    lines = capsys.readouterr().out.splitlines()
    listed = lines[1 : len(lines) // 2]
    assert listed == lines[len(lines) // 2 + 1 :]
    assert [line.split()[0] for line in listed] == example_names()
    assert {"first", "yang2008", "rubber", "sphere", MEASURED} <= {*example_names()}
    assert all(len(line.split()) > 2 for line in listed), "each with its title"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["yang208"], "unknown example yang208 (did you mean yang2008?); known: first,"),
        (["../keys"], "known: first,"),
        (["first", "-o", "mine.toml"], "mine.toml exists; use --overwrite"),
        (["-o", "other.toml"], "which example?"),
    ],
)
def test_what_is_no_example(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text("mine")
    assert bem_adhesion(["init", *arguments]) == 1
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("mine.toml", "mine")]
    assert bem_adhesion(["init", "first", "-o", "mine.toml", "--overwrite"]) == 0
    assert (tmp_path / "mine.toml").read_text() == example("first")


def test_the_sphere_comes_off_where_jkr_says():
    (case,) = read_study(Path(__file__).parents[2] / "contact_study/example_studies/sphere.toml").cases
    pull_off = -1.5 * np.pi * case.surface.radius * case.work_of_adhesion / np.prod(case.surface.size)
    assert f"here {pull_off / 1e6:.1f} MPa" in example("sphere").splitlines()[0]
    assert case.path[-2][0] > pull_off > case.path[-1][0]


def completions_of(line, monkeypatch, command):
    import argcomplete

    asked = {"_ARGCOMPLETE": "1", "COMP_LINE": line, "COMP_POINT": str(len(line)), "COMP_TYPE": "9"}
    asked |= {"_ARGCOMPLETE_IFS": "\n", "_ARGCOMPLETE_SUPPRESS_SPACE": "1"}
    monkeypatch.setattr(os, "fdopen", fail(OSError))  # it debugs into file 9, which is another's here
    for name, value in asked.items():
        monkeypatch.setenv(name, value)
    answer = io.StringIO()
    options = {"exit_method": fail(GeneratorExit), "output_stream": answer}  # no Exception: nothing catches it
    monkeypatch.setattr(argcomplete, "autocomplete", partial(argcomplete.CompletionFinder(), **options))
    with pytest.raises(GeneratorExit):
        command([])
    return [word.strip() for word in answer.getvalue().split("\n")]


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("bem-adhesion ru", "run"),
        ("bem-adhesion run study.toml --surface.rms", "--surface.rms_height"),
        ("bem-adhesion run study.toml --interaction.law hard", "hard_wall"),
        ("bem-adhesion study.toml --theory.spectrum an", "analytic"),
        ("bem-adhesion init yang2008_", "yang2008_quick"),
        ("contact-compare --sca", "--scatter"),
        ("bem-adhesion merge --al", "--along"),
    ],
)
def test_the_shell_completes_words_examples_and_verbs(line, offered, monkeypatch):
    pytest.importorskip("argcomplete")
    command = contact_compare if line.startswith("contact") else bem_adhesion
    assert completions_of(line, monkeypatch, command) == [offered]
