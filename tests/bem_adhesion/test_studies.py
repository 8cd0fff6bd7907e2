"""Whole studies, from the keys to the dataset and on from a shorter one: every law, solid, boundary and control."""

import json
import re
import warnings

import numpy as np
import pytest

import contact_study
from bem_adhesion.study import model
from contact_study.campaign import memory
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import quantity
from contact_study.results.observables import corrected_area
from contact_study.results.schema import COORDINATES, VARIABLES
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.bem_adhesion.paper_system import E_STAR, study_table
from tests.laws_of_all_kinds import EVERY_LAW, KEYS
from tests.recording import bins_of_case, recorded_path

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


def adaptive(control, path, **sections):
    loading = {"path": path, "control": control, "adaptive": True, "resolution": 0.02}
    return study_table(48, size=150e-10, surface={"rms_height": 4e-10}, loading=loading, **sections)


def viscoelastic(**sections):
    table = study_table(32, size=500e-10, interaction=HARD_WALL, loading={"path": [1e7], "duration": 1.0})
    return {**table, "material": {"youngs_modulus": 1e9, "poissons_ratio": 0.5}, "elasticity": TIMES, **sections}


def plastic(**sections):
    table = study_table(32, size=500e-10, interaction=HARD_WALL, loading={"path": [1e9]}, material={"hardness": 4e9})
    return {**table, **sections}


def varied(adhesion_map=None, **sections):
    stripes = {"kind": "patches", "modes": [0, 4], "contrast": 0.5}
    return study_table(32, size=500e-10, adhesion_map={**stripes, **(adhesion_map or {})}, **sections)


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
    "adaptive in time": viscoelastic(
        loading={"path": [12e-9, 2e-9, 2e-9, 6e-9], "control": "gap", "duration": 0.5, "adaptive": True},
        interaction={"law": "lennard_jones_10_4", "work_of_adhesion": 0.05, "length": 1e-9},
    ),
    "in time": viscoelastic(loading={"path": [1e7, 4e7, 4e7, 1e7], "duration": 0.5, "time_steps": 3}),
}


def run(table, **options):
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*(process zone|thinner than the grid|pulls at the rim)")
        return contact_study.run(table, "continuum", **options)


def shortened(table):
    return {**table, "loading": {**table["loading"], "path": table["loading"]["path"][:-1]}}


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
    found = run(STUDIES["plastic"])
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
    assert found.relative_contact_area[2] > 1.1 * found.relative_contact_area[1], "under constant load"


@pytest.mark.validation
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


@pytest.mark.parametrize(("way", "longest"), [(6e-10, 1.5e-10), (6e-8, 6e-10)])
def test_adaptive_steps_of_a_gap_are_no_longer_than_half_the_range_or_a_hundredth_of_the_way(way, longest):
    (case,) = make_study(adaptive("gap", [way + 1e-10, 1e-10], interaction=ATOMIC)).cases
    assert case.longest_step(*case.loading.path) == pytest.approx(longest, rel=1e-12)
    if way < 1e-9:
        passed = run(adaptive("gap", [way + 1e-10, 1e-10], interaction=ATOMIC)).passed_separation
        steps = np.abs(np.diff(passed.transpose("step", ...).stack(all=("step", ...)).dropna("all").values))
        assert 0.5 * longest < steps.max() <= longest * (1 + 1e-9)  # a half-space's separation is its mean gap


def overdamped(**sections):
    return study_table(32, size=80e-10, **{"solver": {"path": "overdamped"}, **sections})


def lattice(kind):
    table = study_table(32, loading={"path": [1e9]}, material={"lattice_constant": 2.6e-10})
    return {**table, "elasticity": {"kind": kind, **SOLIDS[kind]}}


