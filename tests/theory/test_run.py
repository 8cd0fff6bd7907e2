"""The theories along a loading path: names of the schema, restarts, gap control, branches, mistakes of input."""

import copy
import dataclasses
import re
import warnings
from itertools import product

import numpy as np
import pytest

from contact_study.inputs.errors import InputError
from contact_study.results.schema import COORDINATES, VARIABLES
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.recording import bins_of_case, recorded_path
from tests.study.test_study import SURFACE, of_another_kind
from theory.criteria import stickiness
from theory.edge_flow.apparent_adhesion import AREA_ERRORS, Extrapolated
from theory.edge_flow.flow import edge_flow
from theory.gap_flow.flow import gap_flow
from theory.non_adhesive import closed_forms
from theory.numerics.background import BackgroundExecutor
from theory.persson import theory as persson
from theory.persson.interface import true_area_factor
from theory.persson.separation import NegativeSeparation, NotConverged
from theory.persson.theory import PerssonTheory
from theory.study import case_theories, paths
from theory.study import model as run

STUDY = {
    "surface": SURFACE | {"size": "416 angstrom", "roll_off_mode": 3, "cutoff_mode": 12},
    "material": {"youngs_modulus": "77.2 GPa", "poissons_ratio": 0.42},
    "interaction": {"work_of_adhesion": "1.4 J/m^2", "length": "3.28 angstrom", "contact_distance": "3.68 angstrom"},
    "loading": {"path": ["1 GPa", "5 GPa"], "unload": True},
    "theory": {"spectrum": "analytic"},
}


def study_of(**sections):
    table = copy.deepcopy(STUDY)
    if "kind" in sections.get("surface", {}):
        of_another_kind(table)
    for name, keys in sections.items():
        table.setdefault(name, {}).update(keys)
    return make_study(table)


def case_of(*path, flows="none", **sections):
    """A case of Persson's theory alone unless flows are asked for, with another path if one is given."""
    theory = {"flows": flows} | sections.pop("theory", {})
    if path:
        sections["loading"] = sections.get("loading", {}) | {"path": list(path), "unload": False}
    return study_of(theory=theory, **sections).cases[0]


def steps_of(case, **start):
    return recorded_path(case, run.solve_path(case, realise(case), **start))


def values_of(case, **start):
    return [step.values for step in steps_of(case, **start)]


def constants_of(case):
    return run.constants(case, realise(case))


def assert_same(one, other, names=None):
    for name in names or other:
        assert np.array_equal(one[name], other[name], equal_nan=not isinstance(other[name], str)), name


BOTH = ["gap_flow", "edge_flow"]


@pytest.fixture(scope="module")
def case():
    return case_of(flows=BOTH)


@pytest.fixture(scope="module")
def steps(case):
    return steps_of(case)


def test_names_are_those_of_the_schema(case, steps):
    names = {name.rpartition("/")[2] for name in [*steps[0].values, *constants_of(case)]}
    assert names <= set(VARIABLES) | set(COORDINATES)
    groups = {name.rpartition("/")[0] for name in steps[0].values}
    branches = {f"{flow}/{branch}" for flow in BOTH for branch in ("loading", "unloading")}
    assert groups == {"", "persson", *BOTH, *branches}
    assert all(step.values.keys() == steps[0].values.keys() for step in steps)


@pytest.mark.validation
def test_branches_of_the_edge_flow():
    case = case_of("1 GPa", flows="edge_flow", interaction={"well_depth_ratio": 6})
    constants, steps = constants_of(case), steps_of(case)
    assert constants["apparent_adhesion_ratio"] > 1
    assert constants["edge_flow/area_error_in_atlas"] == AREA_ERRORS["loading"]
    assert constants["edge_flow/unloading/area_error_in_atlas"] == AREA_ERRORS["unloading"]
    assert constants["edge_flow/unloading/pull_off_pressure"] < constants["edge_flow/loading/pull_off_pressure"] < 0
    assert constants["edge_flow/unloading/work_of_separation"] > constants["edge_flow/work_of_separation"] > 0
    for step in steps:
        area, loading, unloading = (
            step.values[f"edge_flow{branch}/relative_contact_area"] for branch in ("", "/loading", "/unloading")
        )
        assert unloading > loading == area


def test_beyond_simulated_loops_the_edge_flow_warns_and_has_no_error():
    case = case_of("1 GPa", flows="edge_flow", interaction={"well_depth_ratio": 9})
    theories = case_theories.CaseTheories(case, realise(case).spectrum)
    with pytest.warns(Extrapolated, match=r"x = 2\.52 .* end at 2\.25; check Γ = 1\.43"):
        assert np.isnan([theories.area_error(branch) for branch in AREA_ERRORS]).all()


