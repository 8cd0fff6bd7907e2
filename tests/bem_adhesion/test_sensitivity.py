"""Derivatives of a study's answers by its keys, against differences of whole runs; and what they correct."""

import copy
import warnings

import numpy as np
import pytest
import xarray as xr

import contact_study
from bem_adhesion import gradient, rough_contact
from bem_adhesion.study.sensitivity import sensitivity
from contact_study import InputError, make_study
from contact_study.command_line.program import main

STUDY = {
    "surface": {"kind": "self_affine", "size": 1e-6, "shape": [32, 32], "rms_height": 5e-9, "hurst_exponent": 0.8}
    | {"roll_off_mode": 2, "cutoff_mode": 6, "seed": 1},
    "material": {"youngs_modulus": 50e6, "poissons_ratio": 0.4},
    "interaction": {"law": "lennard_jones_10_4", "work_of_adhesion": 1e-3, "length": 3e-9},
    "loading": {"path": [1e5, 5e5]},
    "uncertainty": {
        "draws": 48,
        "material.youngs_modulus": {"distribution": "lognormal", "median": 50e6, "error": 5e6},
        "interaction.work_of_adhesion": {"distribution": "lognormal", "median": 1e-3, "error": 2e-4},
        "interaction.length": {"distribution": "uniform", "low": 2.5e-9, "high": 3.5e-9},
        "surface.rms_height": {"distribution": "normal", "error": 2e-10},
        "surface.hurst_exponent": {"distribution": "normal", "error": 0.02},
    },
}
pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse", "ignore:surface:")


def study(**sections):
    return make_study({**copy.deepcopy(STUDY), **sections})


@pytest.fixture(scope="module")
def central():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return sensitivity(study())


@pytest.mark.validation
def test_derivatives_are_differences_of_runs(central):
    for key in central["parameter"].values:
        section, name = str(key).split(".")
        table = {one: dict(content) for one, content in STUDY.items() if one != "uncertainty"}
        (at,), gaps = ([table[section][name]],), []
        for side in (-1, 1):
            table[section][name] = at[0] * (1 + side * 0.002)
            gaps.append(contact_study.run({**table, "solver": {"tolerance": 1e-11}})["mean_gap"].values)
        # Differences of second order in 0.2 % of a key, over curvatures of about one.
        expected = (gaps[1] - gaps[0]) / (0.004 * at[0])
        np.testing.assert_allclose(central["mean_gap_by_key"].sel(parameter=key), expected, rtol=1e-3)


def test_the_area_has_the_logarithmic_slopes_of_the_smoothed_one(central):
    case = make_study({name: content for name, content in STUDY.items() if name != "uncertainty"}).cases[0]
    contact = rough_contact(contact_study.realise(case).sampled, 1e-6, case.solid, case.law, tolerance=1e-10)
    by = gradient(contact, contact.step(contact.separated(), 1e5), "contact_area")
    found = central.sel(parameter="interaction.work_of_adhesion").isel(step=0, draw=0)
    expected = by.work_of_adhesion.sum() / by.value
    # The same state to its residual of 1e-10, and differences of the key of second order.
    slope = found["relative_contact_area_by_key"] / found["relative_contact_area"]
    assert float(slope) == pytest.approx(expected, 1e-5)


def test_one_simulation_has_the_intervals_of_all(central):
    draws = contact_study.run(copy.deepcopy(STUDY))
    bare = draws.drop_vars([*draws.data_vars])
    found, every = contact_study.uncertainty(bare, central), contact_study.uncertainty(draws)
    for name in ("mean_gap", "relative_contact_area"):
        changes = np.log(every[name] / every[name].sel(quantile=0.5))
        # An expansion of first order errs by the square of the change; an area counts points.
        assert (abs(np.log(found[name] / every[name])) < 0.02 + changes**2).all()
        assert (abs(changes).max() > 0.2).all()
    # A theory that is right but for a factor is corrected exactly at the centre, and bent by its own curvature.
    theory = draws.assign(mean_gap=2 * draws["mean_gap"])
    corrected = contact_study.uncertainty(theory, central)
    assert abs(corrected["mean_gap"] / every["mean_gap"] - 1).max() < 0.01
    assert "mean_gap_correction_error" not in corrected


@pytest.mark.parametrize(
    ("sections", "said"),
    [
        ({"uncertainty": {}}, "no section"),
        (
            {"uncertainty": {"draws": 8, "surface.seed": {"distribution": "values", "values": [1, 2]}}},
            "surface.seed: a",
        ),
        ({"material": {**STUDY["material"], "hardness": "1 GPa"}}, "plastic"),
        (
            {
                "elasticity": {"kind": "viscoelastic", "branch_youngs_moduli": [1e6], "relaxation_times": [1.0]},
                "loading": {"path": [1e5], "duration": 1.0},
            },
            "viscoelastic",
        ),
        ({"solver": {"path": "overdamped"}}, "overdamped"),
        ({"interaction": {**STUDY["interaction"], "contact_distance": "1 nm"}}, "contact_distance"),
        ({"sweep": {"surface.seed": [1, 2]}}, "surface.seed is swept"),
        (
            {
                "elasticity": {"kind": "layer", "thickness": "100 nm"},
                "uncertainty": {
                    "draws": 8,
                    "elasticity.thickness": {"distribution": "uniform", "low": "50 nm", "high": "90 nm"},
                },
            },
            "elasticity.thickness: changes the shape",
        ),
    ],
)
def test_what_has_no_derivative_is_said(sections, said):
    with pytest.raises(InputError, match=said):
        sensitivity(study(**sections))


@pytest.mark.validation
def test_the_command_simulates_once(tmp_path, capsys):
    quick = {"flows": "none", "spectrum": "analytic"}
    few = {**copy.deepcopy(STUDY), "theory": quick, "loading": {"path": [1e5]}}
    few["uncertainty"]["draws"] = 8
    assert contact_study.run(few, "theory", output=tmp_path / "theory.nc").sizes["draw"] == 9
    assert main("bem-adhesion", ["uncertainty", str(tmp_path / "theory.nc"), "--gradient"]) == 0
    assert "relative_contact_area" in capsys.readouterr().out
    both = ["uncertainty", str(tmp_path / "theory.nc"), "--gradient", "--anchors", str(tmp_path / "theory.nc")]
    assert main("bem-adhesion", both) == 1


def test_draws_of_atoms_have_no_gradient(tmp_path, capsys):
    coordinates = {"draw": [0], "applied_pressure": ("step", [1e5])}
    attributes = {"model": "atomistic", "study_toml": study().toml}
    atoms = xr.Dataset({"mean_gap": (("draw", "step"), [[1e-9]])}, coordinates, attributes)
    atoms.to_netcdf(tmp_path / "atoms.nc")
    assert main("bem-adhesion", ["uncertainty", str(tmp_path / "atoms.nc"), "--gradient"]) == 1
    assert "draws of atoms" in capsys.readouterr().err
