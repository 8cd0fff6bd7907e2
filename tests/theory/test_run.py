"""The theories along a loading path: names of the schema, restarts, gap control, branches, mistakes of input."""

import copy
import dataclasses
import warnings

import numpy as np
import pytest

from contact_study.inputs.errors import InputError
from contact_study.results.schema import COORDINATES, VARIABLES, quantity_of
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.recording import bins_of_case, recorded_path
from tests.study.test_study import of_another_kind
from theory.criteria import stickiness
from theory.edge_flow.flow import edge_flow
from theory.gap_flow.flow import gap_flow
from theory.non_adhesive import closed_forms
from theory.numerics.background import BackgroundExecutor
from theory.persson import theory as persson
from theory.persson.separation import NegativeSeparation, NotConverged
from theory.persson.theory import PerssonTheory, true_area_factor
from theory.study import case_theories, gap_paths
from theory.study import model as run

ENERGIES = ("mean_pressure", "mean_gap", "elastic_energy", "interaction_energy")
STUDY = {
    "surface": {
        "kind": "self_affine",
        "size": "416 angstrom",
        "shape": [64, 64],
        "rms_height": "10 angstrom",
        "low_mode": 1,
        "roll_off_mode": 3,
        "cutoff_mode": 12,
        "hurst_exponent": 0.8,
    },
    "material": {"youngs_modulus": "77.2 GPa", "poissons_ratio": 0.42},
    "interaction": {
        "work_of_adhesion": "1.4 J/m^2",
        "length": "3.28 angstrom",
        "contact_distance": "3.68 angstrom",
    },
    "loading": {"path": ["1 GPa", "5 GPa"], "unload": True},
    "theory": {"spectrum": "analytic"},
}


def case_of(**sections):
    table = copy.deepcopy(STUDY)
    if "kind" in sections.get("surface", {}):
        of_another_kind(table)
    for name, keys in sections.items():
        table.setdefault(name, {}).update(keys)
    return make_study(table).cases[0]


def persson_of(**sections):
    """A case of Persson's theory alone."""
    return case_of(**sections | {"theory": {"flows": "none"} | sections.get("theory", {})})


def steps_of(case, **start):
    return recorded_path(case, run.solve_path(case, realise(case), **start))


@pytest.fixture(scope="module")
def case():
    return case_of()


@pytest.fixture(scope="module")
def steps(case):
    return steps_of(case)


@pytest.mark.parametrize("threads", [2, 4])
def test_threads_change_no_bit(case, steps, threads):
    shared = case_of(solver={"threads": threads})
    for one, other in zip(steps_of(shared), steps, strict=True):
        assert one.values.keys() == other.values.keys()
        for key, value in other.values.items():
            np.testing.assert_array_equal(one.values[key], value, err_msg=key)
    constants = run.constants(case, realise(case))
    for key, value in run.constants(shared, realise(shared)).items():
        np.testing.assert_array_equal(value, constants[key], err_msg=key)


def test_names_are_those_of_the_schema(case, steps):
    known = set(VARIABLES) | set(COORDINATES)
    names = {name.rpartition("/")[2] for step in steps for name in step.values}
    names |= {name.rpartition("/")[2] for name in run.constants(case, realise(case))}
    assert names <= known
    groups = {name.rpartition("/")[0] for name in steps[0].values}
    assert groups == {"", "persson", "gap_flow", "gap_flow/loading", "gap_flow/unloading", "edge_flow"}
    assert len(steps) == len(case.path) == 3
    assert all(step.values.keys() == steps[0].values.keys() for step in steps)


def assert_load_is_carried(values, applied):
    assert values["contact_stress"] > 0 > values["edge_stress"]
    assert values["contact_stress"] + values["edge_stress"] == pytest.approx(applied, rel=1e-3)
    assert values["persson/stress_balance"] == pytest.approx(1, abs=1e-3)


