"""The continuum in slow motion against friction: down the steepest descent of its energy, to rest."""

import dataclasses

import numpy as np
import pytest
import xarray as xr

import contact_study
from bem_adhesion.study.overdamped import OverdampedContact
from contact_study.campaign import worker
from contact_study.numerics.gradient_flow import Status, at_rest, follow
from contact_study.results.overdamped_path import pace_of
from contact_study.results.schema import TRAJECTORY
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.bem_adhesion.paper_system import E_STAR, R0, study_table
from tests.md_reference.systems import assert_equal_groups, groups_of
from tests.recording import stopper

SIZE = 80e-10


def table(points=32, ratio=4.0, load=2e8, rms=3e-10, **sections):
    interaction = {"well_depth_ratio": ratio}
    merged = {"surface": {"rms_height": rms, "cutoff_mode": 6}, "interaction": interaction, "loading": {"path": [load]}}
    return study_table(points, size=SIZE, **{**merged, **sections})


class Motion:
    def __init__(self, **asked):
        self.case = make_study(table(**asked)).cases[0]
        self.surface, self.load, self.work = realise(self.case), self.case.path[0][0], self.case.law.work_of_adhesion
        given = dataclasses.replace(self.case.overdamped, step_error=0.1, loading_rate=1e-2)
        self.pace = pace_of(dataclasses.replace(self.case, overdamped=given), self.surface.size)
        self.contact = OverdampedContact(self.case, self.surface, self.pace.allowed)
        q = self.surface.grid.wavenumber
        self.stiffness = 0.5 * E_STAR * q

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
    root, series = groups["/"], groups[f"/{TRAJECTORY}"]
    np.testing.assert_array_equal(root.detached, [0, 0, 1, 1, 0])
    np.testing.assert_array_equal(root.converged, 1)
    assert np.all(np.isinf(root.mean_gap[2:4]))
    np.testing.assert_allclose(root.mean_pressure[[0, 1, 4]], [1e9, -0.5e9, 0.5e9], atol=2e-8 * E_STAR)
    assert np.all(root.residual <= 1e-8)
    still = contact_study.run({**FLOW, "solver": {}}, "continuum")
    np.testing.assert_array_equal(still.detached, root.detached)
    for name in ("relative_contact_area", "mean_gap", "elastic_energy", "contact_stiffness"):
        found, expected = (each[name].values[[0, 1, 4]] for each in (root, still))
        np.testing.assert_allclose(found, expected, rtol=1e-4)
    area = series.relative_contact_area.values
    lengths = np.sum(np.isfinite(area), axis=1)
    np.testing.assert_array_equal(lengths[[0, 1, 4]], root.iterations[[0, 1, 4]])
    assert np.all(root.fft_pairs[[0, 1, 4]] > 2 * root.iterations[[0, 1, 4]])
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
    wall = {"law": "hard_wall", "work_of_adhesion": None, "length": None, "contact_distance": None}
    flow, still = (
        contact_study.run(table(interaction={**wall, "well_depth_ratio": None}, solver=solver), "continuum")
        for solver in ({"path": "overdamped"}, {})
    )
    assert flow.relative_contact_area.item() == still.relative_contact_area.item() > 0
    study = table(32, rms=0.2e-10, load=10e9, solver={"path": "overdamped"})
    study["interaction"] = {"law": "exponential", "work_of_adhesion": 0.69, "length": "1.7 angstrom"}
    found = contact_study.run(study, "continuum").isel(step=0)
    assert found.relative_contact_area == found.converged == 1
