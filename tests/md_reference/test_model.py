"""The atomistic model of a case: steps along a path, restarts, predictors, constants, and what is refused."""

import dataclasses
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from contact_study.campaign import memory
from contact_study.inputs.errors import InputError
from contact_study.numerics import fourier
from contact_study.study.case import realise
from contact_study.study.schema.keys import keys_of
from contact_study.study.schema.sections import AtomisticSection
from contact_study.study.study import Study, make_study
from md_reference import rough_contact
from md_reference.statics.contact import at_mean_gap
from md_reference.statics.energy import separated
from md_reference.study.model import METHODS, MODEL, check, constants, review, solve_path
from md_reference.study.system import build_contact, build_stiffness
from tests.md_reference.systems import E_STAR, FLOW, POISSON, R0, SPACING, WELL_DEPTH, YOUNGS, case_of, changed, moving
from tests.recording import recorded_path

PATH = ("0.5 GPa", "2 GPa", "8 GPa")


def steps_of(case, **options):
    return recorded_path(case, solve_path(case, realise(case), **options))


def values_of(atoms=(32, 32), **options):
    return [step.values for step in steps_of(case_of(atoms, **options))]


def notes_on(*cases):
    study = Study({}, Path(), cases, {})
    return review(study, study.scales)


def test_steps_carry_the_quantities_of_the_schema_from_any_start():
    case = case_of((40, 56), ratio=4, path=PATH)
    whole = steps_of(case)
    for step, (pressure, _) in zip(whole, case.path, strict=True):
        values, gap = step.values, step.fields["gap"]
        assert (values["converged"], values["detached"]) == (True, False)
        assert values["residual"] < 1e-8
        assert values["mean_pressure"] == pytest.approx(pressure, abs=1e-8 * E_STAR)
        assert np.mean(step.fields["pressure"]) == pytest.approx(values["mean_pressure"], rel=1e-12)
        assert values["mean_gap"] == pytest.approx(np.mean(gap) - R0, rel=1e-12)
        assert values["relative_contact_area"] == np.mean(gap < 3.68e-10)
        assert 0 < values["relative_repulsive_area"] < values["relative_contact_area"] <= 1
        assert values["elastic_energy"] > 0 > values["interaction_energy"]
    rest = steps_of(case, restart=whole[0].restart, start=1)
    for a, b in zip(whole[1:], rest, strict=True):
        np.testing.assert_array_equal(a.fields["gap"], b.fields["gap"])
        assert [a.values[name] for name in ("elastic_energy", "force_evaluations", "residual")] == [
            b.values[name] for name in ("elastic_energy", "force_evaluations", "residual")
        ]
    asked = []

    def predictor(number):  # on another grid
        asked.append(number)
        return None if number == 1 else fourier.interpolate(whole[number].fields["gap"], (60, 54))

    said = r"no state in contact for point 2 of the path, 2e\+09 Pa \(loading\)"
    with pytest.warns(UserWarning, match=said) as caught:
        led = steps_of(case, predictor=predictor)
    assert (len(caught), asked) == (1, [0, 1, 2])
    for a, b in zip(whole, led, strict=True):
        np.testing.assert_allclose(b.fields["gap"], a.fields["gap"], rtol=0, atol=1e-5 * R0)
    assert led[0].values["force_evaluations"] < whole[0].values["force_evaluations"]


def test_the_study_file_offers_the_methods_that_exist():
    assert keys_of(AtomisticSection)["method"].kind.split(" | ") == list(METHODS)


def test_gap_control_reaches_tension_and_lets_go():
    path = ("8 angstrom", "2 angstrom", "0.5 angstrom", "3 angstrom", "30 angstrom")
    steps = values_of(ratio=8, path=path, control="gap")
    assert all(values["converged"] for values in steps)
    assert steps[1]["mean_pressure"] < 0 == steps[-1]["mean_pressure"]


@pytest.mark.parametrize("pressures", [("0 MPa", "1 GPa"), ("1 GPa", "-14 GPa", "-5 MPa", "1 GPa")])
def test_tension_brings_no_separated_surfaces_together(pressures):
    case = case_of((32, 32), ratio=4, path=pressures)
    touching = steps_of(case_of((32, 32), ratio=4, path=("1 GPa",)))[0]
    for predictor in (None, lambda number: touching.fields["gap"]):
        steps = [step.values for step in steps_of(case, predictor=predictor)]
        for values, (pressure, _) in zip(steps, case.path, strict=True):
            assert (values["converged"], values["detached"]) == (True, pressure <= 0)
            if values["detached"]:
                assert values["message"].startswith("detached")
                assert values["mean_gap"] == np.inf
                assert values["relative_contact_area"] == values["mean_pressure"] == 0
        assert steps[-1]["relative_contact_area"] == touching.values["relative_contact_area"] > 0


