"""The scan of the constants of Persson's theory."""

import tomllib

import pytest

from contact_study import run
from contact_study.study.case import realise
from contact_study.study.study import make_study
from research import persson_choices
from theory import PerssonTheory


def test_choices_of_perssons_theory(capsys):
    """By hand: the default choice is the theory's own state; the best one is named."""
    dataset = run(
        {
            "surface": {
                "kind": "self_affine",
                "size": "20 nm",
                "shape": [32, 32],
                "rms_height": "0.5 nm",
                "roll_off_mode": 2,
                "cutoff_mode": 6,
            },
            "material": {"youngs_modulus": "50 GPa", "poissons_ratio": 0.3},
            "interaction": {"work_of_adhesion": "0.05 J/m^2", "length": "0.5 nm"},
            "loading": {"path": ["1 GPa"]},
            "sweep": {"interaction.well_depth_ratio": [1]},
        }
    )
    (choices,) = persson_choices.scan(dataset).values()
    assert len(choices) == 4 * 4 * 3 * 2
    case = make_study(tomllib.loads(dataset.attrs["study_toml"])).cases[0]
    theory = PerssonTheory(realise(case).measured_spectrum(), case.solid, case.law.work_of_adhesion)
    expected = abs(theory.at_pressure(1e9).relative_contact_area / dataset.relative_contact_area.item() - 1)
    default = next(one for one in choices if (one.alpha, one.beta, one.true_area, one.capped) == (1, 0.4, "persson", 0))
    assert default.deviation == pytest.approx(expected, rel=1e-12)
    assert len({one.deviation for one in choices}) > 20
    *_, words = persson_choices.table({1.0: choices}).splitlines()
    best = min(choices, key=lambda one: one.deviation)
    assert f"α = {best.alpha:g}, β = {best.beta:g}, area {best.true_area}" in words
