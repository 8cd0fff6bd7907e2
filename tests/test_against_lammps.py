"""Forces of interface and block against LAMMPS; against a stored case of it where it is not installed."""

from pathlib import Path

import numpy as np
import pytest

from contact_study.inputs.errors import InputError
from md_reference.block.multiscale import NonlinearSpringBlock
from scripts import against_lammps, states_against_lammps

STORED = Path(__file__).parent / "md_reference" / "lammps_forces.npz"
# LAMMPS' own rounding: positions of tens of ångströms to 1e-15, strains of 1e-4.
WITHIN = 1e-10


@pytest.fixture(scope="module")
def own():
    interface, displacement = against_lammps.rough_interface(16)
    nodes = against_lammps.random_nodes((4, 6, 6))
    return {
        "interface": against_lammps.interface_forces(interface, displacement),
        "block": against_lammps.block_forces(nodes),
        "turning": against_lammps.block_forces(against_lammps.FAR * nodes, NonlinearSpringBlock),
    }


def test_forces_are_those_that_lammps_gave(own):
    with np.load(STORED) as stored:
        for part, forces in own.items():
            assert against_lammps.difference(forces, stored[part]) < WITHIN, part


def assert_at_rest(state):
    here = states_against_lammps.System(*states_against_lammps.SMALL)
    residual = 1e-8
    own, _, left = states_against_lammps.relaxed(here, residual)
    assert left <= residual
    # As much force left on every node of a column shears it by half the square of its length, in layers, times that.
    modulus = states_against_lammps.CONTACT_MODULUS / states_against_lammps.SHEAR_MODULUS
    within = here.layers**2 * residual * modulus * states_against_lammps.LATTICE_CONSTANT
    assert np.max(np.abs(own - state)) < within
    assert np.max(np.abs(own[0, 0])) > 1e4 * within
    assert 0.2 < here.observed(own[:, 0])[0] < 0.9


def test_state_at_rest_is_the_one_that_lammps_found():
    with np.load(STORED.with_name("lammps_states.npz")) as stored:
        assert_at_rest(stored["displacement"])


def test_both_are_those_of_lammps(own, tmp_path):
    try:
        lammps = against_lammps.load_lammps()
    except InputError as error:
        pytest.skip(str(error))
    for part, forces in against_lammps.small_case(lammps).items():
        assert against_lammps.difference(own[part], forces) < WITHIN, part
    assert_at_rest(states_against_lammps.small_case(lammps, tmp_path / "log.lammps"))