def test_starts_at_a_mean_gap_have_no_atom_inside():
    steep = {"rms_height": "6 angstrom", "roll_off_mode": 3, "cutoff_mode": 6}
    short = {"length": "1 angstrom", "contact_distance": "1.2 angstrom"}
    for given, length in (({}, R0), ({"surface": steep, "interaction": short}, 1e-10)):
        case = case_of((32, 32), **given)
        contact = build_contact(case, realise(case))
        interface, start = contact.interface, contact.separated()
        moved, far = (at_mean_gap(interface, start, gap) for gap in (1e-10, 1e-8))
        assert np.mean(moved[2]) == pytest.approx(1e-10 + length, rel=1e-12)
        assert interface.gap(moved).min() >= 0.85 * length * (1 - 1e-9)
        np.testing.assert_allclose(far[2], 1e-8 + length, rtol=1e-12)
        for state in (moved, contact.predicted(np.zeros((32, 32)))):
            assert np.isfinite(interface.evaluate(state, np.empty_like(state)))
        with pytest.raises(InputError, match="mean gap"):
            at_mean_gap(interface, separated(interface), -1e-10)


def test_the_surface_below_the_atoms_is_that_of_the_study():
    case = case_of((16, 16), surface={"cutoff_mode": 6})
    surface = realise(case)
    # The interpolation between sites may err by 1e-4 r0; without samples between them it errs by 15 times that.
    found = build_contact(case, surface).interface.rest_heights()
    np.testing.assert_allclose(found, surface.heights((16, 16)), rtol=0, atol=1e-4 * R0)


def test_constants_are_measured():
    case = case_of((40, 56), ratio=4)
    found = constants(case, realise(case))
    assert 0.988 < found["work_of_adhesion"] / case.work_of_adhesion < 1
    assert found["contact_modulus"] == pytest.approx(case.material.contact_modulus, rel=0.02)
    assert found["contact_modulus_at"].shape == found["wavevector"].shape == (28,)
    assert np.isfinite(found["contact_modulus_at"]).all()
    assert found["height"].shape == (40, 56)
    assert found["equilibrium_distance"] == pytest.approx(R0, rel=1e-4)
    cut = case_of((40, 56), ratio=4, atomistic={"cutoff": 2.0})
    # Pairs beyond r_c hold (5/3)(r0/r_c)⁴ of Δγ if they are cut off sharply, and somewhat more with the switch.
    assert 0.09 < 1 - constants(cut, realise(cut))["work_of_adhesion"] / found["work_of_adhesion"] < 0.16


def layered(cells, **sections):
    return case_of(elasticity={"kind": "layer", "thickness": 2.6e-10 * cells}, **sections)


def short(length):
    return case_of((32, 32), control="gap", path=["1 nm"], interaction={"length": length})


@pytest.mark.parametrize("cells", [6, 40])
def test_layers_of_atoms_have_the_stiffness_of_the_closed_form(cells):
    case = layered(cells, atoms=(96, 96))
    stiffness = build_stiffness(case)
    wavenumber = stiffness.grid.wavenumber[0, 1:4]
    relative = stiffness.normal_stiffness[0, 1:4] / case.solid.stiffness(wavenumber) - 1
    assert np.all(np.abs(relative) < 0.04 * (wavenumber * stiffness.lattice_constant) ** 2 + 0.04 / cells**2)
    assert 1 / stiffness.normal_stiffness[0, 0] == pytest.approx(case.solid.mean_compliance, rel=1e-9)


