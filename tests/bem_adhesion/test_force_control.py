"""Force curves: a spring in series against closed forms and the rigid machine, and ways in that end at a force."""

import re
import warnings

import numpy as np
import pytest
from scipy.optimize import brentq

import contact_study
from bem_adhesion import Exponential, HalfSpace, HardWall, rough_contact
from bem_adhesion.study.trigger import Trigger, step_to_trigger
from contact_study.inputs.errors import InputError
from contact_study.physics.laws import LennardJones104
from contact_study.study.study import make_study
from tests.bem_adhesion.paper_system import approach_of, stepped, study_table
from tests.bem_adhesion.test_studies import FREE, HARD_WALL, run, shortened, viscoelastic

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

LAW = LennardJones104(0.69, 3.28e-10)
AREA = (4e-9) ** 2


def flat(stiffness, path, **loading):
    """Two flat surfaces, one on a spring: T(g) against its extension."""
    table = study_table(8, size=4e-9, loading={"path": path, "control": "approach", "adaptive": True, **loading})
    table["surface"] = {"kind": "flat", "size": 4e-9, "shape": [8, 8]}
    table["loading"]["machine_stiffness"] = stiffness
    table["solver"] = {"threads": 1}
    return table


def test_flat_surfaces_on_a_spring_jump_where_their_attraction_outgrows_it():
    compliance = 3 / LAW.strongest_softening
    found = run(flat(AREA / compliance, ["-3 nm", "0.02 nm", "-3 nm"], resolution=0.005))
    equilibrium, gaps = LAW.equilibrium_distance, np.linspace(LAW.peak_distance, 6e-10, 20_001)

    def far(gap):
        """The machine's distance."""
        return gap + compliance * LAW.traction(gap)

    def energy(gap):
        return LAW.potential(gap) + 0.5 * compliance * LAW.traction(gap) ** 2

    # Folds of far(g): the largest on retraction, close to the peak; the least on approach, further out.
    out, inward = gaps[np.argmax(far(gaps))], np.linspace(4.5e-10, 1.2e-9, 20_001)
    inward = inward[np.argmin(far(inward))]
    for name, exact in (("jump_in_separation", inward - equilibrium), ("jump_in_pressure", -LAW.traction(inward))):
        error = float(found[f"{name}_resolution_error"])
        assert 0 < error < 0.5 * abs(exact)
        assert float(found[name]) == pytest.approx(exact, abs=error)
    assert float(found.jump_in_force) == pytest.approx(float(found.jump_in_pressure) * AREA, rel=1e-12)
    assert float(found.pull_off_force) == pytest.approx(-LAW.peak_tensile_stress * AREA, rel=0.01)  # PASSED_OVER
    landed = brentq(lambda gap: far(gap) - far(inward), 0.5 * equilibrium, LAW.peak_distance)
    gone = brentq(lambda gap: far(gap) - far(out), 1.05 * out, 1e-8)
    losses = [energy(inward) - energy(landed), energy(out) - energy(gone)]
    # A jump in extends the spring; at pull-off it gives what is lost and what the surfaces take up.
    assert losses[0] < 0.5 * (LAW.potential(inward) - LAW.potential(landed))
    assert losses[1] > 0 > LAW.potential(out) - LAW.potential(gone)
    spent, error = (found[name].values for name in ("dissipated_energy", "dissipated_energy_resolution_error"))
    np.testing.assert_array_less(np.abs(spent[1:] - np.cumsum(losses)), error[1:] + 0.01 * 0.69)
    assert error[-1] < 0.03 * spent[-1]
    for name, exact in (("work_of_approach", 0.69 - losses[0]), ("work_of_separation", 0.69 + losses[1])):
        error = float(found[f"{name}_resolution_error"])
        assert float(found[name]) == pytest.approx(exact, abs=error + 5e-3 * 0.69)
    # What is stored is of the solid and the law alone.
    np.testing.assert_allclose(found.elastic_energy, 0, atol=1e-15)
    np.testing.assert_allclose(found.approach, found.applied_approach, atol=1e-16)
    np.testing.assert_allclose(found.displacement + found.total_force * compliance / AREA, found.approach)


def test_distributions_reach_as_far_as_a_spring_presses():
    pressed = make_study(flat(1e-3 * AREA * LAW.strongest_softening, ["-3 nm", "1 um"])).bins.pressure_edges[-1]
    assert pressed >= 1e-6 * 1e-3 * LAW.strongest_softening
    held = make_study(flat(1e-3 * AREA * LAW.strongest_softening, ["-3 nm", "1 um"], trigger_force=AREA)).bins
    assert held.pressure_edges[-1] < 0.5 * pressed, "a trigger ends it"


