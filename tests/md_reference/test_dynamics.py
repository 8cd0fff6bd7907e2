"""Molecular dynamics as a user meets it: an approach, a rest, a thermostat, checkpoints; whether a block is at rest."""

import re
from contextlib import nullcontext

import numpy as np
import pytest

import contact_study
from contact_study.inputs.errors import InputError
from contact_study.results.schema import STANDARD_ERROR, TRAJECTORY
from contact_study.study.study import make_study
from md_reference.study.dynamics import largest_time_step, longitudinal_modulus, time_step
from md_reference.thermal.checkpoint import ChainState, Frame, TrajectoryState
from md_reference.thermal.equilibration import Descent, load_missing, not_in_equilibrium, still_moving
from md_reference.thermal.hmc import SamplerState
from md_reference.thermal.langevin import Motion
from tests.md_reference.systems import E_STAR, MOVING, R0, SMALL, SPACING, changed, groups_of, moving

SHORT = pytest.mark.filterwarnings("ignore:.* states of a point", "ignore:dynamics.damping = 0")


def run(table, warning=None, **options):
    with pytest.warns(UserWarning, match=warning) if warning else nullcontext():
        return contact_study.run(table, "atomistic", **options)


def case_of(table):
    return make_study(table).cases[0]


@pytest.mark.validation
def test_explicit_block_comes_to_rest_where_the_condensed_one_does():
    interaction = {"well_depth_ratio": 8}
    rest = run(moving(interaction=interaction))
    still = run(moving(interaction=interaction, atomistic={"method": "quasi_static"}, dynamics={}))
    assert rest.converged.item() == 1
    assert not [name for name in rest if name.endswith(STANDARD_ERROR)]
    # 12 layers of atoms and 2 of cells twice as large: E*(q_L) is 0.2 % off, and an atom more or less in contact.
    np.testing.assert_allclose(rest.relative_contact_area, still.relative_contact_area, rtol=0, atol=0.002 + 1 / 16**2)
    np.testing.assert_allclose(rest.mean_separation, still.mean_separation, rtol=0, atol=0.003 * R0)
    np.testing.assert_allclose(rest.interaction_energy, still.interaction_energy, rtol=0.01)
    np.testing.assert_allclose(rest.elastic_energy, still.elastic_energy, rtol=0.02)
    np.testing.assert_allclose(rest.mean_pressure, 1e9, rtol=1e-3)