def test_values_are_consistent(case, steps):
    spectrum, bins = realise(case).spectrum, bins_of_case(case)
    factor = true_area_factor(np.array(spectrum.rms_slope))
    for (applied, _), step in zip(case.path, steps, strict=True):
        values = step.values
        area = values["persson/relative_contact_area"]
        assert values["persson/converged"]
        assert values["persson/mean_pressure"] == applied
        assert values["contact_stress"] > 0 > values["edge_stress"]
        assert values["persson/stress_balance"] == pytest.approx(1, abs=1e-3)
        # The bins leave out more tension than the law can exert, since the paper's detachment stress is not capped.
        held = np.sum(values["persson/pressure_pdf"]) * np.diff(bins.pressure_edges)[0]
        assert held == pytest.approx(area, rel=0.01)
        assert values["relative_contact_area_at"][-1] == pytest.approx(area, rel=1e-12)
        assert values["persson/interaction_energy"] == pytest.approx(-1.4 * area * factor, rel=1e-6)
        assert 0 < values["persson/elastic_energy"] < spectrum.full_contact_energy(case.solid.stiffness)
        assert values["gap_flow/mean_pressure"] == pytest.approx(applied, rel=1e-9)
        # Mean traction and slope of the energy balance to second order in the gap's nodes: 1e-6 of the modulus here.
        assert values["gap_flow/residual"] < 1e-5
        # The spline's root is found between points of its slope, 16 from one mean gap to the next.
        assert values["edge_flow/mean_pressure"] == pytest.approx(applied, rel=1e-3)
        assert values["edge_flow/converged"]
        for theory, name in product(BOTH, ("pressure_pdf", "gap_pdf")):
            assert values[f"{theory}/{name}"] @ np.diff(bins.edges_of[name]) == pytest.approx(1, abs=2e-3)
    # Persson's theory has one state at each pressure above zero, up to the iteration's tolerance.
    first, last = (steps[number].values["persson/relative_contact_area"] for number in (0, 2))
    assert last == pytest.approx(first, rel=1e-4)


def test_a_state_whose_stresses_do_not_balance_is_flagged_with_a_remedy(monkeypatch):
    diffuse = persson.diffuse
    monkeypatch.setattr(persson, "diffuse", lambda *given: dataclasses.replace(diffuse(*given), edge_stress=0.0))
    with pytest.warns(NotConverged, match="times the pressure"):
        (values,) = values_of(case_of("1 GPa"))
    assert not values["persson/converged"]
    assert values["persson/stress_balance"] == pytest.approx(values["contact_stress"] / 1e9)
    assert values["persson/message"].startswith("contact and edges carry")
    assert "use more cells" in values["persson/message"]


@pytest.mark.validation
def test_threads_and_a_restart_change_no_bit(steps):
    several = case_of(flows=BOTH, solver={"threads": 3})
    for start in (0, 1):
        again = values_of(several, restart=steps[0].restart if start else None, start=start)
        for one, other in zip(again, steps[start:], strict=True):
            assert_same(one, other.values)


@pytest.mark.validation
def test_prescribed_gap_is_the_inverse_of_prescribed_pressure(steps):
    there = steps[0].values
    gap = {"loading": {"control": "gap"}}
    asked = there["persson/mean_gap"], 2e-8, -1e-11
    one, far, close = values_of(case_of(*asked, flows="gap_flow", theory={"magnifications": 3}, **gap))
    # The curve down to another lowest pressure has other nodes: its own accuracy.
    assert one["persson/mean_pressure"] == pytest.approx(1e9, rel=2e-3)
    assert far["gap_flow/relative_contact_area"] < 1e-12
    assert not close["persson/converged"]
    assert "no pressure" in close["persson/message"]
    assert close["persson/mean_gap"] == asked[2]
    assert close["gap_flow/relative_contact_area"] > 0.9
    assert close["pressure_pdf_at"].shape[0] == 3
    assert np.isnan(close["pressure_pdf_at"]).all()
    for theory, accuracy in (("gap_flow", 1e-6), ("edge_flow", 2e-3)):  # other mean gaps under the spline
        (values,) = values_of(case_of(there[f"{theory}/mean_gap"], flows=theory, **gap))
        assert values[f"{theory}/mean_pressure"] == pytest.approx(1e9, rel=accuracy)
        area = f"{theory}/relative_contact_area"
        assert values[area] == pytest.approx(there[area], rel=accuracy)


