"""A layer of atoms: as many cells as its thickness, and the continuum layer's stiffness at long waves."""

import numpy as np
import pytest

from contact_study.errors import InputError
from contact_study.study.case import realise
from md_reference.study import model as run
from md_reference.study.system import build_stiffness
from tests.md_reference.systems import case_of
from tests.recording import recorded_path

ANGSTROM = 1e-10


def layered(cells, **sections):
    return case_of(elasticity={"kind": "layer", "thickness": 2.6 * ANGSTROM * cells}, **sections)


@pytest.mark.parametrize("cells", [6, 12, 40])
def test_layers_of_atoms_have_the_stiffness_of_the_closed_form(cells):
    """From the equations of elasticity there, cell by cell here: they differ by the lattice, (qa)² and (a/d)²."""
    case = layered(cells, atoms=(96, 96))
    stiffness = build_stiffness(case)
    wavenumber = stiffness.grid.wavenumber[0, 1:4]
    relative = stiffness.normal_stiffness[0, 1:4] / case.solid.stiffness(wavenumber) - 1
    assert np.all(np.abs(relative) < 0.04 * (wavenumber * stiffness.lattice_constant) ** 2 + 0.04 / cells**2)
    assert 1 / stiffness.normal_stiffness[0, 0] == pytest.approx(case.solid.mean_compliance, rel=1e-9)


def test_thickness_must_be_cells():
    with pytest.raises(InputError, match=r"elasticity.thickness = 1e-09 m: the layer is 3.84615 cells"):
        run.check(case_of(elasticity={"kind": "layer", "thickness": 10 * ANGSTROM}))
    with pytest.raises(InputError, match=r"and atomistic.layers = 7: the layer is 6 cells"):
        run.check(layered(6, atomistic={"layers": 7}))
    run.check(layered(6, atomistic={"layers": 6}))


def test_the_load_works_on_the_base():
    """Trapezoidal rule over two near pressures, as on a block as thick as wide."""
    case = layered(4, atoms=(32, 32), path=(2e9, 2.02e9))
    one, two = (step.values for step in recorded_path(case, run.solve_path(case, realise(case))))
    energy = [values["elastic_energy"] + values["interaction_energy"] for values in (one, two)]
    moved = two["mean_separation"] - one["mean_separation"]
    assert (energy[1] - energy[0]) / moved == pytest.approx(-2.01e9, rel=1e-3)
    compression = case.solid.compression(0.02e9)
    assert compression > 0.05 * abs(moved)