def test_load_is_carried_where_adhesion_is_strong():
    case = persson_of(
        surface={"size": "1040 angstrom"},
        interaction={"work_of_adhesion": "5.54 J/m^2"},
        loading={"path": ["0.1 GPa"], "unload": False},
    )
    (step,) = steps_of(case)
    assert step.values["contact_stress"] > 20e8
    assert_load_is_carried(step.values, 1e8)


def test_a_state_whose_stresses_do_not_balance_is_flagged_with_a_remedy(monkeypatch):
    diffuse = persson.diffuse
    monkeypatch.setattr(persson, "diffuse", lambda *given: dataclasses.replace(diffuse(*given), edge_stress=0.0))
    with pytest.warns(NotConverged, match="times the pressure"):
        (step,) = steps_of(persson_of(loading={"path": ["1 GPa"], "unload": False}))
    assert not step.values["persson/converged"]
    assert step.values["persson/stress_balance"] == pytest.approx(step.values["contact_stress"] / 1e9)
    assert "use more cells" in step.values["persson/message"]


def test_values_are_consistent(case, steps):
    for (applied, _), step in zip(case.path, steps, strict=True):
        values = step.values
        assert values["persson/converged"]
        assert values["persson/mean_pressure"] == applied
        assert_load_is_carried(values, applied)
        area = np.sum(values["persson/pressure_pdf"]) * np.diff(bins_of_case(case).pressure_edges)[0]
        # The root's distribution is that of the contact, without the δ of non-contact; of it, the bins leave out what
        # is under more tension than the law can exert, since the paper's detachment stress is not capped.
        assert area == pytest.approx(values["persson/relative_contact_area"], rel=0.01)
        assert values["relative_contact_area_at"][-1] == pytest.approx(
            values["persson/relative_contact_area"], rel=1e-12
        )
        assert values["gap_flow/mean_pressure"] == pytest.approx(applied, rel=1e-9)
        # Mean traction and slope of the energy balance to second order in the gap's nodes: 1e-6 of the modulus here.
        assert values["gap_flow/residual"] < 1e-5
        # The spline's root is found between points of its slope, 16 from one mean gap to the next.
        assert values["edge_flow/mean_pressure"] == pytest.approx(applied, rel=1e-3)
        assert values["edge_flow/converged"]
        for theory in ("gap_flow", "edge_flow"):
            for name in ("pressure_pdf", "gap_pdf"):
                edges = bins_of_case(case).edges_of[name]
                assert np.sum(values[f"{theory}/{name}"] * np.diff(edges)) == pytest.approx(1, abs=2e-3)


def test_work_of_the_pressure_is_the_energy_stored():
    loading = {"path": ["2 GPa", "2.02 GPa", "2.04 GPa"], "unload": False}
    steps = steps_of(case_of(loading=loading, theory={"flows": "gap_flow"}))
    for group in ("persson/", "gap_flow/", "gap_flow/loading/", "gap_flow/unloading/"):
        one, _, other = ({name: step.values[group + name] for name in ENERGIES} for step in steps)
        stored = sum(other[name] - one[name] for name in ENERGIES[2:])
        work = -2.02e9 * (other["mean_gap"] - one["mean_gap"])
        # Differences over 2 % in pressure of numbers good to 1e-5 or better, the trapezoidal rule to 1e-4.
        assert stored == pytest.approx(work, rel=0.01), group


def test_energies_of_perssons_theory(case, steps):
    spectrum = realise(case).spectrum
    values = steps[0].values
    gained = 1.4 * values["persson/relative_contact_area"] * true_area_factor(np.array(spectrum.rms_slope))
    assert values["persson/interaction_energy"] == pytest.approx(-gained, rel=1e-6)
    assert 0 < values["persson/elastic_energy"] < spectrum.full_contact_energy(case.solid.stiffness)


def test_both_ways_agree_under_pressure(steps):
    # Persson's theory has one state at each pressure above zero, up to the iteration's tolerance.
    there, back = steps[0].values, steps[2].values
    assert back["persson/relative_contact_area"] == pytest.approx(there["persson/relative_contact_area"], rel=1e-4)
    assert back["gap_flow/loading/relative_contact_area"] == there["gap_flow/loading/relative_contact_area"]