def test_what_the_edge_flow_does_not_find_is_said():
    case = case_of("1 GPa", "5 GPa", "-8 GPa")
    flow = edge_flow(realise(case).spectrum, case.solid, case.law, gaps=60, scales=16, iterations=3)
    with pytest.warns(NotConverged, match=r"edge flow: \d+ of \d+ mean gaps"):
        values = list(map(paths._edge_flow_values(case, flow, BackgroundExecutor(1), 0), range(3)))
    assert not any(step["edge_flow/converged"] for step in values)
    assert np.isnan(values[0]["edge_flow/mean_pressure"])  # the curve is full contact's, at larger pressures
    assert not values[0]["edge_flow/detached"]
    assert values[-1]["edge_flow/detached"]
    beyond = next(step for step in values if np.isnan(step["edge_flow/mean_pressure"]))
    assert np.isnan(beyond["edge_flow/relative_contact_area"])
    strong = r"too strong for the edge flow \(0\.1 of the energy of full contact"
    assert re.search(strong + ".* 0.58 times the finest wave's.*; use a lower pressure", beyond["edge_flow/message"])
    with pytest.raises(ValueError, match=strong):
        flow.at_pressure(1e13)


def test_large_gaps_take_light_loads():
    weak = {"interaction": {"work_of_adhesion": "0.01 J/m^2"}, "loading": {"control": "gap"}}
    case = case_of("45 angstrom", **weak)  # the first sweep ends at 6 h_rms or so
    (values,) = values_of(case)
    assert values["persson/converged"]
    decay, prefactor = closed_forms.low_pressure_asymptote(realise(case).spectrum, case.material.contact_modulus)
    # Adhesion this weak moves the separation by less than a tenth of its decay length.
    assert values["persson/mean_pressure"] == pytest.approx(prefactor * np.exp(-45e-10 / decay), rel=0.1)


def test_tension_follows_the_adhered_branch_and_detaches():
    strong = {"interaction": {"work_of_adhesion": "14 J/m^2"}}
    case = case_of("1 GPa", "-1 GPa", "-30 GPa", "-1 GPa", flows="gap_flow", **strong)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pressed, pulled, lost, after = values_of(case)
    assert 0 < pulled["persson/relative_contact_area"] < pressed["persson/relative_contact_area"]
    assert not pulled["persson/detached"]
    assert not any("edge_flow" in name for name in pulled)
    assert after["persson/detached"]  # what has come off stays off without pressure
    # A block that has come off is the same in every model, but that this theory has no mean gap under tension.
    assert np.isnan([pulled["persson/mean_gap"], lost["persson/mean_gap"]]).all()
    assert lost["gap_flow/mean_gap"] == np.inf
    shared = ("mean_pressure", "relative_contact_area", "elastic_energy", "interaction_energy", "pressure_pdf")
    for group in ("persson/", "gap_flow/"):
        assert lost[group + "converged"]
        assert lost[group + "detached"]
        assert not any(np.any(lost[group + name]) for name in (*shared, "residual"))
    others = ("edge_stress", "contact_stress", "relative_contact_area_at", "detachment_stress", "gap_flow/gap_pdf")
    assert not any(np.any(lost[name]) for name in (*others, "gap_flow/relative_repulsive_area"))
    assert {name: np.shape(value) for name, value in lost.items()} == {k: np.shape(v) for k, v in pulled.items()}


def test_every_state_of_an_unconverged_branch_is_flagged(monkeypatch):
    case = case_of("1 GPa", "-2 GPa", flows="gap_flow")

    cut = lambda *given: gap_flow(*given, iterations=3 if "loading" in given else 60)  # noqa: E731
    monkeypatch.setattr(case_theories, "gap_flow", cut)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NegativeSeparation)
        with pytest.warns(NotConverged, match=r"gap flow, loading: \d+ of \d+ steps of the roughness"):
            held, lost = values_of(case)
    assert lost["gap_flow/loading/detached"]
    for values, (branch, sound) in product((held, lost), {"loading/": False, "": True, "unloading/": True}.items()):
        assert values[f"gap_flow/{branch}converged"] is sound
    with pytest.warns(NotConverged, match="gap flow, loading"):  # its pull-off pressure rests on the same steps
        constants_of(case)


