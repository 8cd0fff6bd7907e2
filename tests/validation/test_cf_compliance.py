"""The datasets of all commands against the CF conventions, by the IOOS compliance checker."""

import json
import tomllib

import pytest

import contact_study
from contact_study.results.schema import CONVENTIONS
from contact_study.start import contact_compare as compare
from contact_study.start import contact_merge as merge
from tests.report.synthetic import STUDY, write

runner = pytest.importorskip("compliance_checker.runner")
pytestmark = [pytest.mark.validation, pytest.mark.filterwarnings("ignore")]  # the checker's own

SEEDED = STUDY.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2]\n')


def faults(path, tmp_path):
    """What the checker finds in a dataset, in its words."""
    report = tmp_path / f"{path.stem}.json"
    standard = CONVENTIONS.lower().replace("cf-", "cf:")
    runner.CheckSuite.load_all_available_checkers()
    runner.ComplianceChecker.run_checker(
        str(path), [standard], verbose=0, criteria="strict", output_filename=str(report), output_format="json"
    )
    (found,) = json.loads(report.read_text()).values()
    ranks = ("high_priorities", "medium_priorities", "low_priorities")
    return [message for rank in ranks for check in found[rank] for message in check["msgs"]]


@pytest.fixture(scope="module")
def datasets(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cf")
    files = [write(folder / f"{kind}.nc", kind, SEEDED) for kind in ("continuum", "atomistic", "theory")]
    assert compare([*map(str, files), "-o", str(folder / "comparison.nc")]) == 0
    parts = [write(folder / f"part{seed}.nc", "continuum", SEEDED.replace("[1, 2]", f"[{seed}]")) for seed in (1, 2)]
    assert merge([*map(str, parts), "-o", str(folder / "merged.nc")]) == 0
    contact_study.run(tomllib.loads(STUDY), output=folder / "computed.nc")
    return {path.stem: path for path in folder.glob("*.nc")}


@pytest.mark.parametrize("name", ["continuum", "atomistic", "theory", "comparison", "merged", "computed"])
def test_datasets_comply(datasets, tmp_path, name):
    assert faults(datasets[name], tmp_path) == []
