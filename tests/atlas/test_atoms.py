"""Conditions of the atlas as atoms: the mapping keeps what matters to a contact; a small run; the published data."""

import numpy as np
import pytest
import xarray as xr

from contact_study.atlas import atoms
from contact_study.atlas.atoms import FINE_CONDITIONS, MODELS, PRESSURES, TWENTIETH, Block, blocks
from contact_study.atlas.design import MODULUS, STRESS, Condition
from contact_study.atlas.validation import problems
from contact_study.inputs.errors import InputError
from contact_study.physics.spheres.numbers import maugis_parameter, tabor_parameter
from contact_study.study.study import make_study, read_study
from scripts import atlas_atoms
from scripts.atlas_tables import read
from scripts.harness import PAPER

CONDITION = Condition(7, 0.8, 4.0, 0.3, 0.2, "lennard_jones_10_4", "half_space")


@pytest.mark.parametrize("slope", [0.1, 0.3])
def test_a_block_keeps_adhesion_range_and_pressure(slope):
    block = Block(CONDITION, slope)
    case = make_study(block.study()).cases[0]
    spectrum, law, modulus = case.geometry.target_spectrum, case.law, case.material.contact_modulus
    radius = 2 / spectrum.rms_laplacian
    # The whole number of atoms changes the cell, heights stay: neither number may depend on it.
    full = float(spectrum.full_contact_energy(case.solid.stiffness))
    assert law.work_of_adhesion / full == pytest.approx(CONDITION.relative_adhesion)
    assert tabor_parameter(radius, modulus, law.work_of_adhesion, law.length) == pytest.approx(CONDITION.tabor_number)
    own = CONDITION.traction_law
    before = maugis_parameter(
        2 / CONDITION.spectrum.rms_laplacian, MODULUS, own.work_of_adhesion, own.peak_tensile_stress
    )
    assert maugis_parameter(radius, modulus, law.work_of_adhesion, law.peak_tensile_stress) == pytest.approx(before)
    assert spectrum.rms_height / law.length == pytest.approx(CONDITION.spectrum.rms_height / CONDITION.length)
    assert case.loading.path[-1] / modulus / spectrum.rms_slope == pytest.approx(PRESSURES[-1] / 2)
    assert block.stress / STRESS == pytest.approx(modulus / MODULUS * spectrum.rms_slope / CONDITION.spectrum.rms_slope)
    # Half an atom of some hundreds.
    assert spectrum.rms_slope == pytest.approx(slope, rel=0.5 / block.atoms)


def test_lattice_and_modulus_are_those_of_the_paper():
    case = read_study(PAPER).cases[0]
    assert case.material.lattice_constant == pytest.approx(atoms.LATTICE_CONSTANT)
    assert case.law.length == pytest.approx(atoms.DISTANCE)
    assert case.material.contact_modulus == pytest.approx(atoms.CONTACT_MODULUS)


@pytest.mark.validation
def test_blocks_are_the_smallest_that_are_fine_enough():
    chosen = blocks()
    assert len(chosen) == TWENTIETH
    sizes = [block.atoms for block in chosen]
    assert sizes == sorted(sizes)
    assert all(block.atoms >= block.condition.points for block in chosen)
    assert {block.condition.number for block in chosen} >= set(FINE_CONDITIONS)


@pytest.mark.validation
@pytest.mark.filterwarnings("ignore:the 10 states of a point are too few")
def test_a_block_is_run_at_both_temperatures_and_joined(tmp_path, monkeypatch, capsys):
    block = Block(CONDITION, 0.5)
    monkeypatch.setattr(atoms, "TRAJECTORIES", 10)
    monkeypatch.setattr(atoms, "EQUILIBRATION", 10)
    monkeypatch.setattr(atlas_atoms, "SLOPES", (0.5,))
    for module in (atoms, atlas_atoms):
        monkeypatch.setattr(module, "tasks", lambda: [(block, model) for model in MODELS])
    with pytest.raises(InputError, match="no finished block"):
        atoms.collect_blocks(tmp_path)
    output = tmp_path / "atoms.nc"
    assert atlas_atoms.main(["run", str(output), "--folder", str(tmp_path)]) == 0
    found = xr.load_dataset(output)
    assert problems(found) == []
    one = found.isel(block=0)
    area, gap = one.relative_contact_area, one.mean_gap / one.rms_height
    assert (area.sel(model="atoms") / area.sel(model="continuum")).values == pytest.approx(1, abs=0.3)  # steep
    np.testing.assert_allclose(gap.sel(model="atoms", step=[0, 3]), gap.sel(model="continuum", step=[0, 3]), atol=0.1)
    assert np.isnan(area.sel(model="warm_atoms")).values.tolist() == [False, True, True, False, True, True, False]
    assert float(area.sel(model="warm_atoms")[0]) < float(area.sel(model="atoms")[0])
    capsys.readouterr()
    assert atlas_atoms.main(["table", str(output)]) == 0
    rows = [line for line in capsys.readouterr().out.splitlines() if line.startswith(("| 0 K", "| 300 K", "| 7 "))]
    assert len(rows) == 4 + 2  # pressures of both; a block of one branch has no row of its own


def test_the_published_blocks_are_all_runs_and_have_no_problems():
    published = read(atlas_atoms.ATOMS)
    assert problems(published) == []
    found = {
        (int(one["condition"]), int(one["atoms"]), model)
        for one in (published.isel(block=place) for place in range(published.sizes["block"]))
        for model in one["model"].values[one["relative_contact_area"].isel(step=0).notnull()]
    }
    assert found == {(block.condition.number, block.atoms, model) for block, model in atoms.tasks()}
