"""Whole studies, from the keys to the dataset and on from a shorter one: every law, solid, boundary and control."""

import warnings

import numpy as np
import pytest

import contact_study
from contact_study.inputs.errors import InputError
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.bem_adhesion.paper_system import study_table
from tests.laws_of_all_kinds import EVERY_LAW, KEYS

SOLIDS = {
    "layered": {"thickness": "1 nm", "base_youngs_modulus": "10 GPa", "base_poissons_ratio": 0.3},
    "transversely_isotropic": {"axial_modulus": "40 GPa", "axial_poissons_ratio": 0.2, "axial_shear_modulus": "12 GPa"},
    "tabulated": {"wavenumber": [1e8, 1e9, 1e10], "stiffness": [3e18, 3e19, 3e20]},
}
HARD_WALL = {"law": "hard_wall", "work_of_adhesion": None, "length": None, "contact_distance": None}
FREE = {
    "surface": {"kind": "sphere", "radius": 50e-9, "size": 20e-9, "shape": [32, 32]},
    "interaction": {"law": "exponential", "work_of_adhesion": 0.05, "length": "0.5 nm"},
    "material": {"youngs_modulus": 1e9, "poissons_ratio": 0.3},
    "elasticity": {"boundary": "free"},
}
LAYER = {
    "material": {"poissons_ratio": 0.3},
    "elasticity": {"kind": "layer", "thickness": "2 nm"},
    "loading": {"path": ["-3 nm", "1.2 nm", "0.2 nm", "0.1 nm"], "control": "approach"},
}
TIMES = {"kind": "viscoelastic", "branch_youngs_moduli": [5e9, "3 GPa"], "relaxation_times": ["1 s", 0.1]}


def on_layer(**sections):
    return study_table(32, size=200e-10, **{**LAYER, "surface": {"rms_height": 2e-10}, **sections})


def adaptive(control, path):
    loading = {"path": path, "control": control, "adaptive": True, "resolution": 0.02}
    return study_table(48, size=150e-10, surface={"rms_height": 4e-10}, loading=loading)


def viscoelastic(**sections):
    table = study_table(32, size=500e-10, interaction=HARD_WALL, loading={"path": [1e7], "duration": 1.0})
    return {**table, "material": {"youngs_modulus": 1e9, "poissons_ratio": 0.5}, "elasticity": TIMES, **sections}


def plastic(**sections):
    table = study_table(32, size=500e-10, interaction=HARD_WALL, loading={"path": [1e9]}, material={"hardness": 4e9})
    return {**table, **sections}


def free(**sections):
    return {**FREE, "loading": {"path": ["20 MPa"]}, **sections}


STUDIES = {
    "adhesive": study_table(32, size=500e-10, loading={"path": [0.5e9, 2e9, 0.5e9]}, output={"fields": True}),
    "wall": study_table(32, size=500e-10, interaction=HARD_WALL, loading={"path": [0.5e9, 2e9, 0.5e9]}),
    "approach": on_layer(),
    "approach to a wall": on_layer(interaction=HARD_WALL),
    "free": free(loading={"path": ["20 MPa", "-5 MPa"]}),
    "free approach": free(loading={"path": ["-2 nm", "0.5 nm", "-0.2 nm"], "control": "approach"}),
    "adaptive gap": adaptive("gap", [4e-10, 5e-11, 3e-10]),
    "plastic": plastic(loading={"path": [5e8, 2e9, 1e9, 5e8, 2e9]}, output={"stiffness": True}),
    "in time": viscoelastic(loading={"path": [1e7, 4e7, 4e7, 1e7], "duration": 0.5, "time_steps": 3}),
}


def run(table, **options):
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*(process zone|thinner than the grid|pulls at the rim)")
        return contact_study.run(table, "continuum", **options)


