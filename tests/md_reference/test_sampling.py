"""Thermal averages as a user meets them: a study in, means with errors and series out, stopped and gone on with."""

import copy
import re
import time
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

import contact_study
from contact_study.campaign.worker import case_run
from contact_study.campaign.worker.ensemble import Averages
from contact_study.errors import InputError
from contact_study.numerics.time_series import statistics_of
from contact_study.results.schema import AUTOCORRELATION_STATES, STANDARD_ERROR, TRAJECTORY, VARIABLES
from contact_study.study.study import make_study
from md_reference.study import sampling
from md_reference.study.model import check
from md_reference.thermal.checkpoint import ChainState, pack_generator, unpack_generator
from md_reference.thermal.hmc import SamplerState, ThermalSampler
from tests.md_reference.systems import CONTACT_MODULUS, LENGTH, POISSONS_RATIO, WELL_DEPTH, YOUNGS_MODULUS
from tests.recording import bins_of_case, stopper

STUDY = {
    "surface": {
        "kind": "self_affine",
        "size": "62.4 angstrom",
        "shape": [24, 24],
        "rms_height": "1 angstrom",
        "cutoff_mode": 3,
    },
    "material": {
        "youngs_modulus": YOUNGS_MODULUS,
        "poissons_ratio": POISSONS_RATIO,
        "lattice_constant": "2.6 angstrom",
    },
    "interaction": {
        "law": "lennard_jones_10_4",
        "well_depth": WELL_DEPTH,
        "length": LENGTH,
        "contact_distance": "3.68 angstrom",
    },
    "loading": {"path": ["1 GPa", "3 GPa"]},
    "atomistic": {"method": "sampling", "temperature": "300 K"},
    "sampling": {"trajectories": 60, "equilibration": 20},
    "output": {"fields": True, "pressure_range": ["-10 GPa", "30 GPa"], "gap_range": ["0 nm", "1 nm"]},
}


def changed(**sections):
    table = copy.deepcopy(STUDY)
    for section, keys in sections.items():
        table.setdefault(section, {}).update(keys)
    for way in {"sampling", "overdamped", "dynamics"} - {table["atomistic"]["method"]}:  # nothing would read it
        table.pop(way, None)
    return table


@pytest.fixture(scope="module")
def sampled(tmp_path_factory):
    path = tmp_path_factory.mktemp("sampled") / "md.nc"
    contact_study.run(STUDY, "atomistic", output=path)
    return path


def groups_of(path):
    with xr.open_datatree(path) as tree:
        return {node.path: node.to_dataset(inherit=False).load() for node in tree.subtree}


def assert_equal_groups(one, other):
    assert one.keys() == other.keys()
    for name, dataset in one.items():
        again = other[name].drop_vars("wall_time", errors="ignore")
        xr.testing.assert_equal(dataset.drop_vars("wall_time", errors="ignore"), again)


@pytest.mark.filterwarnings("ignore:the 10 states")
def test_the_time_of_a_point_is_that_of_all_its_states(monkeypatch):
    """By a clock that ticks once a state."""
    add, clock = Averages.add, [0]

    def ticking(averages, state):
        clock[0] += 1
        add(averages, state)

    monkeypatch.setattr(Averages, "add", ticking)
    monkeypatch.setattr(case_run, "time", SimpleNamespace(perf_counter=lambda: clock[0], monotonic=time.monotonic))
    dataset = contact_study.run(changed(sampling={"trajectories": 10, "equilibration": 10}), "atomistic")
    assert dataset.wall_time.values.tolist() == [10, 10]


def test_every_mean_has_its_error_and_every_number_its_series(sampled):
    groups = groups_of(sampled)
    root, series = groups["/"], groups[f"/{TRAJECTORY}"]
    means = [name.removesuffix(STANDARD_ERROR) for name in root if name.endswith(STANDARD_ERROR)]
    assert {"mean_pressure", "mean_gap", "relative_contact_area", "elastic_energy", "gap_pdf"} < set(means)
    assert series.sizes["frame"] == 60
    for name in means:
        value, error = root[name], root[name + STANDARD_ERROR]
        assert value.dims == error.dims
        assert value.units == error.units
        if name in series:
            for step in range(2):
                found = statistics_of(series[name].values[step])
                rounded = 0.5 if VARIABLES[name].kind != "float" else 0
                assert value.values[step] == pytest.approx(found.mean, abs=rounded, rel=1e-14)
                assert error.values[step] == pytest.approx(found.standard_error, rel=1e-12, abs=0)
                memory = root[name + AUTOCORRELATION_STATES]
                assert memory.units == "1"
                told = found.autocorrelation_time if found.resolved else np.nan
                assert memory.values[step] == pytest.approx(told, rel=1e-12, abs=0, nan_ok=True)
    # A field is the mean of the fields.
    np.testing.assert_allclose(root.pressure.mean(("y", "x")), root.mean_pressure, rtol=1e-12)
    np.testing.assert_allclose(root.gap.mean(("y", "x")) - LENGTH, root.mean_gap, rtol=1e-10)
    # What is left of the balance of forces is an error of sampling.
    error = np.abs(root.mean_pressure - root.applied_pressure)
    np.testing.assert_allclose(root.residual, error / CONTACT_MODULUS, rtol=1e-9)
    assert np.all(error < 5 * root["mean_pressure" + STANDARD_ERROR])
    assert np.all((root.acceptance_rate > 0.4) & (root.acceptance_rate < 1))
    assert np.all(root.converged == 1)