def test_restart_gives_the_same_bits(case, steps):
    resumed = steps_of(case, restart=steps[0].restart, start=1)
    assert len(resumed) == len(steps) - 1
    for step, again in zip(steps[1:], resumed, strict=True):
        for name, value in step.values.items():
            assert np.array_equal(value, again.values[name], equal_nan=not isinstance(value, str)), name


def test_prescribed_gap_is_the_inverse_of_prescribed_pressure(steps):
    gap = steps[0].values["persson/mean_gap"]
    loading = {"control": "gap", "path": [gap, 2e-8, -1e-11], "unload": False}
    step = steps_of(case_of(loading=loading, theory={"flows": "gap_flow"}))
    # The curve down to another lowest pressure has other nodes: its own accuracy.
    assert step[0].values["persson/mean_pressure"] == pytest.approx(1e9, rel=2e-3)
    assert step[1].values["gap_flow/relative_contact_area"] < 1e-12
    assert not step[2].values["persson/converged"]
    assert "no pressure" in step[2].values["persson/message"]
    assert step[2].values["gap_flow/relative_contact_area"] > 0.9
    for theory, accuracy in (("gap_flow", 1e-6), ("edge_flow", 2e-3)):  # other mean gaps under the spline
        flow_gap = steps[0].values[f"{theory}/mean_gap"]
        loading = {"control": "gap", "path": [flow_gap], "unload": False}
        step = steps_of(case_of(loading=loading, theory={"flows": theory}))
        assert step[0].values[f"{theory}/mean_pressure"] == pytest.approx(1e9, rel=accuracy)
        areas = [values[f"{theory}/relative_contact_area"] for values in (step[0].values, steps[0].values)]
        assert areas[0] == pytest.approx(areas[1], rel=accuracy)


def test_what_the_edge_flow_does_not_find_is_said(case):
    surface = realise(case)
    flow = edge_flow(surface.spectrum, case.solid, case.law, gaps=60, scales=16, iterations=3)
    with pytest.warns(NotConverged, match=r"edge flow: \d+ of \d+ mean gaps"):
        found = gap_paths._edge_flow_values(case, flow, BackgroundExecutor(1), 0)
    values = [found(number) for number in range(len(case.path))]
    assert not any(step["edge_flow/converged"] for step in values)
    beyond = [step for step in values if np.isnan(step["edge_flow/mean_pressure"])]
    assert beyond, "the curve ends early"
    assert np.isnan(beyond[0]["edge_flow/relative_contact_area"])
    said = beyond[0]["edge_flow/message"]
    assert "adhesion is too strong for the edge flow (0.1 of the energy of full contact" in said
    assert "softening 0.58 times the finest wave's stiffness); use a lower pressure" in said
    with pytest.raises(ValueError, match=r"too strong for the edge flow \(0\.1 of the energy"):
        flow.at_pressure(1e13)


def test_large_gaps_take_light_loads():
    """The first sweep ends at 6 h_rms or so; the gap beyond is found by going on to a lower pressure."""
    case = persson_of(
        interaction={"work_of_adhesion": "0.01 J/m^2"},
        loading={"control": "gap", "path": ["45 angstrom"], "unload": False},
    )
    (step,) = steps_of(case)
    assert step.values["persson/converged"]
    spectrum, modulus = realise(case).spectrum, case.material.contact_modulus
    decay, prefactor = closed_forms.low_pressure_asymptote(spectrum, modulus)
    # Adhesion this weak moves the separation by less than a tenth of its decay length.
    assert step.values["persson/mean_pressure"] == pytest.approx(prefactor * np.exp(-45e-10 / decay), rel=0.1)


def test_gap_that_strong_adhesion_never_opens_is_said():
    """Where everything sticks the theory's gap stays small down to no pressure: an answer, not a failure."""
    case = persson_of(
        surface={"rms_height": "4 angstrom"},
        interaction={"work_of_adhesion": "4.1 J/m^2"},
        loading={"control": "gap", "path": ["6 angstrom"], "unload": False},
    )
    (step,) = steps_of(case)
    assert not step.values["persson/converged"]
    assert "no pressure" in step.values["persson/message"]