def shortened(table):
    keys = {key: value for key, value in table["loading"].items() if key != "unload"}
    return {**table, "loading": {**keys, "path": keys["path"][:-1]}}


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_meets_its_loads_and_is_gone_on_from_to_the_same_numbers(name, tmp_path):
    table = STUDIES[name]
    whole = run(table)
    assert np.all(whole.converged == 1)
    assert not whole.detached.any()
    assert ("contact_stiffness" in whole) == table.get("output", {}).get("stiffness", False)
    control = table["loading"].get("control", "pressure")
    applied = whole[f"applied_{control}"].values
    if control == "approach":
        (case,) = make_study(table).cases
        found = realise(case).sampled.max() - whole.mean_separation
        np.testing.assert_allclose(found, applied, atol=1e-7 * 3.28e-10, rtol=1e-7)
    else:
        np.testing.assert_allclose(whole["mean_pressure" if control == "pressure" else "mean_gap"], applied, rtol=1e-6)
    output = tmp_path / "path.nc"
    run(shortened(table), output=output)
    longer = run(table, output=output, resume=True)
    assert set(longer) == set(whole)
    for variable in set(whole) - {"wall_time"}:
        if whole[variable].dtype.kind in "fi":
            np.testing.assert_array_equal(longer[variable], whole[variable], err_msg=variable)


@pytest.mark.parametrize("name", KEYS)
def test_keys_make_every_law(name):
    table = study_table(32, interaction=HARD_WALL)
    table["interaction"] = {"law": name, **KEYS[name]}
    gap, law = np.geomspace(2.5e-10, 2e-9, 50), make_study(table).cases[0].law
    assert type(law) is type(EVERY_LAW[name])
    if name != "hard_wall":
        np.testing.assert_allclose(law.traction(gap), EVERY_LAW[name].traction(gap), rtol=1e-12)


def test_what_has_yielded_stays():
    found = run({**STUDIES["plastic"], "output": {"fields": True}})
    work = found.plastic_work.values
    assert 0 < 1.5 * work[0] < work[1]
    np.testing.assert_allclose(work[2:], work[1], rtol=1e-9, err_msg="up to where it was loaded nothing more yields")
    np.testing.assert_allclose(work, 4e9 * found.mean_plastic_indentation, rtol=1e-12)
    np.testing.assert_allclose(found.mean_gap - found.mean_separation, found.mean_plastic_indentation, atol=1e-21)


def test_contact_creeps_in_time():
    table = STUDIES["in time"]
    found = run({**table, "loading": {**table["loading"], "duration": [0.5, 0.2, 2.0, 0.3]}})
    np.testing.assert_allclose(found.time, [0.5, 0.7, 2.7, 3.0])
    assert np.all(np.diff(found.viscous_dissipation.values) > 0)
    area = found.relative_contact_area.values
    assert area[2] > 1.1 * area[1], "under constant load"


def test_adaptive_steps_dissipate_pull_off_and_keep_the_states_they_pass(tmp_path):
    path = [1e9, 0.1e9, -3e9]
    table = adaptive("pressure", path)
    whole = run(table)
    assert np.all(whole.converged == 1)
    assert np.all(np.diff(whole.dissipated_energy.values) >= 0)
    assert whole.dissipated_energy[0] > 0, "surfaces jump in"
    assert whole.detached.values.tolist() == [0, 0, 1]
    for point in whole.step.values[:2]:
        passed = whole.passed_separation.transpose("step", ...).sel(step=point).dropna("passed").values
        assert passed[-1] == pytest.approx(float(whole.mean_separation.sel(step=point)), rel=1e-12), "itself comes last"
    assert 0 < float(whole.pull_off_pressure_resolution_error) <= 0.02 * 3e9
    # The least step follows the largest pressure: a longer path computes the points before it again.
    output = tmp_path / "path.nc"
    run(shortened(table), output=output)
    with pytest.warns(UserWarning, match=r"the least step of loading\.adaptive follows the largest"):
        longer = contact_study.run(table, "continuum", output=output, resume=True)
    np.testing.assert_array_equal(longer.dissipated_energy, whole.dissipated_energy)
    np.testing.assert_array_equal(longer.mean_pressure, whole.mean_pressure)


def overdamped(**sections):
    return study_table(32, size=80e-10, **{"solver": {"path": "overdamped"}, **sections})


