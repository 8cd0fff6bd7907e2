"""``interaction.length = "auto"``: the longest range that leaves contacts JKR-like, and what cannot have one."""

import numpy as np
import pytest
from scipy.optimize import brentq

import contact_study
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import length
from contact_study.physics.tabor import longest_range, sphere_pull_off, tabor_parameter
from contact_study.study.study import make_study
from theory import references as reference

MATERIAL = {"youngs_modulus": "2 MPa", "poissons_ratio": 0.5}
MODULUS = 2e6 / 0.75
WORK = 0.05
SPHERE = {"kind": "sphere", "size": "400 um", "shape": [64, 64], "radius": "100 um"}
WAVE = {"kind": "wavy", "size": "20 um", "shape": [64, 64], "amplitude": "1 um", "modes": [1, 2]}


def case(surface=SPHERE, sweep=None, elasticity=None, **interaction):
    table = {
        "surface": surface,
        "material": MATERIAL,
        "interaction": {"law": "exponential", "work_of_adhesion": WORK, "length": "auto", **interaction},
        "loading": {"path": ["1 kPa"]},
    }
    optional = {"sweep": sweep, "elasticity": elasticity}
    study = make_study(table | {name: given for name, given in optional.items() if given is not None})
    return study, study.cases


def test_a_sphere_has_a_tabor_parameter_of_three():
    study, (one,) = case()
    tabor = reference.tabor_parameter(100e-6, MODULUS, WORK, one.law.length)
    assert 3 <= tabor < 3.3  # two digits, rounded down
    assert one.interaction.length == one.law.length
    assert study.choices == (
        f'range of adhesion (interaction.length = "auto"): {length(one.law.length)}, the longest of a Tabor parameter '
        f"above 3; Tabor parameter {tabor:.2g}: JKR-like",
    )


def test_a_wave_has_the_radius_of_its_rms_curvature():
    _, (one,) = case(WAVE)
    qy, qx = 2 * np.pi / 20e-6, 4 * np.pi / 20e-6
    curvature = 0.5 * (qy**2 + qx**2) * 1e-6 / 2  # <cos² cos²> is a quarter
    assert 3 <= reference.tabor_parameter(1 / curvature, MODULUS, WORK, one.law.length) < 3.3


def test_the_range_is_a_tenth_of_the_rms_height_at_most():
    study, (one,) = case(WAVE | {"amplitude": "0.1 um"})
    assert one.law.length == pytest.approx(5e-9, abs=0, rel=1e-9)
    assert "a tenth of the rms height; Tabor parameter" in study.choices[0]


def test_each_point_of_a_sweep_has_its_own():
    study, cases = case(sweep={"interaction.well_depth_ratio": [1, 8], "surface.radius": ["100 um", "800 um"]})
    # ℓ ∝ (R Δγ²)^(1/3), to two digits.
    lengths = np.array([one.law.length for one in cases])
    np.testing.assert_allclose(lengths / lengths[0], [1, 2, 4, 8], rtol=0.1)
    assert len(study.choices) == 4


def test_a_solid_stiffer_along_its_normal_has_a_shorter_one():
    along = {"kind": "transversely_isotropic", "axial_modulus": "16 MPa", "axial_poissons_ratio": 0.5}
    study, (one,) = case(elasticity=along | {"axial_shear_modulus": "5 MPa"})
    assert one.solid.contact_modulus > 2 * MODULUS
    tabor = reference.tabor_parameter(100e-6, one.solid.contact_modulus, WORK, one.law.length)
    assert 3 <= tabor < 3.3  # two digits, rounded down
    assert study.choices[0].endswith(f"Tabor parameter {tabor:.2g}: JKR-like")


def test_an_override_may_ask_for_it():
    table = {
        "surface": SPHERE,
        "material": MATERIAL,
        "interaction": {"law": "exponential", "work_of_adhesion": WORK, "length": "1 nm"},
        "loading": {"path": ["1 kPa"]},
        "sweep": {"surface.radius": ["100 um", "800 um"]},
        "override": [{"when": {"surface.radius": "800 um"}, "interaction.length": "auto"}],
    }
    study = make_study(table)
    assert study.cases[0].law.length == 1e-9
    assert study.cases[1].law.length > 1e-7
    assert len(study.choices) == 1