@SHORT
def test_series_tells_the_approach(tmp_path):
    study = moving(dynamics={"duration": "2 ps", "damping": 0.0, "approach_speed": "20 m/s"})
    run(study, "did not converge", output=tmp_path / "md.nc")
    groups, case = groups_of(tmp_path / "md.nc"), case_of(study)
    root, series, step = groups["/"], groups[f"/{TRAJECTORY}"].isel(step=0), time_step(case)
    assert "Pa on average, not the 1e+09 Pa applied" in str(root.message.values[0])
    # All the duration in whole steps, which the frames share evenly: here 6 and 7.
    time, whole = series.time.values, round(2e-12 / step)
    assert whole % 20
    assert root.time.item() == time[-1] == pytest.approx(whole * step, rel=1e-9, abs=0)
    np.testing.assert_allclose(np.diff(time, prepend=0) / step, np.diff(whole * np.arange(21) // 20), rtol=1e-9)
    assert (root.iterations.item(), root.force_evaluations.item()) == (whole, whole + 20)
    mass = case.material.atom_mass / case.lattice.constant**2 * 16.25
    fallen = 20 * time + 0.5 * 1e9 / mass * time**2
    assert -np.ptp(series.mean_separation.values[[0, -1]]) == pytest.approx(fallen[0] - fallen[-1], rel=0.2)
    assert series.temperature[0] > 0
    assert np.ptp(series.mechanical_energy.values) < 1e-3 * np.ptp(series.kinetic_energy.values)
    assert series.kinetic_energy[0].item() == pytest.approx(0.5 * mass * 20**2, rel=0.3)  # it is faster by then


@pytest.mark.validation
@SHORT
def test_a_block_in_flight_did_not_converge_and_one_without_damping_has_the_means_of_its_motion():
    # All forces are small but those of the impact to come.
    flying = {"duration": "1 ps", "damping": "1e-6 ps^-1", "approach_speed": "100 m/s"}
    study = moving(loading={"path": ["1 MPa"]}, dynamics=flying)
    dataset, case = run(study, "did not converge"), case_of(study)
    impact = 100 * np.sqrt(longitudinal_modulus(case) * case.material.atom_mass / case.lattice.constant**3)
    assert (dataset.converged.item(), dataset.relative_contact_area.item()) == (0, 0)
    assert dataset.residual.item() == pytest.approx(impact / E_STAR, rel=0.01)
    swinging = {"damping": 0.0, "approach_speed": "20 m/s", "frames": 200}
    dataset = run(moving(dynamics=swinging), r"dynamics\.damping = 0: nothing takes the energy of the")
    assert dataset.converged.item() == 1
    assert dataset.mean_pressure.item() == pytest.approx(1e9, rel=0.1)
    assert 0 < dataset["relative_contact_area" + STANDARD_ERROR].item() < 0.5


def test_a_block_that_damping_slows_is_said_to_fall_and_how_fast():
    slow = {"duration": "3 ps", "damping": "5 ps^-1", "approach_speed": 0.0, "frames": 4}
    study = moving(surface=SMALL, dynamics=slow)
    message, case = str(run(study, "did not converge").message.values[0]), case_of(study)
    said = re.match(r"the block still falls at (\S+) m/s: .* damping limits its fall to (\S+) m/s", message)
    assert said
    # Nine planes of nodes, of which the uppermost stands for half a layer.
    mass = 8.5 * case.material.atom_mass / case.lattice.constant**2
    # Three digits are printed; what is left of the start after 15 times of damping is measured to be below them.
    assert [float(speed) for speed in said.groups()] == pytest.approx([1e9 / (mass * 5e12)] * 2, rel=0.01)


@pytest.mark.validation
@pytest.mark.filterwarnings("ignore:.* did not converge")
def test_a_single_state_that_counts_is_warned_of():
    two = {"duration": "1 ps", "frames": 2}
    warm = moving(atomistic={"temperature": 300.0}, dynamics=two, surface=SMALL)
    dataset = run(warm, "one state of a point counts: .*; raise dynamics.frames")
    assert "mean_gap" + STANDARD_ERROR not in dataset
    # Turning springs move nearly as linear ones.
    flat = {"surface": {**SMALL, "rms_height": "0.3 angstrom"}, "dynamics": {"duration": "4 ps", "frames": 2}}
    blocks = "isotropic", "nonlinear_springs"
    linear, turning = (run(moving(atomistic={"block": block}, **flat)).mean_gap.item() for block in blocks)
    assert 1e-6 < abs(linear / turning - 1) < 1e-2


@pytest.mark.validation
def test_warm_blocks_explicit_and_condensed_agree():
    loading, given = {"path": ["3 GPa"]}, {"duration": "100 ps", "damping": "0.5 ps^-1", "frames": 800}
    explicit = run(moving(atomistic={"temperature": 300.0}, dynamics=given, loading=loading))
    condensed = run(changed(surface=MOVING["surface"], sampling={"trajectories": 600}, loading=loading))
    allowed = {"relative_contact_area": 0.002, "mean_separation": 0.003 * R0, "mean_pressure": 0}
    for name, allowance in allowed.items():
        error = np.hypot(explicit[name + STANDARD_ERROR].item(), condensed[name + STANDARD_ERROR].item())
        assert abs(explicit[name].item() - condensed[name].item()) < 4 * error + allowance
    assert explicit.converged.item() == 1
    assert explicit.temperature.item() == pytest.approx(300, abs=4 * explicit.temperature_standard_error.item())


def driven(path, **sections):
    given = {"duration": "40 ps", "damping": "0.6 ps^-1", "approach_speed": "50 m/s", "frames": 10}
    loading = {"control": "gap", "path": path}
    return moving(**{"dynamics": given, "loading": loading, "surface": SMALL, **sections})


@pytest.mark.validation
def test_driven_plane_goes_where_it_is_told_at_its_speed(tmp_path):
    study = driven(["0.2 nm", "0.05 nm", "0.05 nm", "0.0525 nm", "1.2 nm"])
    dataset, case = run(study, output=tmp_path / "md.nc"), case_of(study)
    gaps, times, step = dataset.applied_gap.values, np.diff(dataset.time.values), time_step(case)
    # Whole steps: up to one longer.
    for moved, taken in ((0.15e-9, times[0]), (0.0025e-9, times[2]), (1.1475e-9, times[3])):
        assert 0 <= taken - moved / 50 < step
    assert times[1] == pytest.approx(40e-12, abs=0.5 * step)  # at rest, for the duration
    np.testing.assert_allclose(dataset.iterations[1:] * step, times, rtol=1e-9)
    frames = np.isfinite(groups_of(tmp_path / "md.nc")[f"/{TRAJECTORY}"].time.values).sum(axis=1)
    assert frames.tolist() == [10, 10, 10, dataset.iterations[3], 10]  # no more than steps
    assert dataset.detached.values.tolist() == [0, 0, 0, 0, 1]
    assert np.all(dataset.elastic_energy > 0)
    at, thickness = dataset.isel(step=2), 8 * SPACING
    squeezed = at.mean_pressure * thickness / longitudinal_modulus(case)
    assert at.residual < 1e-4
    # The forces left, over E*, times the thickness, are far less.
    assert abs(squeezed) > 10 * 1e-4 * thickness
    assert at.mean_separation.item() == pytest.approx(gaps[2] + squeezed.item(), abs=1e-4 * thickness)
    still = run(driven([at.mean_separation.item()], atomistic={"method": "quasi_static"}, dynamics={}))
    assert at.mean_pressure.item() == pytest.approx(still.mean_pressure.item(), rel=0.005, abs=1e-4 * E_STAR)
    assert at.relative_contact_area.item() == pytest.approx(still.relative_contact_area.item(), abs=0.01)
    # A layer is where what holds it is.
    held = run(driven(["0.2 nm"], elasticity={"kind": "layer", "thickness": "20.8 angstrom"}))
    free = dataset.isel(step=0)
    assert abs(held.mean_pressure.item()) > 1e9
    assert held.mean_separation.item() == pytest.approx(0.2e-9, rel=1e-6)
    assert free.mean_pressure.item() == pytest.approx(held.mean_pressure.item(), rel=1e-9)
    assert free.elastic_energy.item() < held.elastic_energy.item()


@pytest.mark.validation
def test_a_torn_off_block_comes_down_again():
    study = moving(loading={"path": ["1 GPa", "-3.5 GPa", "1 GPa"]}, surface=SMALL, dynamics={"duration": "60 ps"})
    dataset, step = run(study), time_step(case_of(study))
    assert dataset.detached.values.tolist() == [0, 1, 0]
    assert np.isinf(dataset.mean_gap[1])
    assert "was torn off" in str(dataset.message.values[1])
    np.testing.assert_allclose(np.diff(dataset.time, prepend=0.0), dataset.iterations * step, rtol=1e-9)
    area = dataset.relative_contact_area.values
    assert 0.5 < area[2] == pytest.approx(area[0], abs=0.01)
    dataset = run(moving(loading={"path": ["-1 GPa"]}, dynamics={"approach_speed": 0.0}, surface=SMALL))
    assert "has not been within reach of the substrate" in str(dataset.message.values[0])


@SHORT
def test_a_blow_too_hard_for_the_time_step_says_so():
    strong = {"interaction": {"well_depth_ratio": 8}}
    case = case_of(moving(**strong))
    assert time_step(case) == 0.2 * largest_time_step(case)
    fast = {"approach_speed": "300 m/s", "damping": 0.0, "time_step": 0.98 * largest_time_step(case)}
    with pytest.raises(InputError, match=r"dynamics\.time_step = .* an atom ran into the substrate .* a shorter one"):
        run(moving(**strong, dynamics=fast))


def descent(carried, load=1e9, speed=0.0, terminal_speed=np.inf, impact=0.0):
    return Descent(np.asarray(carried), load, bool(np.any(carried)), speed, terminal_speed, impact)


def assert_said(words, message):
    assert message.startswith(words)
    assert bool(message) == bool(words)


NOISE = np.random.default_rng(0).normal(scale=2e8, size=400)  # its mean errs by 1e7
NOISE -= NOISE.mean()
# Four standard errors of a block that bounces are 0.4 of its load: by chance for a thermostat, not for swings.
BOUNCING = 10 * NOISE / (NOISE.std() / 2e8)
# The block lands half-way: the series has an error that would account for the half of the load.
LANDING = np.where(np.arange(100) < 50, 0.0, 1e9) + 0.1 * NOISE[:100]


@pytest.mark.parametrize(
    ("carried", "swings", "words"),
    [
        (1e9 + NOISE, False, ""),
        (1.06e9 + NOISE, False, "the interface carried 1.06e+09 ± 1e+07 Pa on average, not the 1e+09 Pa applied"),
        (0.985e9 + 1e-4 * NOISE, False, "the interface carried"),
        (LANDING, False, "the interface carried"),
        (1.2e9 + BOUNCING, False, ""),
        (1.2e9 + BOUNCING, True, "the interface carried 1.2e+09 ± "),
        (1.05e9 + BOUNCING, True, ""),
        ([0.995e9], False, ""),  # one state has no error to miss the load by
        ([0.98e9], False, "the interface carried 9.8e+08 Pa on average, not the 1e+09 Pa applied: raise dynamics.dur"),
    ],
)
def test_the_load_is_carried_within_the_error_of_the_mean(carried, swings, words):
    residual, message = load_missing(descent(carried), E_STAR, swings=swings)
    assert_said(words, message)
    assert residual * E_STAR == pytest.approx(abs(np.mean(carried) - 1e9), abs=0.1)


def test_what_is_said_of_a_block_on_its_way():
    falling = descent([0.4e9, 0.5e9], speed=1.0, terminal_speed=1.5)
    for words in (still_moving(falling, 0.0, E_STAR)[1], load_missing(falling, E_STAR)[1]):
        assert words.startswith("the block still falls at 1 m/s: ")
        assert "lower dynamics.damping: damping limits its fall to 1.5 m/s" in words
    assert still_moving(descent([1e9]), 1e-3 * E_STAR, E_STAR) == (1e-3, "")
    for state, left, words in (
        (descent([0.4e9, 0.5e9], speed=1.0, terminal_speed=15.0), 0.5e9 / E_STAR, "the atoms still move: "),
        (descent([1e9], impact=2e-3 * E_STAR), 2e-3, "the atoms still move: "),
        # A load too small for the bound is not carried by a surface that nothing touches.
        (descent([0.0], load=1e6), 1e6 / E_STAR, "no atom is within reach of the substrate: "),
    ):
        residual, message = still_moving(state, 0.0, E_STAR)
        assert residual == pytest.approx(left)
        assert_said(words, message)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, ""),
        # Nothing forgotten: the square of one normal number, of which four deviations are 16.
        ({"whole": 15.9 * 300, "forgotten": 0.1}, ""),
        ({"whole": 4860, "forgotten": 0.1}, "the block still moves up and down as a whole, with 16.2 times"),
        # The mean of many is near to one; of two states it is not.
        ({"whole": 600, "forgotten": 400.0}, "the block still moves up and down"),
        ({"whole": 600, "forgotten": 400.0, "states": 2}, ""),
        ({"carried": 0.5e9, "whole": 1e6, "speed": 1.0, "terminal_speed": 1.5}, "the block still falls"),
        ({"carried": 0.5e9, "whole": 1e6}, "the block still moves up and down"),
        ({"carried": 0.5e9}, "the interface carried"),
        # Four deviations of sqrt(2/10 000), 5.7 %; of many freedoms a hundredth.
        ({"nodes": 316.0}, ""),
        ({"nodes": 282.0}, "the atoms moved at 282 K on average, not at the thermostat's 300 K: "),
        ({"nodes": 296.0, "freedoms": 10**6}, "the atoms moved at 296 K"),
        ({"nodes": 297.5, "freedoms": 10**6}, ""),
    ],
)
def test_a_block_that_rings_or_is_cold_is_in_no_equilibrium(given, words):
    warmth = {"nodes": 300.0, "whole": 300.0, "bath": 300.0, "freedoms": 10_000, "forgotten": 9.0, **given}
    carried = [warmth.pop("carried", 1e9)] * warmth.pop("states", 100)
    state = descent(carried, 1e9, warmth.pop("speed", 0.0), warmth.pop("terminal_speed", np.inf))
    assert_said(words, not_in_equilibrium(state, E_STAR, **warmth)[1])


def checkpoints():
    rng = np.random.default_rng(1)
    motion = Motion(rng.standard_normal((3, 7)), rng.standard_normal((3, 7)), 2e-9, -300.0, 2e-12)
    series = [Frame(1e-12, 2e-9, 3e8, 300.0, 5.0), Frame(2e-12, 1.9e-9, 4e8, 310.0, 6.0)]
    sampler = SamplerState(np.arange(12).reshape(3, 2, 2) * (1 + 2j), 0.4, np.ones((3, 2, 2)), 2, 1, 9)
    chain = ChainState(sampler, np.random.default_rng(0), np.ones((3, 2, 2)), True, [1e9, 2e9])
    return TrajectoryState(motion, rng, 3, True, 2, 20, 412, series), chain


@pytest.mark.parametrize("before", checkpoints())
def test_a_checkpoint_is_the_same_again_unless_of_another_version(before):
    kept = before.pack()
    after = type(before).unpack(kept)
    for name, values in after.pack().items():
        np.testing.assert_array_equal(kept[name], values)
    assert after.generator.random() == before.generator.random()
    del kept["record"]
    with pytest.raises(InputError, match="of another version of this program; drop it with --overwrite"):
        type(before).unpack(kept)