def lattice(kind):
    table = study_table(32, loading={"path": [1e9]}, material={"lattice_constant": 2.6e-10})
    return {**table, "elasticity": {"kind": kind, **SOLIDS[kind]}}


ATOMIC = {"law": "lennard_jones_10_4", "work_of_adhesion": 0.05, "length": 3e-10}
HALF = {"material": {"poissons_ratio": 0.5}}
REFUSED = [
    (viscoelastic(loading={"path": [1e7]}), r"missing key loading\.duration"),
    (viscoelastic(loading={"path": [1e7, 2e7], "duration": [1.0]}), r"loading\.duration holds 1 times for 2 points"),
    (viscoelastic(loading={"path": [1e7], "duration": 0.0}), "must be positive"),
    (viscoelastic(loading={"path": [1e7], "duration": 1.0, "adaptive": True}), r"loading\.adaptive"),
    (viscoelastic(solver={"path": "overdamped"}), r"solver\.path"),
    (viscoelastic(output={"stiffness": True}), r"output\.stiffness"),
    (viscoelastic(material={"youngs_modulus": 1e9, "poissons_ratio": 0.5, "hardness": 1e8}), r"material\.hardness"),
    (viscoelastic(elasticity={"kind": "half_space"}), r"loading\.duration.*no time"),
    (viscoelastic(elasticity={**TIMES, "boundary": "free"}), r"elasticity\.boundary"),
    (plastic(loading={"path": [1e9, 4e9]}), "4e[+]09 Pa is not below material.hardness = 4e[+]09"),
    (plastic(loading={"path": [0.0], "control": "gap"}), "gaps above zero"),
    (study_table(32, loading={"path": [-1e-9], "control": "gap"}, interaction=HARD_WALL), "leaves no gap between"),
    (plastic(interaction={"law": "dugdale", "length": 1e-10, "work_of_adhesion": 0.1}), "hard_wall"),
    (free(loading={"path": ["1 nm"], "control": "gap"}), r'control = "gap": .*"pressure" or "approach"'),
    (free(loading={"path": ["1 nm"], "control": "approach"}, elasticity={}), r'"approach": .*"pressure" or "gap"'),
    (
        free(elasticity={"boundary": "free", "kind": "layer", "thickness": 1e-8}),
        r'elasticity\.boundary = "free": known of kind = "half_space" and "transversely_isotropic" only',
    ),
    (on_layer(elasticity={"kind": "half_space", "thickness": None}), '"half_space" by no finite distance'),
    (on_layer(**HALF), '"layer" not at all, being incompressible.*"pressure" or "gap"'),
    (on_layer(elasticity={"kind": "layered", **SOLIDS["layered"]}), '"layered" by no finite'),
    (overdamped(loading={"control": "gap", "path": [1e-10]}), 'loading.control = "gap".*solver.path'),
    (overdamped(elasticity={"boundary": "free"}), 'elasticity.boundary = "free".*periodic'),
    (overdamped(loading={"path": [1e9], "adaptive": True}), "loading.adaptive = true.*overdamped"),
    (viscoelastic(), "viscoelastic", "theory"),
    (viscoelastic(interaction=ATOMIC), "viscoelastic", "atomistic"),
    (plastic(), r"material\.hardness", "theory"),
    (free(), r'elasticity\.boundary = "free"', "theory"),
    (free(interaction={**ATOMIC, "length": "0.5 nm"}), r'elasticity\.boundary = "free"', "atomistic"),
    (on_layer(), r'loading\.control = "approach"', "theory"),
    (on_layer(), r'loading\.control = "approach"', "atomistic"),
    (lattice("layered"), 'elasticity.kind = "layered"', "atomistic"),
    (lattice("tabulated"), 'elasticity.kind = "tabulated"', "atomistic"),
    (lattice("transversely_isotropic"), 'elasticity.kind = "transversely_isotropic"', "atomistic"),
]


@pytest.mark.parametrize("refused", REFUSED)
def test_what_does_not_fit_is_one_clear_line(refused):
    table, words, kind = (*refused, "continuum")[:3]
    with pytest.raises(InputError, match=words) as caught:
        contact_study.run(table, kind)
    assert "\n" not in str(caught.value)