def test_tension_follows_the_adhered_branch_and_detaches():
    case = case_of(
        interaction={"work_of_adhesion": "14 J/m^2"},
        loading={"path": ["1 GPa", "-1 GPa", "-30 GPa", "-1 GPa"], "unload": False},
        theory={"flows": "gap_flow"},
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pressed, pulled, lost, after = (step.values for step in steps_of(case))
    assert 0 < pulled["persson/relative_contact_area"] < pressed["persson/relative_contact_area"]
    assert not pulled["persson/detached"]
    assert lost["persson/detached"]
    assert after["persson/detached"]  # what has come off stays off without pressure
    assert np.isnan(pulled["persson/mean_gap"])
    # A block that has come off is the same in every model, but that this theory has no mean gap under tension.
    assert np.isnan(lost["persson/mean_gap"])
    for group, quantities in (
        ("persson/", ()),
        ("gap_flow/", ("relative_repulsive_area", "gap_pdf")),
    ):
        assert lost[group + "converged"]
        assert lost[group + "detached"]
        shared = ("mean_pressure", "relative_contact_area", "elastic_energy", "interaction_energy", "residual")
        for name in (*shared, "pressure_pdf", *quantities):
            assert not np.any(lost[group + name]), name
        assert lost.keys() == pulled.keys()
        for name, value in pulled.items():
            assert np.shape(lost[name]) == np.shape(value), name
    for name in ("edge_stress", "contact_stress", "relative_contact_area_at", "detachment_stress"):
        assert not np.any(lost[name]), name
    assert lost["gap_flow/mean_gap"] == np.inf


def test_flow_whose_steps_did_not_converge_is_flagged(case):
    flow = gap_flow(realise(case).spectrum, case.material.contact_modulus, case.law, iterations=3)
    for state in case_theories._states_along(case, flow):
        assert not gap_paths._gap_flow_values(case, flow, state)["gap_flow/converged"]


def test_every_state_of_an_unconverged_branch_is_flagged(monkeypatch):
    case = case_of(loading={"path": ["1 GPa", "-2 GPa"], "unload": False}, theory={"flows": "gap_flow"})

    def loading_cut_short(*arguments):
        return gap_flow(*arguments, iterations=3 if "loading" in arguments else 60)

    monkeypatch.setattr(case_theories, "gap_flow", loading_cut_short)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NegativeSeparation)
        with pytest.warns(NotConverged, match=r"gap flow, loading: \d+ of \d+ steps of the roughness"):
            held, lost = (step.values for step in steps_of(case))
    assert lost["gap_flow/loading/detached"]
    for values in (held, lost):
        assert not values["gap_flow/loading/converged"]
        assert values["gap_flow/converged"]
        assert values["gap_flow/unloading/converged"]
    with pytest.warns(NotConverged, match="gap flow, loading"):  # its pull-off pressure rests on the same steps
        run.constants(case, realise(case))


def test_two_spectra_stand_side_by_side_and_are_those_of_one_alone(case, steps):
    both = case_of(theory={"spectrum": ["analytic", "surface"]})
    found = steps_of(both)
    own = steps_of(case_of(theory={"spectrum": "surface"}))
    for step, target, measured in zip(found, steps, own, strict=True):
        labelled = {name for name in target.values if "/" in name}
        for name, value in target.values.items():
            assert np.array_equal(step.values[name], value, equal_nan=not isinstance(value, str)), name
        for name in labelled:
            other = step.values[name.replace("/", "@surface/", 1)]
            assert np.array_equal(other, measured.values[name], equal_nan=not isinstance(other, str)), name
        assert len(step.values) == len(target.values) + len(labelled)
        assert step.values["edge_flow@surface/mean_gap"] != step.values["edge_flow/mean_gap"]
    values = run.constants(both, realise(both))
    assert "persson@surface/pull_off_pressure" in values  # nothing sticks in it
    for theory in ("gap_flow", "edge_flow"):
        assert values[f"{theory}@surface/pull_off_pressure"] != values[f"{theory}/pull_off_pressure"]
    alone = persson_of(theory={"spectrum": ["analytic", "surface"]})
    resumed = steps_of(alone, restart=found[0].restart, start=1)
    for step, again in zip(found[1:], resumed, strict=True):
        for name in ("persson/relative_contact_area", "persson@surface/relative_contact_area"):
            assert step.values[name] == again.values[name]