def test_warm_atoms_differ_from_cold_ones_and_start_from_them(sampled):
    warm = groups_of(sampled)
    cold = contact_study.run(changed(atomistic={"method": "quasi_static", "temperature": 0}), "atomistic")
    assert not [name for name in cold if name.endswith(STANDARD_ERROR)]
    # Thermal motion opens the contact by more than the errors, and less than half.
    loss = (cold.relative_contact_area - warm["/"].relative_contact_area) / cold.relative_contact_area
    assert np.all((loss > 0.01) & (loss < 0.5))
    again = contact_study.run(changed(atomistic={"temperature": 1e-3}), "atomistic")
    assert np.all(np.abs(again.relative_contact_area - cold.relative_contact_area) < 2 / 24**2)
    np.testing.assert_allclose(again.mean_separation, cold.mean_separation, rtol=0, atol=1e-4 * LENGTH)


def test_run_stopped_within_a_point_goes_on_to_the_same_bits(sampled, tmp_path, monkeypatch):
    path = tmp_path / "md.nc"
    stop_at, taken = stopper(monkeypatch, ThermalSampler, "next")
    monkeypatch.setattr(case_run, "_SECONDS_BETWEEN_CHECKPOINTS", 0.0)
    for stop in (25, 60, 10**6):  # in the first point, in the second, not at all
        stop_at(stop)
        if stop < 10**6:
            with pytest.raises(KeyboardInterrupt):
                contact_study.run(STUDY, "atomistic", output=path, resume=stop > 25)
        else:
            contact_study.run(STUDY, "atomistic", output=path, resume=True)
            assert len(taken) == 120 - 23 - 58  # the state at hand when it stops is drawn again
    assert_equal_groups(groups_of(path), groups_of(sampled))


def test_a_chain_kept_without_its_pressures_is_refused():
    state = SamplerState(np.zeros((3, 2, 2), complex), 0.4, np.ones((3, 2, 2)), 2, 2, 9)
    chain = ChainState(state, np.random.default_rng(0), np.zeros((3, 2, 2)), True, [1e9, 2e9])
    assert ChainState.unpack(chain.pack()).pressures == [1e9, 2e9]
    kept = {name: values for name, values in chain.pack().items() if name != "pressures"}
    with pytest.raises(InputError, match="of another version of this program; drop it with --overwrite"):
        ChainState.unpack(kept)


def test_run_stopped_after_the_last_state_of_a_point_counts_none_twice(sampled, tmp_path, monkeypatch):
    def killed(self):
        raise KeyboardInterrupt

    monkeypatch.setattr(case_run, "_SECONDS_BETWEEN_CHECKPOINTS", 0.0)
    step = Averages.step
    monkeypatch.setattr(Averages, "step", killed)
    with pytest.raises(KeyboardInterrupt):
        contact_study.run(STUDY, "atomistic", output=tmp_path / "md.nc")
    monkeypatch.setattr(Averages, "step", step)
    contact_study.run(STUDY, "atomistic", output=tmp_path / "md.nc", resume=True)
    assert_equal_groups(groups_of(tmp_path / "md.nc"), groups_of(sampled))


def test_seeds_give_other_states_of_one_distribution(sampled):
    other = contact_study.run(changed(atomistic={"random_seed": 2}), "atomistic")
    root = groups_of(sampled)["/"]
    for name in ("relative_contact_area", "mean_separation"):
        error = np.hypot(root[name + STANDARD_ERROR], other[name + STANDARD_ERROR])
        difference = np.abs(root[name] - other[name])
        assert np.all(difference > 0)
        assert np.all(difference < 5 * error)


def test_finished_points_stand_when_the_path_grows(sampled, tmp_path):
    path = tmp_path / "md.nc"
    contact_study.run(changed(loading={"path": ["1 GPa"]}), "atomistic", output=path)
    contact_study.run(STUDY, "atomistic", output=path, resume=True)
    assert_equal_groups(groups_of(path), groups_of(sampled))


def test_gap_control_holds_the_mean_and_has_no_load_to_err_from(sampled):
    dataset = contact_study.run(changed(loading={"control": "gap", "path": ["0.5 angstrom"]}), "atomistic")
    np.testing.assert_allclose(dataset.mean_separation, 0.5e-10, rtol=0, atol=1e-9 * LENGTH)
    assert np.all(np.isnan(dataset.residual))
    assert np.all(dataset["mean_pressure" + STANDARD_ERROR] > 0)


def test_blocks_apart_are_not_sampled():
    dataset = contact_study.run(changed(loading={"path": ["1 GPa", "-3 GPa"]}), "atomistic")
    assert dataset.detached.values.tolist() == [0, 1]
    assert np.isinf(dataset.mean_gap[1])
    assert np.isnan(dataset.relative_contact_area_standard_error[1])


