"""The continuum in time: slow motion against friction down to rest, and viscoelastic half-spaces."""

import numpy as np
import pytest
import xarray as xr

import contact_study
from bem_adhesion import HardWall, LennardJones104, rough_contact
from bem_adhesion.contacts.viscoelastic import ViscoelasticContact
from bem_adhesion.study.overdamped import OverdampedContact
from bem_adhesion.study.path_in_time import TimeState, steps_in_time
from contact_study.campaign import worker
from contact_study.physics.solids import Viscoelastic
from contact_study.results.overdamped_path import Status, at_rest, follow, pace_of
from contact_study.results.schema import TRAJECTORY
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.bem_adhesion.paper_system import E_STAR, R0, SIZE, self_affine, stepped, study_table
from tests.bem_adhesion.test_studies import viscoelastic
from tests.md_reference.systems import assert_equal_groups, groups_of
from tests.recording import stopper

SMALL = 80e-10


def table(points=32, ratio=4.0, load=2e8, rms=3e-10, **sections):
    interaction = {"well_depth_ratio": ratio}
    merged = {"surface": {"rms_height": rms, "cutoff_mode": 6}, "interaction": interaction, "loading": {"path": [load]}}
    return study_table(points, size=SMALL, **{**merged, **sections})


class Motion:
    def __init__(self, **asked):
        (case,) = make_study(table(overdamped={"step_error": 0.1, "loading_rate": 1e-2}, **asked)).cases
        self.surface, self.load, self.work = realise(case), case.path[0][0], case.law.work_of_adhesion
        self.pace = pace_of(case, self.surface.size)
        self.contact = OverdampedContact(case, self.surface, self.pace.allowed)
        self.stiffness = 0.5 * E_STAR * self.surface.grid.wavenumber

    def energy_and_slope(self, gap):
        s, bent = R0 / gap, gap + self.surface.sampled
        flexure = np.fft.irfft2(self.stiffness * np.fft.rfft2(bent))
        law = 5 / 3 * self.work * (0.4 * s**10 - s**4)
        return np.mean(0.5 * bent * flexure + law), flexure + 20 * self.work / (3 * R0) * (s**5 - s**11) + self.load


def test_friction_balances_what_a_step_leaves():
    motion = Motion()
    start, drag = motion.contact.separated(), motion.stiffness.max()
    moved = motion.contact.advance(start, motion.load, drag)
    friction, force = drag * (moved.state - start), np.abs(motion.energy_and_slope(start)[1]).max()
    assert np.abs(friction).max() > 0.3 * force
    # Solved to a tenth of the force.
    np.testing.assert_allclose(motion.energy_and_slope(moved.state)[1], -friction, atol=0.11 * force)


@pytest.mark.parametrize("law", ["lennard_jones_10_4", "exponential"])
def test_energy_never_rises_and_rest_is_an_equilibrium(law):
    interaction = {"law": law, "well_depth_ratio": 4.0, "contact_distance": None}
    motion = Motion(interaction=interaction)
    begin = at_rest(motion.contact.separated(), 0.0, motion.pace)
    found = list(follow(motion.contact, begin, motion.load, motion.pace))
    energies = [each.found.solution.elastic_energy + each.found.solution.interaction_energy for each in found]
    gaps, loads = np.array([(each.state.mean(), each.load) for each in found]).T
    # At the load of its end no step rises; the line search takes energies that are equal to 1e-9.
    change = np.diff(energies) + loads[1:] * np.diff(gaps)
    assert np.all(change <= 1e-9 * np.abs(energies[1:]))
    assert np.sum(change) < -0.1 * abs(energies[-1])
    assert found[-1].fate is Status.AT_REST
    still = contact_study.run(table(interaction=interaction), "continuum")
    assert energies[-1] == pytest.approx((still.elastic_energy + still.interaction_energy).item(), rel=1e-6)
    if law == "lennard_jones_10_4":
        for each, own in zip(found, energies, strict=True):
            energy, slope = motion.energy_and_slope(each.state)
            assert energy == pytest.approx(own, rel=1e-9, abs=1e-12)
        assert np.abs(slope).max() < 1.5e-8 * E_STAR


FLOW = table(
    solver={"path": "overdamped"},
    loading={"path": ["1 GPa", "-0.5 GPa", "-10 GPa", "-0.5 GPa", "0.5 GPa"]},
    output={"fields": True, "stiffness": True},
)


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    path = tmp_path_factory.mktemp("loop") / "bem.nc"
    contact_study.run(FLOW, "continuum", output=path)
    return path