def test_a_warning_names_its_spectrum_once_a_cause_where_there_are_several():
    kinds = ["analytic", "surface"]

    def heard(*asked):
        case = case_of(
            interaction={"work_of_adhesion": "8 J/m^2"},
            solver={"max_iterations": 5},
            loading={"path": ["70 GPa", "0.1 GPa"], "unload": False},
            theory={"spectrum": list(asked), "flows": "none"},
        )
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run.constants(case, realise(case))
            steps_of(case)
        return [(item.category, str(item.message)) for item in caught]

    assert not any("spectrum" in words for _, words in heard("analytic"))
    both = heard(*kinds)
    for kind in kinds:
        of_it = [(category, words) for category, words in both if words.startswith(f'spectrum "{kind}": ')]
        causes = [(category, words.split(": ")[1].split(" down to")[0]) for category, words in of_it]
        assert {(NegativeSeparation, "mean separation"), (NotConverged, "mean gap")} <= set(causes)
        assert len(causes) == len(set(causes))
    assert all(words.startswith("spectrum ") for _, words in both)


@pytest.mark.parametrize("asked", ["gap_flow", "edge_flow", "none", ["edge_flow", "gap_flow"]])
def test_theories_that_are_not_asked_for_are_left_out_and_the_others_as_ever(steps, asked):
    chosen = case_of(theory={"flows": asked})
    left = {"persson", *([asked] if isinstance(asked, str) else asked)} - {"none"}
    found = steps_of(chosen)
    assert {labels[0] for step in found for key in step.values if (labels := quantity_of(key)[0])} == left
    shared = [key for key in steps[0].values if not (labels := quantity_of(key)[0]) or labels[0] in left]
    for one, other in zip(found, steps, strict=True):
        for key in shared:
            if not callable(other.values[key]):
                np.testing.assert_array_equal(one.values[key], other.values[key], err_msg=key)
    constants = run.constants(chosen, realise(chosen))
    pulls = {key.partition("/")[0] for key in constants if key.endswith("/pull_off_pressure")}
    assert pulls == left


TABLE = {"spectrum": "table", "wavevectors": [1e8, 2e8], "density": [1e-34, 1e-34]}


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"flows": ["none", "gap_flow"]}, r'theory\.flows: "none"'),
        ({"spectrum": []}, r"theory\.spectrum.*empty"),
        ({"spectrum": ["surface", "surface"]}, r"theory\.spectrum.*twice"),
        ({"spectrum": ["surface", "target"]}, r"theory\.spectrum.*expected one of"),
        ({"spectrum": "table"}, "theory.wavevectors"),
        ({"spectrum": "table", "wavevectors": [1e8, 2e8]}, "theory.density"),
        (TABLE | {"wavevectors": [2e8, 1e8]}, "theory.wavevectors: must rise"),
        (TABLE | {"density": [1e-34]}, "theory.density"),
        (TABLE | {"density": [1e-34, -1e-34]}, "theory.density"),
        (TABLE | {"wavevectors": ["1 nm", "2 nm"]}, "theory.wavevectors"),
    ],
)
def test_bad_spectra_and_theories_are_named(keys, message):
    with pytest.raises(InputError, match=message):
        case_of(theory=keys)