def test_a_block_that_thermal_motion_tears_off_is_detached():
    """Of a tension that holds cold atoms; the next point starts from the cold state again."""
    loading = {"path": ["1 GPa", "-2.3 GPa", "-2 GPa"]}
    cold = contact_study.run(
        changed(loading=loading, atomistic={"method": "quasi_static", "temperature": 0}), "atomistic"
    )
    warm = contact_study.run(changed(loading=loading, atomistic={"temperature": 600.0}), "atomistic")
    assert cold.detached.values.tolist() == [0, 0, 0]
    assert warm.detached.values.tolist() == [0, 1, 0]
    assert warm.relative_contact_area[1] == 0
    assert warm.relative_contact_area[2] > 0.3


def test_short_series_are_warned_of():
    words = "the 4 states of a point are too few to tell an autocorrelation time, which takes 50: .*; raise sampl"
    with pytest.warns(UserWarning, match=words):
        dataset = contact_study.run(changed(sampling={"trajectories": 4}, loading={"path": ["1 GPa"]}), "atomistic")
    assert np.isnan(dataset["mean_pressure" + AUTOCORRELATION_STATES].item())


@pytest.mark.filterwarnings("ignore:.*the 5 states", "ignore:.* did not converge")
def test_few_states_that_miss_a_tenth_of_the_load_did_not_converge():
    """Their error is a guess, but four of it are as many as a resolved one's."""
    table = changed(sampling={"trajectories": 5}, loading={"path": ["1 GPa"]})
    dataset = contact_study.run({**table, "sweep": {"atomistic.random_seed": [1, 2, 3, 4, 5, 6]}}, "atomistic")
    missing = np.abs(dataset.mean_pressure.values - 1e9).ravel()
    error = dataset["mean_pressure" + STANDARD_ERROR].values.ravel()
    assert dataset.converged.values.ravel().tolist() == (missing < np.minimum(np.maximum(4 * error, 1e7), 1e8)).tolist()
    assert sorted(dataset.converged.values.ravel()) == [0, 1, 1, 1, 1, 1]


@pytest.mark.filterwarnings("ignore:.* did not converge")
@pytest.mark.parametrize("control", ["pressure", "gap"])
def test_states_that_do_not_carry_the_load_did_not_converge(control, monkeypatch):
    """A sampler under a fifth more than the load. A gap that is held has no load to miss."""
    wrong = lambda block, interface, modulus, temperature, pressure, fixed: ThermalSampler(  # noqa: E731
        block, interface, modulus, temperature, 1.2 * pressure, fixed
    )
    monkeypatch.setattr(sampling, "ThermalSampler", wrong)
    path = {"pressure": ["3 GPa"], "gap": ["0.5 angstrom"]}[control]
    dataset = contact_study.run(changed(loading={"control": control, "path": path}), "atomistic")
    said = str(dataset.message.values[0])
    if control == "gap":
        assert (dataset.converged.item(), said) == (1, "")
        return
    assert dataset.converged.item() == 0
    assert re.match("the interface carried 3\\.[4-8].* not the 3e\\+09 Pa applied: raise sampling.trajectories", said)
    assert dataset.residual.item() == pytest.approx(0.6e9 / CONTACT_MODULUS, rel=0.3)


@pytest.mark.parametrize(
    ("atomistic", "words"),
    [
        ({"temperature": "-1 K"}, "atomistic.temperature = '-1 K': must be at least 0"),
        ({"temperature": 0}, "needs an atomistic.temperature above 0 K"),
        ({"method": "quasi_static"}, 'finds equilibria at zero temperature; "sampling" and "dynamics" take a temp'),
        ({"method": "overdamped"}, 'is a motion without noise; "sampling" and "dynamics" take a temperature'),
    ],
)
def test_impossible_temperatures_are_refused(atomistic, words):
    with pytest.raises(InputError, match=words):
        check(make_study(changed(atomistic=atomistic)).cases[0])


def test_a_generator_goes_on_where_it_stood():
    generator = np.random.default_rng(7)
    generator.random(3)
    generator.integers(10, dtype=np.int32)  # leaves half a word
    other = unpack_generator(pack_generator(generator))
    assert (
        other.integers(10, size=3, dtype=np.int32).tolist() == generator.integers(10, size=3, dtype=np.int32).tolist()
    )
    np.testing.assert_array_equal(other.standard_normal(5), generator.standard_normal(5))


def test_counted_states_of_another_binning_are_not_gone_on_from():
    case = make_study(STUDY).cases[0]
    bins = bins_of_case(case)
    kept = {"bins": np.ravel(bins.spans), "fields": np.array([0, 0]), "series/mean_gap": np.arange(3.0)}
    assert Averages.taken_up(kept, bins, False) is not None
    assert Averages.taken_up(kept, bins, True) is None  # fields that were not kept
    assert Averages.taken_up({**kept, "bins": 2 * kept["bins"]}, bins, False) is None
