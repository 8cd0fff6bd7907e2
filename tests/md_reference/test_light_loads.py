"""Atoms under loads far below tolerance × E*: they carry them, at rest and where slow motion ends."""

import numpy as np
import pytest

import contact_study
from md_reference import rough_contact
from tests.bem_adhesion.paper_system import study_table
from tests.bem_adhesion.rough_surfaces import random_heights

LATTICE, WELL = 2.6e-10, 2.98e-21
SHARE = 1.01e-5  # what may be missing of a light load, contact_study.numerics.balance


@pytest.mark.parametrize("well_depth", [WELL, 0.01 * WELL])
def test_atoms_carry_a_light_load(well_depth):
    height = 4e-10 * random_heights((32, 32), 2.3, 1)[0]
    block = rough_contact(height, 32 * LATTICE, LATTICE, 77.2e9, 0.42, well_depth, 3.28e-10, max_iterations=100)
    for load in (1.0, 100.0, 2e3):
        found = block.step(block.separated(), load)
        assert found.converged, found.message
        assert found.pressure.mean() == pytest.approx(load, rel=SHARE)
        assert found.pressure.max() > load


def test_a_light_load_follows_a_heavy_one():
    height = 4e-10 * random_heights((32, 32), 2.3, 1)[0]
    block = rough_contact(height, 32 * LATTICE, LATTICE, 77.2e9, 0.42, WELL, 3.28e-10, max_iterations=100)
    state = block.separated()
    for load in (1e8, 1e3, -10.0, 1.0):
        found = block.step(state, load)
        state = found.state
        assert found.converged
        assert found.pressure.mean() == pytest.approx(load, rel=SHARE)


@pytest.mark.parametrize("load", [1.0, 2e3])
def test_slow_motion_ends_under_a_light_load(load):
    table = study_table(32, size=32 * LATTICE, surface={"rms_height": 3e-10, "cutoff_mode": 6})
    table["material"]["lattice_constant"] = LATTICE
    table["loading"], table["atomistic"] = {"path": [load]}, {"method": "overdamped"}
    found = contact_study.run(table, "atomistic").isel(step=0)
    assert found.converged == 1
    assert found.mean_pressure.item() == pytest.approx(load, rel=SHARE)
    assert np.isfinite(found.mean_gap)