def test_spectra_are_a_word_or_a_list():
    assert case_of(theory={"spectrum": ["surface"]}).theory.spectra == ("surface",)
    assert case_of(theory={"spectrum": "analytic, surface"}).theory.spectra == ("analytic", "surface")
    with pytest.raises(InputError, match="analytic"):
        run.check(case_of(surface={"kind": "wavy", "amplitude": "1 nm"}, theory={"spectrum": ["surface", "analytic"]}))


def test_a_table_of_the_target_is_the_target(case, steps):
    target = realise(case).spectrum
    corners = np.array([target.low, target.roll_off, target.cutoff])
    table = {"spectrum": "table", "wavevectors": [f"{q * 1e-10:.15g} angstrom^-1" for q in corners]}
    table["density"] = [f"{c * 1e40:.15g} angstrom^4" for c in target.density(corners)]
    (step,) = steps_of(case_of(theory=table, loading={"path": ["1 GPa"], "unload": False}))
    for theory in ("persson", "gap_flow", "edge_flow"):
        for name in ("relative_contact_area", "mean_gap"):
            # Bands that do not hold the corner; resolution of the theories, and a shorter curve of the edge flow.
            expected = pytest.approx(steps[0].values[f"{theory}/{name}"], rel=1e-3)
            assert step.values[f"{theory}/{name}"] == expected, (theory, name)


def test_criteria_of_sticking_are_constants_of_the_case(case):
    found = run.constants(case, realise(case))
    expected = stickiness(realise(case).spectrum, case.solid, case.law)
    assert found["bearing_area_ratio"] == expected.bearing_area
    assert found["local_tabor_number"].shape == found["wavevector"].shape
    assert found["local_tabor_number"][-1] == pytest.approx(found["finest_tabor_number"], rel=1e-12)
    wall = case_of(interaction={"law": "hard_wall"})
    assert "bearing_area_ratio" not in run.constants(wall, realise(wall))


def test_pull_off_of_every_theory_is_a_constant(case):
    found = run.constants(case, realise(case))
    flow = edge_flow(realise(case).spectrum, case.solid, case.law)
    # Two curves with other ends.
    assert found["edge_flow/pull_off_pressure"] == pytest.approx(flow.pull_off_pressure, rel=1e-2)
    assert found["gap_flow/pull_off_pressure"] < found["edge_flow/pull_off_pressure"] < 0


def test_distribution_that_lost_area_is_not_converged(case):
    flow = gap_flow(realise(case).spectrum, case.material.contact_modulus, case.law)
    (state,) = flow.states(np.array([flow.gap_at(1e9)]))
    assert state.quantities()["converged"]
    for weights in (0.999 * state.weights, np.roll(state.weights, 1)):
        assert not dataclasses.replace(state, weights=weights).quantities()["converged"]


def test_gap_that_rests_on_unconverged_states_is_flagged():
    # Strong adhesion: 5 iterations at 0.1 GPa and 3 at 70 GPa, but 10 to 14 from 1 to 3 GPa.
    case = persson_of(
        interaction={"work_of_adhesion": "8 J/m^2"},
        solver={"max_iterations": 8},
        loading={"path": ["70 GPa", "0.1 GPa"], "unload": False},
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NegativeSeparation)
        with pytest.warns(NotConverged, match="mean gap"):
            heavy, light = (step.values for step in steps_of(case))
    assert heavy["persson/converged"]
    assert light["persson/iterations"] < 8
    assert not light["persson/converged"]
    assert "mean gap" in light["persson/message"]


def test_tolerance_of_the_case_is_that_of_the_state(steps):
    # 1 GPa is a state of the separation curve, from which it starts solved.
    tight = persson_of(solver={"tolerance": 1e-11}, loading={"path": ["1 GPa", "2 GPa"], "unload": False})
    loose = persson_of(loading={"path": ["1 GPa", "2 GPa"], "unload": False})
    values, others = steps_of(tight)[1].values, steps_of(loose)[1].values
    assert values["persson/converged"]
    assert values["persson/residual"] <= 1e-11 < others["persson/residual"] <= 1e-8
    assert values["persson/iterations"] > others["persson/iterations"]