def test_two_spectra_stand_side_by_side_and_are_those_of_one_alone():
    kinds = ["analytic", "surface"]
    weak = {"interaction": {"work_of_adhesion": "0.3 J/m^2"}}  # quickly solved
    cases = [case_of("1 GPa", "2 GPa", theory={"spectrum": asked}, **weak) for asked in (kinds, *kinds)]
    found, constants = [steps_of(each) for each in cases], [constants_of(each) for each in cases]
    for step, target, measured in zip(*found, strict=True):
        assert_same(step.values, target.values)
        labelled = [name for name in measured.values if "/" in name]
        others = {name: step.values[name.replace("/", "@surface/", 1)] for name in labelled}
        assert_same(others, measured.values, labelled)
        assert len(step.values) == len(target.values) + len(labelled)
        assert measured.values["persson/mean_gap"] != target.values["persson/mean_gap"]
    together, analytic, surface = constants
    assert_same(together, analytic)
    heights = [1e-9, realise(cases[0]).rms_height]
    assert [analytic["rms_height"], surface["rms_height"]] == pytest.approx(heights, rel=1e-9)
    assert together["persson@surface/pull_off_pressure"] == surface["persson/pull_off_pressure"]
    (resumed,) = values_of(cases[0], restart=found[0][0].restart, start=1)
    assert_same(resumed, found[0][1].values)


def test_a_warning_names_its_spectrum_once_a_cause_and_a_gap_that_rests_on_unconverged_states_is_flagged():
    def heard(most, *asked):
        strong = {"interaction": {"work_of_adhesion": "8 J/m^2"}, "solver": {"max_iterations": most}}
        case = case_of("70 GPa", "0.1 GPa", theory={"spectrum": list(asked)}, **strong)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            constants_of(case)
            found = values_of(case)
        return [(item.category, str(item.message)) for item in caught], found

    # 5 iterations at 0.1 GPa and 3 at 70 GPa, but 10 to 14 from 1 to 3 GPa.
    alone, (heavy, light) = heard(8, "analytic")
    assert not any("spectrum" in words for _, words in alone)
    assert (heavy["persson/converged"], light["persson/converged"]) == (True, False)
    assert light["persson/iterations"] < 8
    assert "mean gap" in light["persson/message"]
    both, _ = heard(5, "analytic", "surface")
    for kind in ("analytic", "surface"):
        of_it = [(category, words) for category, words in both if words.startswith(f'spectrum "{kind}": ')]
        causes = [(category, words.split(": ")[1].split(" down to")[0]) for category, words in of_it]
        assert {(NegativeSeparation, "mean separation"), (NotConverged, "mean gap")} <= set(causes)
        assert len(causes) == len(set(causes))
    assert all(words.startswith("spectrum ") for _, words in both)


WAVY = {"kind": "wavy", "amplitude": "1 nm"}
TABLE = {"spectrum": "table", "wavevectors": [1e8, 2e8], "density": [1e-34, 1e-34]}


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"theory": {"flows": ["none", "gap_flow"]}}, r'theory\.flows: "none"'),
        ({"theory": {"spectrum": []}}, r"theory\.spectrum.*empty"),
        ({"theory": {"spectrum": ["surface", "surface"]}}, r"theory\.spectrum.*twice"),
        ({"theory": {"spectrum": "table"}}, "theory.wavevectors"),
        ({"theory": {"spectrum": "table", "wavevectors": [1e8, 2e8]}}, "theory.density"),
        ({"theory": TABLE | {"wavevectors": [2e8, 1e8]}}, "theory.wavevectors: must rise"),
        ({"theory": TABLE | {"density": [1e-34]}}, "theory.density"),
        ({"theory": TABLE | {"density": [1e-34, -1e-34]}}, "theory.density"),
        ({"surface": WAVY, "theory": {"spectrum": ["surface", "analytic"]}}, "analytic"),
        ({"surface": {"kind": "flat"}, "theory": {"spectrum": "analytic"}}, r"surface\.kind"),
        (
            {"flows": "edge_flow", "loading": {"path": ["1 GPa", "1e6 GPa"], "unload": False}},
            r"loading\.path: 1e\+06 GPa presses .* nodes reach .* give lower pressures",
        ),
        (
            {"flows": "edge_flow", "loading": {"control": "gap", "path": ["1 nm", "-0.3 nm"], "unload": False}},
            r"loading\.path: a mean gap of -0\.3 nm beyond equilibrium .* nodes begin at .* at 3\.28e-10 m",
        ),
    ],
)
def test_what_no_theory_can_do_is_named(keys, message):
    with pytest.raises(InputError, match=message):  # noqa: PT012
        case = case_of(**keys)
        run.check(case)
        constants_of(case)


