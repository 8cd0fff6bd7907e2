"""Approach, dwell and retraction of a viscoelastic solid on a spring: closed forms, triggers, account of work."""

import re
import warnings
from functools import cache

import numpy as np
import pytest

import contact_study
from bem_adhesion import HardWall, LennardJones104, Viscoelastic, ViscoelasticContact, rough_contact
from bem_adhesion.adhesive.contact import reach
from bem_adhesion.study import path_in_time
from contact_study.campaign import worker
from tests.recording import stopper

pytestmark = pytest.mark.filterwarnings("ignore:.*process zone")

RELAXED, BRANCH, TIME, SIZE = 1e6, 3e6, 1.0, 1e-5
PUNCH = np.full((16, 16), -1e-6)
PUNCH[5:11, 4:12] = 2e-7


def test_a_punch_on_a_spring_relaxes_by_one_exponential():
    """Standard linear solid in series with a spring C: p + τp' = k∞d + τk₀d', d = A − Cp at a held A."""
    elastic = rough_contact(PUNCH, SIZE, RELAXED, HardWall(), tolerance=1e-12)
    alone = elastic.step(elastic.separated(), 1e3)
    slow = 1e3 / (PUNCH.max() - alone.displacement.mean())  # Pa/m, of the relaxed solid
    fast, spring = (1 + BRANCH / RELAXED) * slow, 1.5 / slow
    contact = ViscoelasticContact(
        PUNCH,
        SIZE,
        Viscoelastic(RELAXED, (BRANCH,), (TIME,)),
        HardWall(),
        machine_stiffness=SIZE**2 / spring,
        control="approach",
        tolerance=1e-12,
    )
    approach, wait, errors = 1e-8, 2.0, []
    first, _ = contact.step(contact.separated(), approach, 1e-9)
    begin, end = (approach / (spring + 1 / stiffness) for stiffness in (fast, slow))
    assert first.pressure.mean() == pytest.approx(begin, rel=2e-9)  # of the ramp's time over the solid's
    late = TIME * (1 + fast * spring) / (1 + slow * spring)
    expected = end + (begin - end) * np.exp(-wait / late)
    for steps in (6, 12):
        found = first
        for _ in range(steps):
            found, _ = contact.step(found, approach, wait / steps)
        np.testing.assert_allclose(found.pressure > 0, PUNCH > 0)
        errors.append(float(found.pressure.mean()) / expected - 1)
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.02)  # second order
    assert abs(errors[1] - (errors[0] - errors[1]) / 3) < 1e-6  # what the extrapolation leaves, of fourth order


PROBE = {
    "surface": {"kind": "sphere", "radius": "1 um", "size": "1.6 um", "shape": [16, 16]},
    "material": {"youngs_modulus": "10 MPa", "poissons_ratio": 0.5},
    "elasticity": {"kind": "viscoelastic", "branch_youngs_moduli": ["90 MPa"], "relaxation_times": ["1 s"]},
    "interaction": {"law": "lennard_jones_10_4", "work_of_adhesion": 0.05, "length": "40 nm"},
}
LOADING = {
    "control": "approach",
    "path": ["-100 nm", "1 um", "1 um", "2 um", "-800 nm"],
    "speed": ["1 um/s", "500 nm/s", "1 um/s", "1 um/s", "2 um/s"],
    "duration": "2 s",
    "machine_stiffness": "2 N/m",
    "trigger_force": "200 nN",
}
WAYS = {"equal": {"time_steps": 8}, "adaptive": {"adaptive": True}}


def probe(path=LOADING["path"], **loading):
    count = len(path)
    return {**PROBE, "loading": {**LOADING, "path": path, "speed": LOADING["speed"][:count], **loading}}


@cache
def protocol(kind):
    return contact_study.run(probe(**WAYS[kind]), "continuum")