def test_loop_of_contact_pull_off_and_new_contact(loop):
    groups = groups_of(loop)
    root, area = groups["/"], groups[f"/{TRAJECTORY}"].relative_contact_area.values
    np.testing.assert_array_equal(root.detached, [0, 0, 1, 1, 0])
    np.testing.assert_array_equal(root.converged, 1)
    assert np.all(np.isinf(root.mean_gap[2:4]))
    assert np.all(root.residual <= 1e-8)
    still = contact_study.run({**FLOW, "solver": {}}, "continuum")
    np.testing.assert_array_equal(still.detached, root.detached)
    here = [0, 1, 4]
    np.testing.assert_allclose(root.mean_pressure[here], [1e9, -0.5e9, 0.5e9], atol=2e-8 * E_STAR)
    for name in ("relative_contact_area", "mean_gap", "elastic_energy", "contact_stiffness"):
        np.testing.assert_allclose(root[name][here], still[name][here], rtol=1e-4)
    lengths = np.sum(np.isfinite(area), axis=1)
    np.testing.assert_array_equal(lengths[here], root.iterations[here])
    assert np.all(root.fft_pairs[here] > 2 * root.iterations[here])
    # The series of the first point is the descent: nothing touches at its beginning.
    assert area[0, 0] == 0
    assert area[0, lengths[0] - 1] == root.relative_contact_area[0]


def test_run_stopped_on_the_way_goes_on_to_the_same_bits(loop, tmp_path, monkeypatch):
    path = tmp_path / "bem.nc"
    stop_at, _ = stopper(monkeypatch, OverdampedContact, "advance")
    monkeypatch.setattr(worker, "_SECONDS_BETWEEN_CHECKPOINTS", 0.0)
    with xr.open_dataset(loop) as root:
        first = int(root.iterations[0])
    for number, stop in enumerate((first - 5, 15)):  # on the way to the first point, to a later one
        stop_at(stop)
        with pytest.raises(KeyboardInterrupt):
            contact_study.run(FLOW, "continuum", output=path, resume=number > 0)
    stop_at(10**6)
    contact_study.run(FLOW, "continuum", output=path, resume=True)
    assert_equal_groups(groups_of(path), groups_of(loop))


def test_a_wall_without_attraction_has_one_state_by_any_path_and_full_contact_is_rest():
    flow, still = (
        contact_study.run(table(solver=solver) | {"interaction": {"law": "hard_wall"}}, "continuum")
        for solver in ({"path": "overdamped"}, {})
    )
    assert flow.relative_contact_area.item() == still.relative_contact_area.item() > 0
    study = table(32, rms=0.2e-10, load=10e9, solver={"path": "overdamped"})
    study["interaction"] = {"law": "exponential", "work_of_adhesion": 0.69, "length": "1.7 angstrom"}
    found = contact_study.run(study, "continuum")
    assert found.relative_contact_area == found.converged == 1


pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

RELAXED = 1e9
SOLID = Viscoelastic(RELAXED, (2e9, 1e9), (1.0, 0.1))
INSTANTANEOUS = 4e9
LAW = LennardJones104(0.05, 1e-9)
Q, WAVE = 2 * np.pi / SIZE, np.cos(2 * np.pi * np.arange(16) / 16) * np.ones((16, 1))


def relaxing(height, law=None, size=SIZE, solid=SOLID, **options):
    return ViscoelasticContact(height, size, solid, law or HardWall(), **{"tolerance": 1e-10, **options})


def followed(contact, targets, duration, steps):
    state, now, found = contact.separated(), TimeState(0.0), []
    for target in targets:
        *_, (solution, now) = steps_in_time(contact, state, now, target, duration, steps)
        state = solution.state
        found.append((solution, now))
    return found


def test_a_wave_pressed_flat_relaxes_as_its_branches_do():
    amplitude, ramp = 1e-10, 0.3
    contact = relaxing(amplitude * WAVE)
    solution, _ = contact.step(contact.separated(), 2e7, ramp)  # the load closes every gap
    time = 0.0
    for wait in (0.0, 0.05, 0.45, 1.0, 2.5):
        if wait:
            solution, _ = contact.step(solution.state, 2e7, wait)
        time += wait
        assert not solution.gap.any()
        modulus = RELAXED + sum(
            branch * tau / ramp * (1 - np.exp(-ramp / tau)) * np.exp(-time / tau)
            for branch, tau in zip(SOLID.branch_moduli, SOLID.relaxation_times, strict=True)
        )
        assert 2 * np.mean(solution.pressure * WAVE) == pytest.approx(modulus * Q / 2 * amplitude, rel=1e-9)
    with pytest.raises(ValueError, match="duration = 0"):
        contact.step(contact.separated(), 1e6, 0.0)