def test_the_load_works_on_the_base_of_a_layer():
    case = layered(4, atoms=(32, 32), path=(2e9, 2.02e9))
    one, two = (step.values for step in steps_of(case))
    energy = [values["elastic_energy"] + values["interaction_energy"] for values in (one, two)]
    moved = two["mean_separation"] - one["mean_separation"]
    assert (energy[1] - energy[0]) / moved == pytest.approx(-2.01e9, rel=1e-3)
    assert case.solid.compression(0.02e9) > 0.05 * abs(moved)


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (case_of(elasticity={"kind": "layer", "thickness": 1e-9}), "= 1e-09 m: the layer is 3.84615 cells"),
        (layered(6, atomistic={"layers": 7}), r"and atomistic.layers = 7: the layer is 6 cells"),
        (layered(6, atomistic={"layers": 6}), None),
        (case_of(material={"poissons_ratio": 0.5}), r"material\.poissons_ratio = 0\.5: "),
        (case_of(material={"poissons_ratio": 0.4999999999}), r"material\.poissons_ratio = 0\.4999999999: "),
        (case_of(material={"poissons_ratio": 0.49999}), None),
        # 0.35 Å left the block no start above the sites.
        (short("0.35 angstrom"), r"interaction\.length = .* pm: .* sites, 16.* pm apart; use at least 48"),
        (short("0.6 angstrom"), None),
        (case_of((32, 32), ratio=1e-3), None),
        (case_of((32, 32), ratio=1e-6), "inside the substrate"),
    ],
)
def test_blocks_that_cannot_be_are_refused(case, words):
    with pytest.raises(InputError, match=words) if words else nullcontext():
        check(case)
        assert notes_on(case) == []


GAP = {"control": "gap", "path": ["1 nm", "-4.2 nm"]}
FORBIDDEN = [
    (moving(material={"atom_mass": 0}), "material.atom_mass = 0: must be positive"),
    (moving(dynamics={"time_step": "1 ps"}), r"dynamics.time_step = 1e-12 s: .* unstable from .*e-14 s on"),
    (moving(dynamics={"approach_speed": "400 m/s"}), r"dynamics.approach_speed = 400 m/s: .*sound, 32\d m/s"),
    (moving(dynamics={"duration": "10 fs"}), "duration = 1e-14 s: shorter than dynamics.frames = 20 steps"),
    (moving(atomistic={"temperature": 300}, dynamics={"damping": 0}), "needs dynamics.damping above zero"),
    (moving(loading=GAP, dynamics={"approach_speed": 0}), "give dynamics.approach_speed"),
    (moving(loading=GAP), "presses a block of 4.16e-09 m flat"),
    (moving(atomistic={"block": "nonlinear_springs", "method": "quasi_static"}), r'nonlinear_springs".*"dynamics"'),
    (changed(atomistic={"method": "dynamics", "temperature": 0}), "missing key material.atom_mass"),
    (changed(atomistic={"temperature": "-1 K"}), "atomistic.temperature = '-1 K': must be at least 0"),
    (changed(atomistic={"temperature": 0}), "needs an atomistic.temperature above 0 K"),
    (changed(atomistic={"method": "quasi_static"}), 'finds equilibria at zero temperature; "sampling" and "dynamics" '),
    (changed(atomistic={"method": "overdamped"}), "temperature = 300 K.* is a motion without noise; .*sampling"),
    (changed(**{**FLOW, "loading": {"control": "gap", "path": ["1 nm"]}}), 'loading.control = "gap".*atomistic.method'),
]


@pytest.mark.parametrize(("study", "words"), FORBIDDEN)
def test_what_a_method_cannot_do_is_refused(study, words):
    with pytest.raises(InputError, match=words):
        check(make_study(study).cases[0])


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"solver": {"path": "overdamped"}}, ['solver.path = "overdamped": atoms do not read it']),
        ({"solver": {"path": "overdamped"}, "atomistic": {"method": "overdamped"}}, []),
        ({"dynamics": {"duration": "1 ps"}}, ["dynamics.duration: without effect"]),
    ],
)
def test_keys_that_the_atoms_do_not_read_are_said(sections, words):
    for note, start in zip(notes_on(case_of((32, 32), **sections)), words, strict=True):
        assert note.startswith(start)


def test_waves_that_the_sites_cannot_carry_are_said():
    def fine(mode):
        return case_of((16, 48), surface={"shape": [128, 128], "cutoff_mode": mode, "rms_height": "0.1 angstrom"})

    (note,) = notes_on(fine(40))
    assert "left out" in note
    (again,) = notes_on(case_of((32, 32)), fine(40), fine(50))
    assert again.partition(" m")[0] == note.partition(" m")[0]
    assert "points" in again


def test_more_atoms_than_memory_are_refused(monkeypatch):
    case = case_of((32, 32))
    tiny = dataclasses.replace(case, material=dataclasses.replace(case.material, lattice_constant=2.6e-15))
    with pytest.raises(InputError, match=r"material\.lattice_constant.*memory"):
        memory.require(MODEL.needs(tiny))
    monkeypatch.setattr(memory, "_memory", lambda: 6e6)
    moving = case_of(material={"atom_mass": "197 u"}, atomistic={"method": "dynamics"})
    with pytest.raises(InputError, match=r'"dynamics": a block of 3.98e\+04 nodes: needs at least 0.0119 GB'):
        memory.require(MODEL.needs(moving))