def test_measured_spectrum_replaces_the_target(case, steps):
    measured = persson_of(theory={"spectrum": "surface"})
    values = run.constants(measured, realise(measured))
    assert values["rms_height"] == pytest.approx(realise(measured).rms_height, rel=1e-9)
    assert run.constants(case, realise(case))["rms_height"] == pytest.approx(1e-9, rel=1e-9)
    other = steps_of(measured)[0].values
    assert other["persson/relative_contact_area"] != pytest.approx(
        steps[0].values["persson/relative_contact_area"], rel=1e-3
    )


CHOICES = {
    "energy_weight": ("wang_mueser", "energy_weight"),
    "beta": (0.45, "beta"),
    "true_area": ("lattice", "true_area"),
    "alpha": (0.5, "alpha"),
}


@pytest.mark.parametrize("key", CHOICES)
def test_choices_of_the_study_are_those_of_the_theory(steps, key):
    value, attribute = CHOICES[key]
    chosen = persson_of(theory={key: value}, loading={"path": ["1 GPa"], "unload": False})
    theory = case_theories.case_theories(chosen, realise(chosen))[0].persson
    assert getattr(theory, attribute) == value
    assert getattr(PerssonTheory, attribute) != value
    area = steps_of(chosen)[0].values["persson/relative_contact_area"]
    assert area != pytest.approx(steps[0].values["persson/relative_contact_area"], rel=1e-3)


def test_detachment_stress_is_capped_where_the_study_says_so(case):
    capped = case_of(theory={"cap_detachment_stress": True})
    assert case_theories.case_theories(capped, realise(capped))[0].persson.stress_cap == case.law.peak_tensile_stress
    assert PerssonTheory.stress_cap == np.inf


def review(**sections):
    table = copy.deepcopy(STUDY)
    if "kind" in sections.get("surface", {}):
        of_another_kind(table)
    for name, keys in sections.items():
        table.setdefault(name, {}).update(keys)
    study = make_study(table)
    return run.review(study, study.scales)


def test_roughness_that_adhesion_dwarfs_is_refused():
    assert review() == []
    with pytest.raises(InputError, match="the limit is 300"):
        review(surface={"size": "3 m"})
    soft = {"material": {"youngs_modulus": "2 MPa"}, "interaction": {"work_of_adhesion": "0.05 J/m^2"}}
    assert review(surface={"size": "1 um"}, **soft) == []
    # A cap on the tension is a cap on the detachment stress.
    with pytest.raises(InputError, match="the limit is 300"):
        review(theory={"alpha": 1e6})
    assert review(theory={"alpha": 1e6, "cap_detachment_stress": True}) == []


def test_spectra_far_above_the_law_are_said():
    (note,) = review(surface={"size": "3 m", "rms_height": "3 cm"})
    assert "times interaction.length: the theories leave out all roughness below it" in note


def test_hard_wall_has_persson_only():
    case = case_of(interaction={"law": "hard_wall"})
    step = steps_of(case)[0]
    assert not any(name.startswith("gap_flow") for name in step.values)
    assert step.values["persson/interaction_energy"] == 0
    assert 0 < step.values["persson/relative_contact_area"] < 1


def test_surfaces_without_spectrum_are_refused():
    wavy = case_of(surface={"kind": "wavy", "amplitude": "1 nm"})
    with pytest.raises(InputError, match=r"theory\.spectrum"):
        run.check(wavy)
    flat = case_of(surface={"kind": "flat"})
    with pytest.raises(InputError, match=r"surface\.kind"):
        run.check(flat)
    run.check(case_of(surface={"kind": "wavy", "amplitude": "1 nm"}, theory={"spectrum": "surface"}))


def test_the_surface_s_own_spectrum_comes_first_unless_others_are_named():
    named = copy.deepcopy(STUDY)
    named.pop("theory")
    (case,) = make_study(named).cases
    assert case.spectra == ("surface", "analytic")
    of_another_kind(named)
    named["surface"] |= {"kind": "wavy", "amplitude": "1 nm"}
    (wavy,) = make_study(named).cases
    assert wavy.spectra == ("surface",), "a wave has no target"
    run.check(wavy)
    assert case_of().spectra == ("analytic",)


