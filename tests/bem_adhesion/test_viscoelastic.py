"""A viscoelastic half-space: closed forms of relaxation and creep, its limits, order in time, energies, studies."""

import numpy as np
import pytest

import contact_study
from bem_adhesion import HardWall, LennardJones104, rough_contact
from bem_adhesion.contacts.viscoelastic import ViscoelasticContact
from bem_adhesion.study.paths import TimeState, steps_in_time
from contact_study.physics.solids import Viscoelastic
from tests.bem_adhesion.paper_system import SIZE, self_affine, stepped
from tests.bem_adhesion.test_studies import viscoelastic

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

RELAXED = 1e9
SOLID = Viscoelastic(RELAXED, (2e9, 1e9), (1.0, 0.1))
INSTANTANEOUS = 4e9
LAW = LennardJones104(0.05, 1e-9)


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
    amplitude, q, ramp = 1e-10, 2 * np.pi / SIZE, 0.3
    wave = np.cos(2 * np.pi * np.arange(16) / 16) * np.ones((16, 1))
    contact = relaxing(amplitude * wave)
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
        assert 2 * np.mean(solution.pressure * wave) == pytest.approx(modulus * q / 2 * amplitude, rel=1e-9)
    with pytest.raises(ValueError, match="duration = 0"):
        contact.step(contact.separated(), 1e6, 0.0)


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
        contact = relaxing(height)
        state, now = contact.separated(), TimeState(0.0)
        *_, (solution, now) = steps_in_time(contact, state, now, 1e7, 1.0, 4)
        work, stored, dissipated = 0.0, solution.elastic_energy, now.dissipated
        for target in [*np.linspace(1e7, 4e7, steps + 1)[1:], *np.linspace(4e7, 1e7, steps + 1)[1:]]:
            before = solution
            *_, (solution, now) = steps_in_time(contact, solution.state, now, target, 1.0 / steps, 1)
            pressures = before.pressure.mean() + solution.pressure.mean()
            work -= 0.5 * pressures * (solution.gap.mean() - before.gap.mean())
        lost = now.dissipated - dissipated
        assert lost > 0.05 * solution.elastic_energy
        return (work - (solution.elastic_energy - stored) - lost) / lost

    coarse, fine = unaccounted(4), unaccounted(16)
    assert abs(fine) < 0.01
    assert abs(coarse / fine) > 6  # second order would give 16


def test_surfaces_torn_apart_relax_and_come_together_again():
    height, _ = self_affine(32)
    contact = relaxing(height, LAW, tolerance=1e-8)
    (pressed, _), (torn, _), (waited, _), (again, _) = followed(contact, [2e7, -5e8, -5e8, 2e7], 1.0, 1)
    assert pressed.converged
    assert torn.detached
    assert waited.detached
    assert 0 < waited.state[1].std() < torn.state[1].std() < pressed.state[1].std()
    assert again.converged
    assert not again.detached
    assert np.all(again.gap > 0)


def test_the_pull_off_of_a_path_in_time_lies_between_its_points():
    sticky = {"law": "lennard_jones_10_4", "work_of_adhesion": 0.05, "length": 1e-9}
    torn, pulled = (
        contact_study.run(viscoelastic(loading={**loading, "duration": 1.0, "time_steps": 12}, interaction=sticky))
        for loading in ({"path": [2e7, -4e7]}, {"path": [1e-9, 12e-9], "control": "gap"})
    )
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
