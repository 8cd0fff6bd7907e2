"""Numbers without a unit in a study file are taken in SI, and that is said."""

import tomllib

import pytest

from contact_study.study.study import make_study, read_study

STUDY = """
[surface]
kind = "self_affine"
size = "100 nm"
shape = [64, 64]
rms_height = "1 nm"
cutoff_mode = 12
[material]
youngs_modulus = "77 GPa"
poissons_ratio = 0.42
[interaction]
law = "hard_wall"
[loading]
path = ["1 GPa", "2 GPa"]
"""


def notes(folder, text=STUDY, **overrides):
    (folder / "study.toml").write_text(text)
    keys = {dotted.replace("__", "."): value for dotted, value in overrides.items()}
    return read_study(folder / "study.toml", keys).notes


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"77 GPa"', "2", "material.youngs_modulus = 2 is 2 Pa;"),
        ('"100 nm"', "[1e-7, 2e-7]", "surface.size = 1e-07 is 1e-07 m;"),
        ('["1 GPa", "2 GPa"]', "[1, 2]", "loading.path = 1 is 1 Pa;"),
        ('["1 GPa", "2 GPa"]', '[0, 1e-9]\ncontrol = "gap"', "loading.path = 1e-09 is 1e-09 m;"),
        ("[loading]", '[sweep]\n"material.youngs_modulus" = [1, 2]\n[loading]', "youngs_modulus = 1 is 1 Pa;"),
    ],
)
def test_bare_numbers_are_named_with_the_unit_they_are_taken_in(tmp_path, old, new, said):
    (line,) = notes(tmp_path, STUDY.replace(old, new))
    assert line.startswith("numbers without a unit are taken in SI: ")
    assert said in line
    assert "\n" not in line


def test_with_units_zero_and_from_python_nothing_is_said(tmp_path):
    assert notes(tmp_path, STUDY + '[sweep]\n"surface.seed" = [1, 2]\n"surface.rms_height" = ["1 nm", "2 nm"]\n') == ()
    assert notes(tmp_path, STUDY.replace('["1 GPa", "2 GPa"]', '[0]\ncontrol = "gap"')) == ()
    assert make_study(tomllib.loads(STUDY) | {"loading": {"path": [1e6]}}).notes == ()


def test_of_many_three_are_shown(tmp_path):
    text = STUDY.replace('"100 nm"', "1e-7").replace('"1 nm"', "1e-9").replace('"77 GPa"', "7.7e10")
    (line,) = notes(tmp_path, text.replace('["1 GPa", "2 GPa"]', "[1e9]"))
    assert line.count(" is ") == 3
    assert ", and 1 keys more; " in line


def test_exceptions_and_the_command_line_count_too(tmp_path):
    swept = STUDY + '[sweep]\n"surface.seed" = [1, 2]\n'
    exception = '[[override]]\nwhen = { "surface.seed" = 1 }\n"surface.rms_height" = 2\n'
    assert "surface.rms_height = 2 is 2 m" in notes(tmp_path, swept + exception)[0]
    assert "surface.size = 10 is 10 m" in notes(tmp_path, surface__size=10)[0]
