import numpy as np
import pytest

from md_reference.block.condensed import effective_contact_modulus
from md_reference.interface.properties import FlatInterface, measure_interface
from tests.md_reference.systems import CONTACT_MODULUS, LATTICE_CONSTANT, LENGTH, WELL_DEPTH, stiffness_of

SITE = 400 * LATTICE_CONSTANT / 647


def flat(cutoff):
    return FlatInterface((SITE, SITE), LATTICE_CONSTANT**2, WELL_DEPTH, LENGTH, cutoff)


@pytest.mark.parametrize(("cutoff", "adhesion"), [(4, 0.68646), (5, 0.68972), (6, 0.69089), (8, 0.69164)])
def test_adhesion_of_flat_layers_is_that_of_the_prototype(cutoff, adhesion):
    found = measure_interface(flat(cutoff), LENGTH)
    # An independent prototype, to the digits that it printed.
    assert found.work_of_adhesion == pytest.approx(adhesion, abs=6e-6)
    assert found.equilibrium_distance == pytest.approx(3.280e-10, abs=1e-14)
    assert found.peak_distance == pytest.approx(3.741e-10, abs=1e-13)
    assert found.peak_tensile_stress == pytest.approx(3.980e9, rel=1e-3)


def test_long_cutoffs_approach_the_smeared_layers():
    # Smearing both layers is exact but for the corrugation; the cut-off tail falls as r_c⁻⁴.
    smeared = 6 * np.pi / 5 * WELL_DEPTH * LENGTH**2 / (LATTICE_CONSTANT * SITE) ** 2
    missing = [smeared - measure_interface(flat(cutoff), LENGTH).work_of_adhesion for cutoff in (4, 8, 16)]
    rates = np.log2(np.array(missing[:-1]) / missing[1:])
    assert np.all((rates > 3.7) & (rates < 4.3))


def test_tension_is_the_slope_of_the_energy():
    layers = flat(4)
    distances = np.array([0.95, 1.1, 1.5]) * LENGTH
    for distance in distances:
        step = 1e-5 * LENGTH
        slope = (layers.energy(distance + step) - layers.energy(distance - step)) / (2 * step)
        assert layers.tension(distance) == pytest.approx(slope, rel=1e-7)


def test_effective_modulus_is_that_of_the_waves_present():
    stiffness = stiffness_of((24, 36))
    x = np.arange(36) / 36
    wave = np.cos(2 * np.pi * 5 * x)[None, :] * np.ones((24, 1))
    assert effective_contact_modulus(stiffness, wave) == pytest.approx(stiffness.contact_modulus[0, 5], rel=1e-9)
    # The transform holds a wave along y twice, one along x once; each weighs by its wavenumber and squared amplitude.
    y = np.arange(24)[:, None] / 24
    both = effective_contact_modulus(stiffness, 3 * np.cos(2 * np.pi * 8 * y) + 2 * wave)
    along_y, along_x = 9 * 8 / 24, 4 * 5 / 36
    expected = along_y * stiffness.contact_modulus[8, 0] + along_x * stiffness.contact_modulus[0, 5]
    assert both == pytest.approx(expected / (along_y + along_x), rel=1e-9)
    flat_surface = effective_contact_modulus(stiffness, np.zeros((24, 36)))
    assert flat_surface == pytest.approx(stiffness.contact_modulus[0, 1], rel=1e-12)
    assert flat_surface == pytest.approx(CONTACT_MODULUS, rel=0.05)
