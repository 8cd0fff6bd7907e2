"""Every kind of solid in a whole study: its states are in balance under the K of the integration it is tested by."""

import warnings

import numpy as np
import pytest

import contact_study
from contact_study.errors import InputError
from tests.bem_adhesion.paper_system import study_table
from tests.laws_of_all_kinds import KEYS
from tests.study.test_elasticity import isotropic, on_half_space, through_the_thickness

E, NU = 77.2e9, 0.42
Q = np.geomspace(1e8, 1e10, 41)
SOLIDS = {
    "layer": ({"thickness": "1 nm"}, lambda q: through_the_thickness(q * 1e-9, E / (2 * (1 + NU)), NU, 1.0) * 1e9),
    "layered": (
        {"thickness": "1 nm", "base_youngs_modulus": "10 GPa", "base_poissons_ratio": 0.3},
        lambda q: on_half_space(q * 1e-9, isotropic(10.0, 0.3), isotropic(E * 1e-9, NU), 1.0) * 1e18,
    ),
    "transversely_isotropic": (
        {"axial_modulus": "40 GPa", "axial_poissons_ratio": 0.2, "axial_shear_modulus": "12 GPa"},
        None,
    ),
    "tabulated": ({"wavenumber": Q.tolist(), "stiffness": (0.5 * Q * (5e10 + 5 * Q)).tolist()}, None),
}


@pytest.mark.parametrize("law", ["hard_wall", "lennard_jones_10_4"])
@pytest.mark.parametrize("kind", SOLIDS)
def test_a_whole_study(kind, law):
    keys, stiffness = SOLIDS[kind]
    table = study_table(32, size=200e-10, loading={"path": [1e9, 4e9]}, output={"fields": True})
    table["surface"]["rms_height"] = 2e-10
    table["interaction"] = {"law": law, **KEYS[law]}
    table["elasticity"] = {"kind": kind, **keys}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*(process zone|thinner than the grid).*")
        dataset = contact_study.run(table, "continuum")
    assert np.all(dataset.converged == 1)
    axis = 2 * np.pi * np.fft.fftfreq(32, 200e-10 / 32)
    q = np.hypot(axis[:, None], axis[None, : 16 + 1])
    if kind == "transversely_isotropic":
        modulus = dataset.contact_modulus.item()
        assert 20e9 < modulus < E / (1 - NU**2), "softer along its normal"
        k = 0.5 * modulus * q
    elif kind == "tabulated":
        k = 0.5 * q * (5e10 + 5 * q)
    else:
        k = np.array([[stiffness(wave) if wave else 0.0 for wave in row] for row in q])
    for step in range(2):
        gap, pressure = dataset.gap.values[step], dataset.pressure.values[step]
        elastic = np.fft.irfft2(k * np.fft.rfft2(dataset.height.values + gap), gap.shape)
        # Interpolation of a table in ln q is good to 1e-4; else the solver's tolerance.
        scale = 1e-3 if kind == "tabulated" else 1e-6
        np.testing.assert_allclose(elastic + pressure.mean(), pressure, atol=scale * 93.7e9)


@pytest.mark.parametrize("kind", ["layered", "tabulated", "transversely_isotropic"])
def test_atoms_refuse_what_they_are_not(kind):
    table = study_table(32, loading={"path": [1e9]})
    table["material"]["lattice_constant"] = 2.6e-10
    table["elasticity"] = {"kind": kind, **SOLIDS[kind][0]}
    with pytest.raises(InputError, match=f'elasticity.kind = "{kind}"'):
        contact_study.run(table, "atomistic")
