"""Thermal averages as a user meets them: a study in, means with errors and series out, stopped and gone on with."""

import re
import time

import numpy as np
import pytest

import contact_study
from contact_study.campaign import worker
from contact_study.campaign.worker import Averages
from contact_study.numerics.time_series import statistics_of
from contact_study.results.schema import AUTOCORRELATION_STATES, STANDARD_ERROR, TRAJECTORY, VARIABLES
from contact_study.study.study import make_study
from md_reference.study import sampling
from md_reference.study.cold import OverdampedAtoms
from md_reference.thermal.hmc import ThermalSampler
from md_reference.thermal.langevin import MolecularDynamics
from tests.md_reference.systems import E_STAR, FLOW, R0, SAMPLED, SMALL, assert_equal_groups, changed, groups_of, moving
from tests.recording import bins_of_case, stopper


@pytest.fixture(scope="module")
def sampled(tmp_path_factory):
    path = tmp_path_factory.mktemp("sampled") / "md.nc"
    contact_study.run(SAMPLED, "atomistic", output=path)
    return path


def test_every_mean_has_its_error_and_every_number_its_series(sampled):
    groups = groups_of(sampled)
    root, series = groups["/"], groups[f"/{TRAJECTORY}"]
    means = [name.removesuffix(STANDARD_ERROR) for name in root if name.endswith(STANDARD_ERROR)]
    assert {"mean_pressure", "mean_gap", "relative_contact_area", "elastic_energy", "gap_pdf"} < set(means)
    assert series.sizes["frame"] == 60
    for name in means:
        value, error = root[name], root[name + STANDARD_ERROR]
        assert (value.dims, value.units) == (error.dims, error.units)
        if name in series and VARIABLES[name].kind == "float":
            found = [statistics_of(values) for values in series[name].values]
            np.testing.assert_allclose(value, [each.mean for each in found], rtol=1e-14)
            np.testing.assert_allclose(error, [each.standard_error for each in found], rtol=1e-12)
            told = [each.autocorrelation_time if each.resolved else np.nan for each in found]
            np.testing.assert_allclose(root[name + AUTOCORRELATION_STATES], told, rtol=1e-12)
    np.testing.assert_allclose(root.pressure.mean(("y", "x")), root.mean_pressure, rtol=1e-12)
    np.testing.assert_allclose(root.gap.mean(("y", "x")) - R0, root.mean_gap, rtol=1e-10)
    # What is left of the balance of forces is an error of sampling.
    error = np.abs(root.mean_pressure - root.applied_pressure)
    np.testing.assert_allclose(root.residual, error / E_STAR, rtol=1e-9)
    assert np.all(error < 5 * root["mean_pressure" + STANDARD_ERROR])
    assert np.all((root.acceptance_rate > 0.4) & (root.acceptance_rate < 1))
    assert np.all(root.converged == 1)


COLD = {"method": "quasi_static", "temperature": 0}
WARM = {
    "atomistic": {"temperature": 300.0},
    "dynamics": {"duration": "1 ps", "frames": 20},
    "loading": {"path": ["1 GPa", "2 GPa"]},
    "surface": SMALL,
}


@pytest.mark.validation
@pytest.mark.filterwarnings("ignore:.* did not converge", "ignore:the .* states")
@pytest.mark.parametrize(
    ("study", "owner", "method", "stops"),
    [
        (changed(sampling={"trajectories": 20, "equilibration": 10}), ThermalSampler, "next", (15, 15)),
        (changed(**FLOW), OverdampedAtoms, "advance", (10, 15)),
        (moving(**WARM), MolecularDynamics, "move", (10, 20)),
    ],
)
def test_run_stopped_anywhere_goes_on_to_the_same_bits(study, owner, method, stops, tmp_path, monkeypatch):
    stop_at, taken = stopper(monkeypatch, owner, method)
    monkeypatch.setattr(worker, "_SECONDS_BETWEEN_CHECKPOINTS", 0.0)
    stop_at(10**9)
    contact_study.run(study, "atomistic", output=tmp_path / "whole.nc")
    whole = len(taken)
    for number, stop in enumerate(stops):
        stop_at(stop)
        with pytest.raises(KeyboardInterrupt):
            contact_study.run(study, "atomistic", output=tmp_path / "md.nc", resume=number > 0)
    stop_at(10**9)
    contact_study.run(study, "atomistic", output=tmp_path / "md.nc", resume=True)
    assert len(taken) < whole - sum(stops) + 8  # the state at hand when it stops is drawn again
    assert_equal_groups(groups_of(tmp_path / "md.nc"), groups_of(tmp_path / "whole.nc"))