def sphere(points=24):
    x = (np.arange(points) - points / 2 + 0.5) / points
    return -0.5 * (x[:, None] ** 2 + x**2)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize(
    ("law", "hardness"),
    [(HardWall(), None), (HardWall(), 0.08), (Exponential(0.002, 0.02), None), (Exponential(0.002, 0.02), 0.08)],
)
def test_a_spring_takes_its_share_of_the_approach(law, hardness, boundary):
    """Behind it is the state of a rigid machine at the rest, or of the load where no rigid machine reaches."""
    height, targets, stiffness = sphere(), (0.05, 0.12, 0.09), 0.4
    on_spring = {"machine_stiffness": stiffness, "boundary": boundary, "hardness": hardness, "control": "approach"}
    contact = rough_contact(height, 1.0, 1.0, law, **on_spring)
    same = {"control": "approach" if boundary == "free" else "pressure", "boundary": boundary, "hardness": hardness}
    direct, half_space = rough_contact(height, 1.0, 1.0, law, **same), HalfSpace(1.0)
    state = direct.separated()
    for target, found in zip(targets, stepped(contact, targets), strict=True):
        assert found.converged
        force = float(found.pressure.mean())
        if hardness is None or boundary == "free":
            displacement = approach_of(found, height, half_space, law)
            assert displacement + force / stiffness == pytest.approx(target, rel=1e-7)
        rigid = direct.step(state, displacement if boundary == "free" else force)
        state = rigid.state
        # The solvers' tolerances.
        np.testing.assert_allclose(found.pressure, rigid.pressure, atol=1e-6 * np.abs(rigid.pressure).max())
        assert found.elastic_energy == pytest.approx(rigid.elastic_energy, rel=1e-5)
        assert contact.stiffness(found) == pytest.approx(direct.stiffness(rigid), rel=1e-4)


def test_stiff_and_soft_springs_are_control_of_approach_and_of_force():
    law, height = Exponential(0.002, 0.02), sphere()
    bound = {"boundary": "free"}
    rigid = rough_contact(height, 1.0, 1.0, law, "approach", **bound)
    stiff = rough_contact(height, 1.0, 1.0, law, "approach", machine_stiffness=1e9, **bound)
    for one, other in zip(*(stepped(each, (-0.01, 0.03, -0.02)) for each in (rigid, stiff)), strict=True):
        np.testing.assert_allclose(one.pressure, other.pressure, atol=1e-7)
    loaded = rough_contact(height, 1.0, 1.0, law, **bound)
    loads = (0.003, 0.01, -0.002)
    soft = rough_contact(height, 1.0, 1.0, law, "approach", machine_stiffness=1e-5, **bound)
    for one, other in zip(stepped(loaded, loads), stepped(soft, [load / 1e-5 for load in loads]), strict=True):
        # The body's own displacement of a few per cent of the spring's extension of 200 and more.
        assert other.pressure.mean() == pytest.approx(one.pressure.mean(), rel=1e-3)
        assert other.converged


PROBE = {
    **FREE,
    "surface": {**FREE["surface"], "shape": [24, 24]},
    "loading": {"control": "approach", "path": ["-2 nm", "9 nm", "-9 nm"], "trigger_force": "2 nN"},
}


def probe(sections=None, **loading):
    return {**PROBE, **(sections or {}), "loading": {**PROBE["loading"], **loading}}


@pytest.mark.validation
@pytest.mark.parametrize("loading", [{}, {"adaptive": True, "resolution": 0.05, "machine_stiffness": "1 N/m"}])
def test_a_way_in_ends_at_its_trigger(loading, tmp_path):
    table = probe(path=["-9 nm", "0 nm", "9 nm", "12 nm", "0.1 nm", "-9 nm"], **loading)
    whole = run(table)
    assert np.all(whole.converged == 1)
    force, moved = whole.total_force.values, whole.approach.values if "approach" in whole else whole.displacement.values
    # The relative tolerance of loads.
    np.testing.assert_allclose(force[2:4], 2e-9, rtol=1e-5)
    assert np.all(force[[0, 1, 4, 5]] < 2e-9)
    np.testing.assert_allclose(moved[[0, 1, 4, 5]], [-9e-9, 0, 0.1e-9, -9e-9], atol=1e-15)
    assert moved[2] == pytest.approx(moved[3], rel=1e-5)
    assert moved[2] < 9e-9
    assert whole.fft_pairs[3] < 0.5 * whole.fft_pairs[2], "no way leads further in from the trigger"
    # The state is that of its displacement, not one on the way.
    plain = {"loading": {"path": [float(whole.displacement[2])], "control": "approach"}}
    (there,) = run({**PROBE, **plain}).total_force.values
    assert there == pytest.approx(2e-9, rel=2e-5)
    output = tmp_path / "path.nc"
    for _ in range(3):
        table = shortened(table)
    run(table, output=output)
    longer = run(
        probe(path=["-9 nm", "0 nm", "9 nm", "12 nm", "0.1 nm", "-9 nm"], **loading), output=output, resume=True
    )
    for name in ("total_force", "displacement"):
        np.testing.assert_array_equal(longer[name], whole[name])