def test_a_wave_creeps_under_a_law_as_in_closed_form():
    # Of 1e-15 m so that the law is a spring, as stiff as the solid; the tolerance is what rounding leaves of that.
    law, solid, errors = LennardJones104(0.003, 1e-9), Viscoelastic(RELAXED, (3e9,), (1.0,)), []
    contact = relaxing(1e-15 * WAVE, law, solid=solid, tolerance=1e-13)
    first, _ = contact.step(contact.separated(), 1e6, 1e-9)
    spring = float(law.stiffness(np.array(first.gap.mean())))
    slow, fast = (spring + modulus * Q / 2 for modulus in (RELAXED, INSTANTANEOUS))
    expected = 1e-15 * spring * (1 / slow + (1 / fast - 1 / slow) * np.exp(-2.0 * slow / fast))
    for steps in (2, 4, 40):
        found = first
        for _ in range(steps):
            found, _ = contact.step(found, 1e6, 2.0 / steps)
        errors.append(2 * np.mean(found.state[1] * WAVE) / expected - 1)
    assert 3 < errors[0] / errors[1] < 5  # halving the step quarters the error
    assert abs(errors[2]) < 1e-4


@pytest.mark.parametrize("law", [HardWall(), LAW])
@pytest.mark.parametrize(("duration", "modulus"), [(1e9, RELAXED), (1e-9, INSTANTANEOUS)])
def test_slow_and_fast_paths_are_those_of_elastic_solids(law, duration, modulus):
    height, _ = self_affine(32)
    tolerance = 1e-9
    elastic, loads = rough_contact(height, SIZE, modulus, law, tolerance=tolerance), [1e7, 4e7, 2e7]
    found = followed(relaxing(height, law, tolerance=tolerance), loads, duration, 1)
    for (solution, _), expected in zip(found, stepped(elastic, loads), strict=True):
        assert solution.converged
        # What the solvers leave, and one part in 1e8 of the time that the ramp takes of the slowest branch.
        np.testing.assert_allclose(solution.gap, expected.gap, atol=2e-7 * height.std())
        assert solution.elastic_energy == pytest.approx(expected.elastic_energy, rel=1e-6)
    assert found[-1][1].dissipated < 1e-6 * solution.elastic_energy


def test_work_of_the_load_is_stored_or_dissipated():
    height, _ = self_affine(32)

    def unaccounted(steps):
        """Over a cycle of one second up and one down, from 10 MPa on; as a share of what is dissipated."""
        contact, up = relaxing(height), np.linspace(1e7, 4e7, steps + 1)
        found = [followed(contact, [1e7], 1.0, 4)[0]]
        for target in [*up[1:], *up[-2::-1]]:
            found.append([*steps_in_time(contact, found[-1][0].state, found[-1][1], target, 1.0 / steps, 1)][-1])
        pressures, gaps = np.array([(one.pressure.mean(), one.gap.mean()) for one, _ in found]).T
        lost = found[-1][1].dissipated - found[0][1].dissipated
        assert lost > 0.05 * found[-1][0].elastic_energy
        stored = found[-1][0].elastic_energy - found[0][0].elastic_energy
        return (-np.trapezoid(pressures, gaps) - stored - lost) / lost

    coarse, fine = unaccounted(4), unaccounted(16)
    assert abs(fine) < 0.01
    assert abs(coarse / fine) > 6  # second order would give 16


def test_surfaces_torn_apart_relax_and_come_together_again():
    height, _ = self_affine(32)
    contact = relaxing(height, LAW, tolerance=1e-8)
    (pressed, _), (torn, _), (waited, _), (again, _) = followed(contact, [2e7, -5e8, -5e8, 2e7], 1.0, 1)
    assert [one.detached for one in (pressed, torn, waited, again)] == [False, True, True, False]
    assert 0 < waited.state[1].std() < torn.state[1].std() < pressed.state[1].std()
    assert pressed.converged
    assert again.converged
    assert np.all(again.gap > 0)


def test_the_pull_off_of_a_path_in_time_lies_between_its_points():
    sticky = {"law": "lennard_jones_10_4", "work_of_adhesion": 0.05, "length": 1e-9}
    time = {"duration": 1.0, "time_steps": 12}
    loadings = {"path": [2e7, -4e7], **time}, {"path": [1e-9, 12e-9], "control": "gap", **time}
    torn, pulled = (contact_study.run(viscoelastic(loading=each, interaction=sticky)) for each in loadings)
    assert torn.detached.values.tolist() == [0, 1]
    held, off = float(torn.pull_off_pressure), float(torn.pull_off_pressure_resolution_error)
    assert -4e7 < held - off < held < 0
    assert off == pytest.approx(6e7 / 12)  # a step of the load
    passed = pulled.passed_pressure.values
    assert passed.shape == (2, 12)
    np.testing.assert_allclose(passed[:, -1], pulled.mean_pressure, rtol=1e-12)
    np.testing.assert_allclose(pulled.passed_separation[:, -1], pulled.mean_separation, rtol=1e-12)
    assert float(pulled.pull_off_pressure) == passed[1].min() < 3 * float(pulled.mean_pressure[-1]) < 0
    # Work goes into the solid as well: what the energy does not hold is no jump.
    assert not {"work_of_separation", "jump_in_pressure", "dissipated_energy"} & set(pulled)