ATOMIC = {"law": "lennard_jones_10_4", "work_of_adhesion": 0.05, "length": 3e-10}
RANDOM = {"kind": "random", "relative_rms": 0.3, "cutoff_mode": 16, "modes": None, "contrast": None}
HALF = {"material": {"poissons_ratio": 0.5}}
REFUSED = [
    (viscoelastic(loading={"path": [1e7]}), r"missing key loading\.duration"),
    (viscoelastic(loading={"path": [1e7, 2e7], "duration": [1.0]}), r"loading\.duration holds 1 times for 2 points"),
    (viscoelastic(loading={"path": [1e7], "duration": 0.0}), "must be positive"),
    (viscoelastic(solver={"path": "overdamped"}), r"solver\.path"),
    (viscoelastic(output={"stiffness": True}), r"output\.stiffness"),
    (viscoelastic(material={"youngs_modulus": 1e9, "poissons_ratio": 0.5, "hardness": 1e8}), r"material\.hardness"),
    (viscoelastic(elasticity={"kind": "half_space"}), r"loading\.duration.*no time"),
    (viscoelastic(elasticity={**TIMES, "boundary": "free"}), r"elasticity\.boundary"),
    (plastic(loading={"path": [1e9, 4e9]}), "4e[+]09 Pa is not below material.hardness = 4e[+]09"),
    (plastic(loading={"path": [0.0], "control": "gap"}), "gaps above zero"),
    (study_table(32, loading={"path": [-1e-9], "control": "gap"}, interaction=HARD_WALL), "leaves no gap between"),
    (plastic(loading={"path": [-1e-10], "control": "gap"}, interaction=ATOMIC), r"gaps above -[\d.]+e-11 m"),
    (overdamped(material={"hardness": 9e9}), r"material\.hardness: solver\.path"),
    (plastic(interaction=ATOMIC), r"material\.hardness", "atomistic"),
    (varied(interaction=HARD_WALL), 'adhesion_map.kind = "patches": interaction.law = "hard_wall" does not attract'),
    (varied(adhesion_map={"contrast": 1.0}), "adhesion_map: the work of adhesion vanishes"),
    (varied(adhesion_map={"modes": [0, 17]}), r"adhesion_map\.modes = \[0, 17\]: 17 patches along x need"),
    (varied(adhesion_map=RANDOM), r"adhesion_map\.cutoff_mode = 16: beyond"),
    (varied(), "adhesion_map", "atomistic"),
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


TIGHT, BY_GAP = {"solver": {"tolerance": 1e-11}}, {"loading": {"control": "gap", "path": [1e-9, 5e-10]}}


@pytest.mark.parametrize("sections", [TIGHT, {"interaction": HARD_WALL}, BY_GAP])
def test_steps_hold_the_schema_and_agree_with_their_fields(sections):
    own = {"loading": {"path": [0.5e9, 2e9], "unload": True}, "output": {"fields": True}, **sections}
    case = make_study(study_table(64, size=500e-10, **own)).cases[0]
    surface = realise(case)
    for step in recorded_path(case, model.solve_path(case, surface)):
        values, gap, pressure = step.values, step.fields["gap"], step.fields["pressure"]
        assert set(values) <= set(VARIABLES)
        assert values["residual"] < case.solver.tolerance
        assert values["mean_pressure"] == pytest.approx(pressure.mean())
        assert values["mean_gap"] == pytest.approx(gap.mean() - case.law.equilibrium_distance)
        assert values["relative_repulsive_area"] == np.mean(pressure > 0)
        touching = gap < case.contact_distance if case.law.attracts else pressure > 0
        assert 0 < values["relative_contact_area"] == touching.mean() < 1
        counted = corrected_area(touching) if case.law.has_wall else touching.mean()
        assert values["corrected_contact_area"] == counted
        assert np.sum(values["gap_pdf"] * np.diff(bins_of_case(case).gap_edges)) == pytest.approx(1)
    found = model.constants(case, surface)
    assert set(found) <= set(VARIABLES) | set(COORDINATES)
    assert found["contact_modulus"] == pytest.approx(E_STAR)
    assert found["work_of_adhesion"] == (0.69 if case.law.attracts else 0)
    assert found.get("process_zone", 41e-10) == pytest.approx(41e-10, rel=0.01)


def review(points, **sections):
    study = make_study(study_table(points, size=500e-10, **sections))
    return model.review(study, study.scales)


def test_the_grid_is_warned_of_once_a_study_with_ways_out():
    table = study_table(64, size=500e-10, sweep={"interaction.well_depth_ratio": [1, 4, 8], "surface.seed": [1, 2]})
    study = make_study(table)
    (note,) = model.review(study, study.scales)
    assert "(4 of 6 points of the sweep, such as well_depth_ratio = 4.0, seed = 1)" in note  # of process zone 10, 5 Å
    # The way that is named resolves the law of the strongest adhesion, and not by far.
    shape = json.loads(re.search(r"surface\.shape = (\[.*?\])", note)[1])
    for points, resolves in ((shape, True), ([n - 16 for n in shape], False)):
        changed = {**table, "surface": table["surface"] | {"shape": points}}
        assert (model.review(make_study(changed), make_study(changed).scales) == []) == resolves
    assert "interaction.length" not in note, "stiff contacts are not JKR-like: a longer range is another contact"


SOFT = {"material": {"youngs_modulus": 2e6, "poissons_ratio": 0.5}, "surface": {"size": 1e-4, "rms_height": 1e-6}}
SOFT_LAW = {"law": "exponential", "work_of_adhesion": 0.05, "contact_distance": None}


@pytest.mark.parametrize("given", ["auto", 7.4e-8])
def test_a_grid_beyond_this_machine_is_not_proposed(tmp_path, monkeypatch, given):
    monkeypatch.setattr(memory, "_memory", lambda: 1e6 * 100.0)
    rough = {**SOFT["surface"], "cutoff_mode": 64, "shape": [448, 448]}
    np.save(tmp_path / "map.npy", realise(make_study(study_table(448, surface=rough)).cases[0]).sampled)

    def notes(length, **keys):
        surface = {"kind": "file", "path": "map.npy", "size": 1e-4, **keys}
        law = {"law": "exponential", "work_of_adhesion": 0.05, "length": length}
        table = {"surface": surface, "material": SOFT["material"], "interaction": law, "loading": {"path": [1e4]}}
        study = make_study(table, tmp_path)
        return [note for note in model.review(study, study.scales) if "process zone" in note]

    (note,) = notes(given)
    number = r'interaction\.length = "(\S+ \S+)"'
    assert re.search(rf"cannot be resolved here: {number} on surface\.shape = \[\d+, \d+\] needs \S+ [MG]B; ", note)
    part = rf"take a part of the surface of up to (\S+ \S+) with {number} and surface\.shape = (\[.*?\])"
    widest, length, shape = re.search(part, note).groups()
    assert notes(length, crop=[[0, quantity(widest, "m", "")]] * 2, shape=json.loads(shape)) == []
    # What the grid at hand resolves, with its price.
    longer = quantity(re.search(rf"accept {number}", note)[1], "m", "")
    assert notes(longer) == [] != notes(0.95 * longer)
    tabor, pull_off = map(float, re.search(r"Tabor parameter (\S+), a sphere's pull-off \+(\S+) %", note).groups())
    assert 0.5 < tabor < 3
    # A range of a good part of the heights blurs them, which is said, to two digits.
    (share,) = re.findall(r" %, (\S+) of the rms height\)", note)
    assert float(share) == pytest.approx(longer / SOFT["surface"]["rms_height"], rel=0.05)
    assert 1 < pull_off < 20
    # A part of a few points is no part of a rough surface, nor a range longer than it is high a way out.
    monkeypatch.setattr(memory, "_memory", lambda: 1e4 * 100.0)
    assert "take a part" not in notes(given)[0]
    (note,) = review(64, surface={"size": 1e-3}, interaction={"length": 1e-9, "contact_distance": 1.2e-9})
    assert "cannot be resolved here" in note
    assert "accept" not in note


def test_grids_are_refused_or_said_to_trap_edges_by_their_points_a_process_zone():
    with pytest.raises(InputError, match=r"surface\.size, surface\.shape: .* beyond 100000"):
        review(64, surface={"size": 3.0})
    assert review(64, surface={"size": 3.0}, interaction=HARD_WALL) == review(64) == []  # 5.2 points
    for size in (1000e-10, 2250e-10):  # 2.6 and 1.15
        (note,) = review(64, surface={"size": size})
        assert "a quarter of the process zone" in note
        assert "slow loading" not in note
    (note,) = review(64, surface={"size": 3000e-10})  # 0.87
    assert "the process zone 4.1" in note
    assert "slow loading ends with up to" in note


def test_the_longest_range_of_rubber_is_proposed_with_the_shape_it_needs():
    soft, law = SOFT, SOFT_LAW | {"length": 3e-10}
    (note,) = review(64, interaction=law, **soft)
    proposed, shape = re.search(r'interaction\.length = "auto" \((.*?)\) on surface\.shape = (\[.*?\])', note).groups()
    assert re.search(r"\(0\.\d+ GB; Tabor parameter 3, a sphere's pull-off \+1\.\d %\) resolves it$", note)
    # What it proposes is taken without a further word; on the grid at hand only the points are asked for.
    longer = law | {"length": proposed}
    assert review(json.loads(shape)[0], interaction=longer, **soft) == []
    (other,) = review(64, interaction=longer, **soft)
    assert other.endswith(f"surface.shape = {shape} (0.47 GB) resolves it")
    # On finer grids a range that they resolve and that stays JKR-like is all that is proposed.
    (other,) = review(2304, interaction=law, **soft)
    assert re.search(r'interaction\.length = ".*?" of the same work of adhesion \(Tabor .*\) resolves it$', other)
    assert "surface.shape" not in other


def coated(thickness, base=None):
    of_base = {"base_youngs_modulus": base, "base_poissons_ratio": 0.42} if base else {}
    return {"elasticity": {"kind": "layered" if base else "layer", "thickness": thickness, **of_base}}


@pytest.mark.parametrize("base", [None, 100e9])
def test_a_layer_thinner_than_the_grid_is_said(base):
    thin, thick = ([note for note in review(48, **coated(size, base)) if "layer" in note] for size in (9e-10, 12e-10))
    assert "the layer of 9e-10 m is thinner than the grid spacing 1.04e-09 m" in thin[0]
    assert not thick


def test_the_process_zone_is_that_of_the_softest_wave():
    (note,) = review(64, **coated(20e-10, 7.72e9))
    zone = quantity(re.search(r"the process zone (\S+ \S+):", note)[1], "m", "")
    # The longest wave, 500 Å, is 25 times as long as the coating is thick, and its modulus not quite the base's.
    assert 4.1e-10 < zone < 1.5 * 4.1e-10
    assert review(64, **coated(20e-10, 772e9)) == []
