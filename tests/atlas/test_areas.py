"""Areas by means of many surfaces: a small condition, and the table of known errors."""

import numpy as np
import pandas as pd
import pytest

from contact_study.atlas.design import Condition
from scripts import validate_areas
from scripts.validate_areas import PRESSURES

CONDITION = Condition(7, 0.8, 4.0, 0.3, 0.2, "lennard_jones_10_4", "half_space")


@pytest.mark.validation
def test_areas_of_a_condition_are_paired_by_surface_branch_and_pressure(tmp_path, monkeypatch):
    monkeypatch.setattr(validate_areas, "design", lambda *_, **__: ([CONDITION], {}))
    table = tmp_path / "areas.csv"
    given = ["--numbers", "7", "--surfaces", "2", "--folder", str(tmp_path), "--table", str(table)]
    assert validate_areas.main(given) == 0
    rows = pd.read_csv(table)
    assert len(rows) == 2 * len(PRESSURES)
    ways = [rows[rows["branch"] == way] for way in ("loading", "unloading")]
    for way in ways:
        assert way["pressure"].tolist() == list(PRESSURES)
        assert (np.diff(way["area"]) > 0).all()
        # The theory's error at θ = 0.3 is some per cent; at the lightest load two surfaces carry by few asperities.
        np.testing.assert_allclose(way["edge_flow"][1:], 1, atol=0.15)
    # A long range has one branch.
    np.testing.assert_allclose(ways[0]["area"], ways[1]["area"], rtol=1e-3)
    np.testing.assert_allclose(ways[0]["edge_flow"], ways[1]["edge_flow"], rtol=1e-2)


def test_worst_errors_keep_their_sign_standard_error_and_pressure(capsys, tmp_path):
    head = {"law": "dugdale", "relative_adhesion": 0.6, "judges": True, "surfaces": 16}
    theirs = dict.fromkeys(("persson", "gap_flow"), 1.0) | dict.fromkeys(("persson_error", "gap_flow_error"), 0.0)
    rows = [
        {**head, **theirs, "condition": 1, "branch": branch, "pressure": at, "area": area} | errors
        for branch, at, area, errors in (
            ("loading", 0.02, 0.3, {"edge_flow": 0.9, "edge_flow_error": 0.04}),
            ("loading", 0.1, 0.6, {"edge_flow": 1.02, "edge_flow_error": 0.01}),
            ("loading", 0.8, 0.99, {"edge_flow": 3.0, "edge_flow_error": 0.0}),  # as good as full contact
            ("unloading", 0.02, 0.5, {"edge_flow": np.nan, "edge_flow_error": np.nan}),
            ("unloading", 0.1, 0.7, {"edge_flow": 1.03, "edge_flow_error": 0.02}),
        )
    ]
    table = tmp_path / "areas.csv"
    pd.DataFrame(rows).to_csv(table, index=False)
    assert validate_areas.main(["--from", str(table)]) == 0
    cells = "6.0 %, −10 ± 4 % at 0.02 | 3.0 %, +3 ± 2 % at 0.1 |"
    printed = capsys.readouterr().out
    assert f"| 1 | Dugdale | 0.60 | judges | 16 | {cells}" in printed
    assert f"| edge flow | judging, θ ≥ 0.5 | 1 | {cells}" in printed


@pytest.mark.parametrize("name", ["area", "edge_flow"])
def test_published_areas_are_complete(name):
    table = pd.read_csv(validate_areas.TABLE)
    assert table[name].notnull().all()
    assert table.groupby("condition").size().eq(2 * len(PRESSURES)).all()