def test_a_step_to_a_trigger_counts_all_its_solves_and_is_for_ways_inwards_alone(monkeypatch):
    contact = rough_contact(sphere(), 1.0, 1.0, HardWall(), "approach", boundary="free")
    apart, reached = contact.separated(), contact.step(contact.separated(), 0.1)
    force, step, spent = float(reached.pressure.mean()), contact.step, []
    monkeypatch.setattr(contact, "step", lambda *given: spent.append(step(*given)) or spent[-1])
    found, at = step_to_trigger(contact, apart, 0.0, 0.1, Trigger(force, 1e-6))
    assert (at, len(spent), float(found.pressure.mean())) == (0.1, 1, force), "the target has the force"
    found, at = step_to_trigger(contact, reached.state, 0.1, 0.09, Trigger(0.1 * force, 1e-6))
    assert at == 0.09
    assert 0.1 * force < found.pressure.mean() < force
    spent.clear()
    found, at = step_to_trigger(contact, apart, 0.0, 0.1, Trigger(0.5 * force, 1e-6))
    assert found.pressure.mean() == pytest.approx(0.5 * force, rel=1e-6)
    assert 0 < at < 0.1
    for work in ("fft_pairs", "iterations"):
        assert getattr(found, work) == sum(getattr(each, work) for each in spent) > getattr(spent[-1], work)


def test_preloads_are_a_sweep_of_triggers():
    """Hertz: δ = (9F²/16E*²R)^(1/3); a sphere of 32 points in its contact's diameter at the larger load."""
    surface = {"kind": "sphere", "radius": 50e-9, "size": 12e-9, "shape": [48, 48]}
    table = probe({"interaction": {"law": "hard_wall"}, "surface": surface})
    table = {**table, "sweep": {"loading.trigger_force": ["1 nN", "2 nN"]}}
    found = run(table)
    force = found.trigger_force.values
    modulus = 1e9 / (1 - 0.3**2)
    np.testing.assert_allclose(found.total_force[:, 1], force, rtol=1e-5)
    hertz = np.cbrt(9 * force**2 / (16 * modulus**2 * 50e-9))
    np.testing.assert_allclose(found.displacement[:, 1], hertz, rtol=2e-3)  # the grid's, of second order
    radius = np.sqrt(hertz * 50e-9)
    np.testing.assert_allclose(found.contact_radius[:, 1], radius, atol=0.5 * 12e-9 / 48)


def said(table):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        contact_study.run(table, "continuum")
    return [str(item.message) for item in caught if "trigger" in str(item.message)]


def test_a_trigger_that_is_missed_is_said():
    assert said(probe()) == []
    (missed,) = said(probe(path=["-2 nm", "0 nm", "0.1 nm", "0 nm"]))
    assert re.search(r"approach 0\.1 nm the force is \S+ nN, not yet loading\.trigger_force = 2 nN", missed)


REFUSED = [
    (probe(control="pressure", path=[1e6], trigger_force=1.0), r"loading\.trigger_force: belongs to .*approach"),
    (
        probe() | {"material": probe()["material"] | {"hardness": "1 kPa"}},
        r"loading\.trigger_force = 2 nN: material\.hardness = 1 kPa carries less than \S+ \S*N; give a",
    ),
    (probe(machine_stiffness=0.0), r"loading\.machine_stiffness = 0\.0: must be positive"),
    (probe(machine_stiffness="1 GPa"), r"loading\.machine_stiffness.*'0\.2 N/m'|0\.2 N/m"),
    (
        viscoelastic(loading={"path": [1e-9], "control": "approach", "duration": 1.0, "trigger_force": 1.0}),
        r"moves .*viscoelastic.*give the spring loading\.machine_stiffness",
    ),
    (viscoelastic(loading={"path": [1e7], "duration": 1.0, "machine_stiffness": 1.0}), "machine_stiffness: bel"),
    (
        study_table(32, loading={"path": [1e-9], "machine_stiffness": 1.0}, interaction=HARD_WALL),
        "machine_stiffness: bel",
    ),
]


@pytest.mark.parametrize(("table", "words"), REFUSED)
def test_what_does_not_fit_is_refused(table, words):
    with pytest.raises(InputError, match=words) as caught:
        contact_study.run(table, "continuum")
    assert "\n" not in str(caught.value)


def test_the_library_refuses_a_spring_without_approach():
    with pytest.raises(ValueError, match="belongs to control = 'approach', not 'gap'"):
        rough_contact(sphere(), 1.0, 1.0, HardWall(), "gap", machine_stiffness=1.0)
