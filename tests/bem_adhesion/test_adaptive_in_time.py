"""Adaptive steps of time on a viscoelastic half-space: the account of work, and what of it jumps lose."""

import numpy as np
import pytest

import contact_study

pytestmark = pytest.mark.filterwarnings("ignore:.*process zone")

WORK, TIME = 0.05, 1.0
SPHERE = {"kind": "sphere", "radius": "1 um", "size": "1.6 um", "shape": [32, 32]}
LOOP = [400e-9, 160e-9, 400e-9]
FLAT = {"kind": "flat", "size": "1 um", "shape": [8, 8]}
# A wave that a law of 6 nm closes and opens at once, on a solid of 30 MPa.
WAVE, BEND, PATH = {"kind": "wavy", "size": "200 nm", "shape": [8, 8], "amplitude": "6 nm"}, 30e6, [6e-8, 4e-9, 6e-8]


def run(surface, modulus, branch=0.0, length=20e-9, **loading):
    """A path on a half-space of a relaxed modulus and the modulus of one branch (Pa), elastic without one."""
    table = {
        "surface": surface,
        "material": {"youngs_modulus": modulus, "poissons_ratio": 0.5},
        "interaction": {"law": "lennard_jones_10_4", "work_of_adhesion": WORK, "length": length},
        "loading": {"control": "gap", "adaptive": True, **loading},
    }
    if branch:
        table["elasticity"] = {"kind": "viscoelastic", "branch_youngs_moduli": [branch], "relaxation_times": [TIME]}
    return contact_study.run(table, "continuum")


def last(found, name):
    return float(found[name].values.flat[-1])


def test_flat_surfaces_jump_in_for_all_of_their_work_and_the_solid_takes_none():
    found = run(FLAT, 10e6, 90e6, control="pressure", path=[1e3], duration=1.0)
    # Less the work of the load over the reach of 3.6 lengths, and the energy of the law's far end, 0.1 %.
    assert last(found, "dissipated_energy") == pytest.approx(WORK, rel=2e-3)
    assert abs(last(found, "viscous_dissipation")) < 1e-9 * WORK


@pytest.mark.validation
@pytest.mark.parametrize(
    "loading",
    [
        {"path": LOOP, "duration": [1.0, 9.0, 3.0]},
        pytest.param(
            {"path": [4e5, 4e5, -1e5], "duration": [1.0, 9.0, 0.3], "control": "pressure"}, marks=pytest.mark.validation
        ),
    ],
)
def test_work_is_stored_dissipated_or_lost_in_jumps(loading):
    found = run(SPHERE, 10e6, 90e6, **loading)
    steps = run(SPHERE, 10e6, 90e6, **{**loading, "adaptive": False, "time_steps": 100})
    lost = last(found, "viscous_dissipation")
    # Both are of second order: half the equal steps change their loss by 0.1 %.
    assert lost == pytest.approx(last(steps, "viscous_dissipation"), rel=0.01)
    assert found.passed_pressure.notnull().sum().item() < 0.6 * 300
    assert abs(last(found, "unaccounted_work")) < 0.01 * lost
    pressure, separation, energy, viscous = (
        np.concatenate([step[~np.isnan(step)] for step in found[f"passed_{name}"].values])
        for name in ("pressure", "separation", "energy", "viscous_dissipation")
    )
    begin = int(found.passed_pressure[0].count()) - 1
    work = -np.trapezoid(pressure[begin:], separation[begin:])
    others = sum(float(found[name][-1] - found[name][0]) for name in ("dissipated_energy", "unaccounted_work"))
    assert work == pytest.approx(np.ptp((energy + viscous)[[begin, -1]]) + others, abs=1e-9 * lost)


@pytest.mark.validation
def test_a_fast_loop_jumps_as_the_instantaneous_solid_does():
    given = {"path": LOOP, "length": 12e-9, "resolution": 0.02}
    found, stiff = run(SPHERE, 3e6, 7e6, duration=1e-6, **given), run(SPHERE, 10e6, **given)
    assert last(stiff, "dissipated_energy") > 0.5 * float(stiff.work_of_separation)
    for name in ("dissipated_energy", "work_of_separation", "jump_in_separation"):
        off = last(found, f"{name}_resolution_error") + last(stiff, f"{name}_resolution_error")
        assert last(found, name) == pytest.approx(last(stiff, name), abs=off), name
    assert float(found.pull_off_pressure) == pytest.approx(float(stiff.pull_off_pressure), rel=0.01)
    assert last(found, "viscous_dissipation") < 1e-4 * last(found, "dissipated_energy")


@pytest.mark.validation
def test_a_slow_loop_loses_viscously_what_the_relaxed_solid_loses_in_jumps():
    """The way from a fold to the next branch takes relaxation times, so no jump is left; energies fix the loss."""
    given = {"path": PATH, "length": 6e-9}
    found, soft = run(WAVE, BEND, 3 * BEND, duration=1e3, **given), run(WAVE, BEND, **given, resolution=0.001)
    assert last(found, "dissipated_energy") < 1e-3 * last(soft, "dissipated_energy")
    # What is lost on the branches between, by the rate of the load: 1 % at ten times the duration.
    assert last(found, "viscous_dissipation") == pytest.approx(last(soft, "dissipated_energy"), rel=0.05)
    assert last(found, "work_of_separation") == pytest.approx(last(soft, "work_of_separation"), rel=0.02)


@pytest.mark.validation
def test_the_work_of_separation_is_largest_at_intermediate_speeds_and_the_force_at_the_fastest():
    """As M. H. Müser & B. N. J. Persson, EPL 137, 36004 (2022), find for a cylinder (abstract)."""
    surface, works, forces = {**SPHERE, "shape": [27, 27]}, [], []
    for speed in (1e-10, 3e-9, 1e-5):
        given = {"path": [3e-7, 2e-7, 2e-7, 5e-7], "speed": [1e-6, 1e-8, 1e-8, speed], "duration": 30.0}
        found = run(surface, 10e6, 90e6, length=40e-9, **given)
        works.append(float(found.work_of_separation))
        forces.append(-float(found.pull_off_pressure))
    # 1.5 times that of the slowest and 1.4 times that of the fastest, as on the grid of examples/viscoelastic_pull_off.
    assert works[1] > 1.3 * max(works[0], works[2])
    assert forces[0] < 0.8 * forces[1] < 0.8 * forces[2]
