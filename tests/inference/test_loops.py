"""Inference by simulated loops: a probe of another w/E* than those of the loops, resumed loops, and refusals."""

import warnings

import numpy as np
import pytest
import xarray as xr

import contact_study
from contact_study import InputError
from contact_study.inference.simulated import SPACING, SimulatedLoops
from scripts.validate_inference import STUDY, measured_loop

pytestmark = pytest.mark.validation

POINTS = 20


def study(**changes):
    rough = {**STUDY["surface"], "shape": [POINTS, POINTS]}
    return {**STUDY, "surface": rough, "interaction": {**STUDY["interaction"], "length": 4e-9}, **changes}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("loops")


@pytest.fixture(scope="module")
def curve():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return measured_loop(study(), 0.057, 1.15e9, np.random.default_rng(1), 0.005, 45)


@pytest.fixture(scope="module")
def found(curve, folder):
    return contact_study.infer(curve, study=study(), loops=folder)


def test_constants_between_the_loops_are_found(found):
    one = found.isel(model=0)
    # A noise of 0.5 % of the pull-off; interpolation over ln(w/E*) in steps of 0.2 has errors of the same size.
    assert float(one["work_of_adhesion"]) == pytest.approx(0.057, rel=0.01)
    assert float(one["contact_modulus"]) == pytest.approx(1.15e9, rel=0.02)
    assert float(one["displacement_zero"][0]) == pytest.approx(0, abs=1e-10)
    assert float(one["range"]) == pytest.approx(4e-9)
    assert np.isfinite(one["work_of_adhesion_lower"])


def test_loops_on_disk_are_used_again(found, curve, folder, monkeypatch):
    kept = {path: path.stat().st_mtime_ns for path in folder.iterdir()}
    ran = []
    monkeypatch.setattr("contact_study.campaign.run._run_cases", lambda *_: ran.append(1))
    again = contact_study.infer(curve, study=study(), loops=folder)
    assert not ran
    assert {path: path.stat().st_mtime_ns for path in folder.iterdir()} == kept
    # More loops are there from the start, so that the first fits begin elsewhere.
    assert float(again["work_of_adhesion"][0]) == pytest.approx(float(found["work_of_adhesion"][0]), rel=2e-3)


def test_loops_are_even_in_the_logarithm_and_scale_with_the_modulus(folder, found):
    (path, *_) = sorted(path for path in folder.iterdir() if path.suffix == ".nc")
    with xr.open_dataset(path) as dataset:
        works = dataset["work_of_adhesion"].values
        depth = float(dataset["displacement"].max())
    np.testing.assert_allclose(np.diff(np.log(works)), SPACING, rtol=1e-9)
    loops = SimulatedLoops(study(), folder)
    loops.prepare(0.97 * depth)  # to a depth larger by up to 5 %, as the loops of the fixture
    loops.cover(float(np.log(works[1] / loops.modulus)), float(np.log(works[2] / loops.modulus)))
    soft, stiff = (
        loops.branches(
            {"work_of_adhesion": works[1] * factor, "contact_modulus": loops.modulus * factor}, 1e-7, -5e-8, 0.0
        )
        for factor in (0.5, 1.0)
    )
    np.testing.assert_allclose(2 * soft[1].after[1], stiff[1].after[1], rtol=1e-12)
    # A loop is reproduced at its own ratio: the least force of the states is that of the simulation.
    with xr.open_dataset(path) as dataset:
        least = float(dataset["pull_off_force"].sel(work_of_adhesion=works[1]))
    assert stiff[1].after[1].min() == pytest.approx(-abs(least), rel=0.01)


@pytest.mark.parametrize(
    ("changes", "options", "said"),
    [
        ({"sweep": {"surface.seed": [1, 2]}}, {}, "leave \\[sweep\\] out"),
        ({"form": {}}, {}, "has no radius"),
        ({"interaction": {"law": "hard_wall"}}, {}, "interaction.work_of_adhesion"),
        ({}, {"fixed": {"radius": 1e-6}}, "radius: is the study's"),
        ({}, {"models": ["jkr"]}, "belongs to the model simulation"),
    ],
)
def test_a_probe_without_use_gets_one_line(curve, folder, changes, options, said):
    with pytest.raises(InputError, match=said):
        contact_study.infer(curve, study=study(**changes), loops=folder, **options)