@pytest.mark.validation
@pytest.mark.filterwarnings("ignore:.* did not converge", "ignore:the .* states")
def test_the_time_of_a_point_is_that_of_all_its_states(monkeypatch):
    add = Averages.add
    monkeypatch.setattr(Averages, "add", lambda averages, state: time.sleep(0.05) or add(averages, state))
    table = changed(sampling={"trajectories": 10, "equilibration": 10}, surface=SMALL)
    assert contact_study.run(table, "atomistic").wall_time.min() > 0.5


def test_gap_control_holds_the_mean_and_has_no_load_to_err_from():
    dataset = contact_study.run(changed(loading={"control": "gap", "path": ["0.5 angstrom"]}), "atomistic")
    np.testing.assert_allclose(dataset.mean_separation, 0.5e-10, rtol=0, atol=1e-9 * R0)
    assert np.all(np.isnan(dataset.residual))
    assert (dataset.converged.item(), str(dataset.message.values[0])) == (1, "")
    assert np.all(dataset["mean_pressure" + STANDARD_ERROR] > 0)


@pytest.mark.validation
def test_a_block_that_thermal_motion_tears_off_is_detached():
    path, hot = {"path": ["1 GPa", "-2.3 GPa", "-2 GPa", "-3 GPa"]}, {"temperature": 600.0}
    warm = contact_study.run(changed(loading=path, atomistic=hot, sampling={"trajectories": 52}), "atomistic")
    cold = contact_study.run(changed(loading=path, atomistic=COLD), "atomistic")
    assert cold.detached.values.tolist() == [0, 0, 0, 1]
    assert warm.detached.values.tolist() == [0, 1, 0, 1]
    assert warm.relative_contact_area[1] == 0
    assert warm.relative_contact_area[2] > 0.3
    assert np.isinf(warm.mean_gap[3])
    assert np.isnan(warm.relative_contact_area_standard_error[3])


@pytest.mark.filterwarnings("ignore:.* did not converge")
def test_states_that_do_not_carry_the_load_did_not_converge(monkeypatch):
    wrong = lambda *given: ThermalSampler(*given[:4], 1.2 * given[4], *given[5:])  # noqa: E731
    monkeypatch.setattr(sampling, "ThermalSampler", wrong)
    dataset = contact_study.run(changed(loading={"path": ["3 GPa"]}), "atomistic")
    said = str(dataset.message.values[0])
    assert dataset.converged.item() == 0
    assert re.match("the interface carried 3\\.[4-8].* not the 3e\\+09 Pa applied: raise sampling.trajectories", said)
    assert dataset.residual.item() == pytest.approx(0.6e9 / E_STAR, rel=0.3)


def test_counted_states_of_another_binning_are_not_gone_on_from():
    case = make_study(SAMPLED).cases[0]
    bins = bins_of_case(case)
    kept = {"bins": np.ravel(bins.spans), "fields": np.array([0, 0]), "series/mean_gap": np.arange(3.0)}
    assert Averages.restored(kept, bins, False) is not None
    assert Averages.restored(kept, bins, True) is None  # fields that were not kept
    assert Averages.restored({**kept, "bins": 2 * kept["bins"]}, bins, False) is None