@pytest.mark.parametrize(
    ("surface", "keys", "culprit"),
    [
        ({"kind": "flat", "size": 1e-6, "shape": [8, 8]}, {}, "a flat surface has no curvature"),
        (SPHERE, {"law": "hard_wall"}, "does not attract"),
        (SPHERE, {"law": "nothing"}, "interaction.law"),
        (SPHERE, {"length": "automatic"}, "interaction.length"),
        (SPHERE, {"work_of_adhesion": "1 N"}, "interaction.work_of_adhesion"),
        ({"kind": "file", "path": "nowhere.npy", "size": 1e-6}, {}, "nowhere.npy does not exist"),
    ],
)
def test_what_cannot_be_chosen(surface, keys, culprit):
    with pytest.raises(InputError, match=culprit) as failure:
        case(surface, **keys)
    assert "\n" not in str(failure.value)


def test_pairs_of_atoms_and_sweeps_have_no_automatic_length():
    table = {"surface": SPHERE, "material": MATERIAL, "loading": {"path": [1e3]}}
    with pytest.raises(InputError, match=r"needs interaction\.work_of_adhesion"):
        make_study(table | {"interaction": {"well_depth": "10 meV", "length": "auto"}})
    interaction = {"law": "exponential", "work_of_adhesion": WORK}
    with pytest.raises(InputError, match="no number to sweep over"):
        make_study(table | {"interaction": interaction, "sweep": {"interaction.length": ["auto", 1e-9]}})


def test_stiff_bodies_have_the_range_of_their_interaction():
    table = {"surface": WAVE, "material": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.3}}
    table |= {"interaction": {"work_of_adhesion": WORK, "length": "auto"}, "loading": {"path": [1e6]}}
    with pytest.raises(InputError, match=r"not soft.*below atomic distances.*give the length of the interaction"):
        make_study(table)


def test_the_pull_off_of_a_sphere_is_that_of_maugis():
    """Of R = w = E* = 1, from a tension that stretches nothing to one without range."""
    for parameter in np.geomspace(0.01, 50, 40):
        tension = parameter / (2 * np.cbrt(9 / (16 * np.pi)))
        assert reference.maugis_parameter(1, 1, 1, tension) == pytest.approx(parameter, abs=0, rel=1e-12)
        exact = reference.maugis_dugdale_pull_off(parameter)
        assert sphere_pull_off(1, 1, 1, tension) == pytest.approx(exact, abs=0, rel=0.02)


def test_rounding_is_downwards():
    for scale in np.geomspace(1, 10, 23):
        found = longest_range(scale * 1e6, 1e-3, 1e7, 0.1)
        assert 3 <= tabor_parameter(1 / (scale * 1e6), 1e7, 0.1, found) < 3.31
        assert float(f"{found:.2g}") == pytest.approx(found, abs=0, rel=1e-12)


def test_a_shorter_range_changes_little_and_leads_to_johnsons_wave():
    """A wave of rubber, closed form by Johnson (1995) for a range of zero."""
    wavelength, amplitude, points = 20e-6, 1e-6, 2048
    closing = reference.wave_full_contact_pressure(amplitude, wavelength, MODULUS)
    relative = (0.02, 0.1, 0.2)
    table = {
        "surface": {
            "kind": "wavy",
            "size": [4 * wavelength / points, wavelength],
            "shape": [4, points],
            "amplitude": amplitude,
            "modes": [0, 1],
        },
        "material": MATERIAL,
        "interaction": {"law": "exponential", "work_of_adhesion": WORK, "length": "auto"},
        "loading": {"path": [pressure * closing for pressure in relative]},
    }
    whole = contact_study.run(table)
    chosen = float(whole.interaction_length)
    half = contact_study.run(table | {"interaction": table["interaction"] | {"length": chosen / 2}})
    assert whole.converged.all()
    assert half.converged.all()
    adhesion = reference.wave_adhesion(amplitude, wavelength, MODULUS, WORK)
    limit = np.array(
        [brentq(lambda a, p=p: reference.wave_relative_pressure(a, adhesion) - p, 0.2, 0.9) for p in relative]
    )
    areas = np.array([whole.relative_contact_area.values, half.relative_contact_area.values])
    # The page on soft matter says 5 %; what is left is the process zone, 1.3 % of the wavelength on either side, and a
    # quarter of that.
    assert np.all(np.abs(areas[1] / areas[0] - 1) < 0.05)
    errors = limit - areas
    assert np.all(np.abs(errors[0]) < 2 * 0.013)
    assert np.all(np.abs(errors[1]) < np.abs(errors[0]))