@pytest.mark.parametrize("kind", WAYS)
def test_a_way_in_ends_at_its_trigger_and_the_dwell_holds_the_machine(kind):
    whole, way = protocol(kind), WAYS[kind]
    assert np.all(whole.converged == 1)
    force, machine, time = (whole[name].values for name in ("total_force", "approach", "time"))
    np.testing.assert_allclose(force[[1, 3]], 200e-9, rtol=1e-5)  # the relative tolerance of loads
    assert force[2] < 0.97 * force[1]  # relaxes
    known = 1e-5 * 200e-9 / 2.0  # of the spring's extension, by that tolerance (m)
    assert machine[1] == pytest.approx(machine[2], abs=known)
    assert machine[3] > machine[2] + 1e-9  # further in, up to the trigger again
    np.testing.assert_allclose(machine[[0, 4]], [-100e-9, -800e-9], atol=known)
    np.testing.assert_allclose(machine, whole.displacement + force / 2.0, atol=1e-15)
    took = np.diff(machine) / [500e-9, 1, 1e-6, -2e-6] + [0, 2.0, 0, 0]
    np.testing.assert_allclose(np.diff(time), took, atol=2 * known / 500e-9)
    law = LennardJones104(0.05, 40e-9)
    out_of_reach = law.equilibrium_distance - reach(law)  # where the path begins
    assert time[0] == pytest.approx(abs(-100e-9 - out_of_reach) / 1e-6, rel=1e-9)
    last = [row[~np.isnan(row)][-1] for row in whole.passed_separation.values]
    np.testing.assert_allclose(last, whole.mean_separation, atol=1e-20)  # without the spring
    # The state is that of a path to this position at this speed, without a trigger.
    plain = probe([-100e-9, float(machine[1])], **way)
    for name in ("trigger_force", "duration"):
        del plain["loading"][name]
    plain = contact_study.run(plain, "continuum")
    # Of second order in other steps of time.
    assert float(plain.total_force[1]) == pytest.approx(200e-9, rel=2e-3)


@pytest.mark.validation
@pytest.mark.parametrize("kind", WAYS)
def test_a_protocol_goes_on_from_each_point_to_the_same_bits(kind, tmp_path, monkeypatch):
    output, table = tmp_path / "path.nc", probe(**WAYS[kind])
    stop_at, _ = stopper(monkeypatch, path_in_time, "interface_state")
    monkeypatch.setattr(worker, "_SECONDS_BETWEEN_CHECKPOINTS", 0.0)
    for number in range(4):
        stop_at(2)  # at the end of the second point from here
        with pytest.raises(KeyboardInterrupt):
            contact_study.run(table, "continuum", output=output, resume=number > 0)
    stop_at(10)
    found = contact_study.run(table, "continuum", output=output, resume=True)
    for name in ("total_force", "approach", "time", "viscous_dissipation", "elastic_energy"):
        np.testing.assert_array_equal(found[name], protocol(kind)[name])


@pytest.mark.validation
def test_pull_off_grows_with_the_dwell_and_the_account_closes_with_the_spring():
    path, forces = ["-100 nm", "1 um", "1 um", "-800 nm"], []
    for dwell in (0.01, 10.0):
        found = contact_study.run(probe(path, duration=dwell, adaptive=True), "continuum")
        forces.append(-float(found.pull_off_force))
        names = "pressure", "separation", "energy", "viscous_dissipation"
        passed = (found[f"passed_{name}"].values for name in names)
        pressure, separation, energy, viscous = (each[~np.isnan(each)] for each in passed)
        begin = int(found.passed_pressure[0].count()) - 1  # at the first point
        compliance = 1.6e-6**2 / 2.0
        work = -np.trapezoid(pressure[begin:], (separation - compliance * pressure)[begin:])
        stored = energy + 0.5 * compliance * pressure**2
        jumps, left = (np.diff(found[name].values[[0, -1]])[0] for name in ("dissipated_energy", "unaccounted_work"))
        lost = jumps + viscous[-1] - viscous[begin]
        assert work == pytest.approx(stored[-1] - stored[begin] + lost + left, abs=1e-9 * lost)
        assert abs(left) < 0.005 * lost
    assert forces[1] > 1.5 * forces[0]


def test_a_trigger_that_is_missed_is_said_on_arrival_alone():
    def said(**loading):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            contact_study.run(probe([*LOADING["path"][:3], "-10 nm"], speed="1 um/s", **loading), "continuum")
        return [str(item.message) for item in caught if "trigger" in str(item.message)]

    assert said() == []
    (missed,) = said(trigger_force="1 mN")
    assert re.search(r"at approach 1000 nm the force is 1\.\d+ µN, not yet loading\.trigger_force = 1 mN", missed)


def test_the_library_refuses_a_spring_without_approach():
    with pytest.raises(ValueError, match="belongs to control = 'approach', not 'gap'"):
        ViscoelasticContact(PUNCH, SIZE, Viscoelastic(1e6, (1e6,), (1.0,)), HardWall(), 1.0, control="gap")
