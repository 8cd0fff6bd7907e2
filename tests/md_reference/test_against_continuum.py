"""The scripts that set atoms against the continuum run on a small study and agree with themselves."""

import numpy as np
import tomli_w
import xarray as xr

from research import continuum_against_atoms, two_starts
from tests.md_reference.systems import SAMPLED

STUDY = {
    **{name: SAMPLED[name] for name in ("material", "interaction")},
    "surface": {**SAMPLED["surface"], "rms_height": "2 angstrom", "cutoff_mode": 4},
    "loading": {"path": ["0.5 GPa"]},
}


def found_by(script, folder):
    (folder / "study.toml").write_text(tomli_w.dumps(STUDY))
    pressures = ["--ratios", "1", "4", "--pressures", "0.5 GPa", "2 GPa"]
    assert script.main([str(folder / "study.toml"), *pressures, "-o", str(folder / "table.nc")]) == 0
    return xr.load_dataset(folder / "table.nc")


def test_increments_lead_from_continuum_to_atoms(tmp_path):
    found = found_by(continuum_against_atoms, tmp_path)
    assert found.sizes == {"well_depth_ratio": 2, "pressure": 2, "model": 8}
    assert found["converged"].all()
    area, gap = found["relative_contact_area"], found["mean_gap"]
    steps = found["relative_contact_area_increment"].sum("model")
    np.testing.assert_allclose(area.sel(model="continuum") + steps, area.sel(model="atoms"), rtol=1e-12)
    # One set of equations, two minimisers: the same state to what a residual of 1e-8 E* leaves of the gap. The
    # continuum's solver has the lattice's own stiffness by then.
    assert float(abs(found["mean_gap_increment"].sel(model="other_minimiser")).max()) < 1e-16
    assert not found["relative_contact_area_increment"].sel(model="other_minimiser").any()
    assert (gap.sel(model="tilted_law") > gap.sel(model="lattice_stiffness")).all()
    assert (gap.sel(model="atoms") < gap.sel(model="pair_sums")).all()
    assert (found["measured_work_of_adhesion"] < found["work_of_adhesion"]).all()


def test_both_starts_of_a_small_contact_end_in_one_state(tmp_path, capsys):
    found = found_by(two_starts, tmp_path)
    assert found["converged"].all()
    # A residual of 1e-8 E* a² over the softest mode, as in test_equilibrium.
    assert float(found["largest_gap_difference"].max()) < 3e-16
    assert not found["changed_atoms"].any()
    np.testing.assert_allclose(found["area_predicted"], found["area_own"], rtol=1e-12)
    # Over the path: a single late step may take as many from either start.
    assert found["evaluations_predicted"].sum() < found["evaluations_own"].sum()
    assert "same state at all 4 points" in capsys.readouterr().out