def test_a_layer_is_held_by_its_base():
    """Gaps are the theory's own; the base has moved on by the uniform compression, whose energy is the block's."""
    thickness, pressure = 5e-9, 1e9
    flat = {"elasticity": {"kind": "layer", "thickness": thickness}, "loading": {"path": [pressure], "unload": False}}
    case = case_of(**flat)
    values = steps_of(case)[0].values
    compliance = case.solid.mean_compliance
    assert compliance > 0
    found = [name for name in values if quantity_of(name)[1] == "mean_separation"]
    assert len(found) == 5
    for name in found:
        gap = values[name.replace("mean_separation", "mean_gap")]
        assert gap - values[name] == pytest.approx(compliance * pressure, rel=1e-9)
    theory = case_theories.case_theories(case, realise(case))[0].persson
    stored = theory.at_pressure(pressure).elastic_energy
    total = values[found[0].replace("mean_separation", "elastic_energy")]
    assert total == pytest.approx(stored + 0.5 * compliance * pressure**2, rel=1e-6)


def test_stress_is_kept_at_as_many_magnifications_as_asked():
    theory = {"magnifications": 5, "spectrum": ["analytic", "surface"]}
    case = persson_of(theory=theory, loading={"path": ["1 GPa", "-8 GPa"], "unload": False})
    held, lost = steps_of(case)
    zeta = run.constants(case, realise(case))["magnification"]
    np.testing.assert_allclose(zeta, 12 ** np.linspace(0.2, 1, 5), rtol=1e-9)
    edges = bins_of_case(case).pressure_edges
    found = held.values["pressure_pdf_at"]
    assert found.shape == (5, edges.size - 1)
    wavevectors = np.geomspace(1, 12, held.values["relative_contact_area_at"].size)
    areas = np.interp(np.log(zeta), np.log(wavevectors), held.values["relative_contact_area_at"])
    masses = np.sum(found, axis=1) * (edges[1] - edges[0])
    assert masses == pytest.approx(areas, rel=0.01)  # of the interpolation between magnifications
    # No tension of an uncapped detachment stress is left out: six deviations of the stress leave 1e-9.
    assert masses[-1] == pytest.approx(held.values["persson/relative_contact_area"], rel=1e-6)
    # On cells of another grading: second order.
    assert np.abs(found[-1] - held.values["persson/pressure_pdf"]).max() < 5e-3 * found[-1].max()
    # The mean stress is the load but for what edges have taken; before contact is lost anywhere it is the load.
    centres = 0.5 * (edges[1:] + edges[:-1])
    assert np.sum(found[0] * centres) * (edges[1] - edges[0]) == pytest.approx(1e9, rel=0.01)
    assert not lost.values["pressure_pdf_at"].any()
    assert "pressure_pdf_at" not in steps_of(persson_of())[0].values


def test_stress_at_a_magnification_without_a_state_is_not_known():
    case = persson_of(theory={"magnifications": 3}, loading={"control": "gap", "path": ["-0.05 nm"], "unload": False})
    (step,) = steps_of(case)
    assert np.isnan(step.values["pressure_pdf_at"]).all()
    assert step.values["pressure_pdf_at"].shape[0] == 3


@pytest.mark.parametrize(
    ("loading", "words"),
    [
        ({"path": ["1 GPa", "1e6 GPa"]}, r"loading\.path: 1e\+06 GPa presses .* nodes reach .* give lower pressures"),
        (
            {"control": "gap", "path": ["1 nm", "-0.3 nm"]},
            r"loading\.path: a mean gap of -0\.3 nm beyond equilibrium .* nodes begin at .* at 3\.28e-10 m",
        ),
    ],
)
def test_paths_closer_than_any_contact_are_named_in_their_own_unit(loading, words):
    case = case_of(loading={**loading, "unload": False})
    with pytest.raises(InputError, match=words):
        run.constants(case, realise(case))