def contact_of(height, points=12, **arguments):
    given = {"lattice_constant": SPACING, "youngs_modulus": YOUNGS, "poissons_ratio": POISSON, "length": R0}
    return rough_contact(height, **{"size": points * SPACING, "well_depth": WELL_DEPTH, **given, **arguments})


def wavy(points):
    return contact_of(2e-10 * np.sin(2 * np.pi * np.arange(points) / points)[:, None] * np.ones(points), points)


@pytest.mark.parametrize(("control", "path"), [("pressure", (1e9, -0.2e9)), ("gap", (3e-10, 2e-10))])
def test_a_height_array_gives_what_a_study_does(control, path):
    case = case_of((48, 40), ratio=2.0, path=path, control=control, atomistic={"cutoff": 3.0, "layers": 20})
    surface = realise(case)
    # The surface's waves fit on 30 points a side: the array is the surface.
    size, given = (48 * SPACING, 40 * SPACING), {"control": control, "cutoff": 3.0, "layers": 20}
    contact = contact_of(surface.heights((30, 30)), size=size, well_depth=2 * WELL_DEPTH, **given)
    found = contact.separated()
    for target, own in zip(path, solve_path(case, surface), strict=True):
        found = contact.step(found, target)
        assert found.converged
        # Heights interpolated from another grid differ by rounding; residuals of 1e-8 E* a² over the softest mode.
        np.testing.assert_allclose(found.gap, own.gap, rtol=0, atol=1e-6 * R0)
        assert found.mean_separation == pytest.approx(own.mean_separation, abs=1e-6 * R0)
        assert found.elastic_energy == pytest.approx(own.elastic_energy, rel=1e-5)
        assert found.interaction_energy == pytest.approx(own.interaction_energy, rel=1e-5)


STATE = np.zeros((3, 12, 12))


@pytest.mark.parametrize(
    ("arguments", "step", "message"),
    [
        ({"height": np.full((8, 8), np.inf)}, None, "height is not finite"),
        ({"size": "3 nm"}, None, "size"),
        ({"size": 12.3 * SPACING}, None, "lattice_constant"),
        ({"well_depth": -1.0}, None, "well_depth"),
        ({"length": "3.28 angstrom"}, None, "length"),
        ({"cutoff": 1.1}, None, r"cutoff = 1\.1: must be at least 2 lengths"),
        ({"poissons_ratio": 0.5}, None, "poissons_ratio"),
        ({"layers": -1}, None, "at least one layer"),
        ({"control": "force"}, None, "control"),
        ({"tolerance": -1e-8}, None, "tolerance"),
        ({}, (STATE, np.nan), "target = nan"),
        ({}, (STATE[:, :4, :4], 1e9), "state has shape"),
        ({}, (None, 1e9), "state is None"),
    ],
)
def test_bad_arguments_are_named(arguments, step, message):
    with pytest.raises(ValueError, match=message):
        contact_of(**{"height": np.zeros((8, 8)), **arguments}).step(*step)


def test_a_solution_starts_a_step_and_speaks_for_itself():
    contact = wavy(12)
    found = contact.step(contact.separated(), 1e9)
    further = contact.step(found, 9e9)
    np.testing.assert_array_equal(further.gap, contact.step(found.state, 9e9).gap)
    assert found.relative_contact_area == np.mean(found.gap < 2 ** (1 / 6) * R0)
    assert 0 < found.relative_contact_area < further.relative_contact_area
    assert found.mean_gap == found.gap.mean() - R0
    assert len({found, further}) == len(repr(found).splitlines()) == 2
    torn = contact.step(further, -1e10)
    assert torn.detached
    assert contact.is_separated(torn.state)
    assert not contact.is_separated(further.state)


def test_threads_that_share_a_block_take_turns_and_find_their_start_as_it_was():
    contact, loads = wavy(32), (0.5e9, 1e9, 2e9, 4e9)
    start = contact.separated()
    alone = [contact.step(start, load) for load in loads]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda load: contact.step(start, load), loads))
    for one, other in zip(alone, together, strict=True):
        assert other.converged
        np.testing.assert_array_equal(one.gap, other.gap)
    with pytest.raises(ValueError, match="read-only"):
        alone[0].displacement[...] = 0