def test_the_spectrum_of_the_surface_comes_first():
    named = copy.deepcopy(STUDY)
    named.pop("theory")
    assert make_study(named).cases[0].spectra == ("surface", "analytic")
    of_another_kind(named)
    named["surface"] |= WAVY
    assert make_study(named).cases[0].spectra == ("surface",), "a wave has no target"


def test_criteria_of_sticking_and_pull_off_are_constants_of_the_case(case):
    found = constants_of(case)
    expected = stickiness(realise(case).spectrum, case.solid, case.law)
    assert found["bearing_area_ratio"] == expected.bearing_area
    assert found["local_tabor_number"][-1] == pytest.approx(found["finest_tabor_number"], rel=1e-12)
    assert found["gap_flow/pull_off_pressure"] < found["edge_flow/pull_off_pressure"] < 0
    assert found["persson/pull_off_pressure"] == found["energy_defect"] == 0


def test_hard_wall_has_persson_only():
    case = case_of("1 GPa", flows=BOTH, interaction={"law": "hard_wall"})
    (values,) = values_of(case)
    assert not any("flow" in name for name in values)
    assert values["persson/interaction_energy"] == 0 < values["persson/relative_contact_area"] < 1
    assert "bearing_area_ratio" not in constants_of(case)


def test_tolerance_of_the_case_is_that_of_the_state():
    # 1 GPa is a state of the separation curve, from which it starts solved.
    (_, tight), (_, loose) = (
        values_of(case_of("1 GPa", "2 GPa", solver=solver)) for solver in ({"tolerance": 1e-11}, {})
    )
    assert tight["persson/converged"]
    assert tight["persson/residual"] <= 1e-11 < loose["persson/residual"] <= 1e-8
    assert tight["persson/iterations"] > loose["persson/iterations"]


def test_choices_of_the_study_are_those_of_the_theory(case):
    choices = {"energy_weight": "wang_mueser", "beta": 0.45, "true_area": "lattice", "alpha": 0.5}
    chosen = case_of(theory=choices | {"cap_detachment_stress": True})
    theory = case_theories.case_theories(chosen, realise(chosen))[0].persson
    for name, value in (choices | {"stress_cap": case.law.peak_tensile_stress}).items():
        assert getattr(theory, name) == value != getattr(PerssonTheory, name)


def test_roughness_that_adhesion_dwarfs_is_refused_and_spectra_far_above_the_law_are_said():
    def review(**sections):
        study = study_of(**sections)
        return run.review(study, study.scales)

    assert review() == []
    # A cap on the tension is a cap on the detachment stress.
    assert review(theory={"alpha": 1e6, "cap_detachment_stress": True}) == []
    for refused in ({"surface": {"size": "3 m"}}, {"theory": {"alpha": 1e6}}):
        with pytest.raises(InputError, match="the limit is 300"):
            review(**refused)
    (note,) = review(surface={"size": "3 m", "rms_height": "3 cm"})
    assert "times interaction.length: the theories leave out all roughness below it" in note


def test_a_layer_is_held_by_its_base():
    case = case_of(1e9, flows="gap_flow", elasticity={"kind": "layer", "thickness": 5e-9})
    (values,) = values_of(case)
    compression = case.solid.mean_compliance * 1e9
    for theory in ("persson", "gap_flow", "gap_flow/loading"):
        apart = values[f"{theory}/mean_gap"] - values[f"{theory}/mean_separation"]
        assert apart == pytest.approx(compression, rel=1e-9)
        assert apart > 0
    stored = case_theories.case_theories(case, realise(case))[0].persson.at_pressure(1e9).elastic_energy
    assert values["persson/elastic_energy"] == pytest.approx(stored + 0.5 * compression * 1e9, rel=1e-6)


def test_stress_is_kept_at_as_many_magnifications_as_asked():
    case = case_of("1 GPa", "-8 GPa", theory={"magnifications": 5, "spectrum": ["analytic", "surface"]})
    held, lost = values_of(case)
    zeta = constants_of(case)["magnification"]
    np.testing.assert_allclose(zeta, 12 ** np.linspace(0.2, 1, 5), rtol=1e-9)
    wavevectors = np.geomspace(1, 12, held["relative_contact_area_at"].size)
    areas = np.interp(np.log(zeta), np.log(wavevectors), held["relative_contact_area_at"])
    masses = held["pressure_pdf_at"] @ np.diff(bins_of_case(case).pressure_edges)
    assert masses == pytest.approx(areas, rel=0.01)  # of the interpolation between magnifications
    assert not lost["pressure_pdf_at"].any()
