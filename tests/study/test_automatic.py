"""``interaction.length = "auto"``: the longest range that leaves contacts JKR-like, and what cannot have one."""

import numpy as np
import pytest

from contact_study.inputs.errors import InputError
from contact_study.inputs.units import length
from contact_study.physics.process_zone import sphere_pull_off
from contact_study.study.study import make_study
from theory import references as reference

MATERIAL = {"youngs_modulus": "2 MPa", "poissons_ratio": 0.5}
MODULUS = 2e6 / 0.75
WORK = 0.05
SPHERE = {"kind": "sphere", "size": "400 um", "shape": [64, 64], "radius": "100 um"}
WAVE = {"kind": "wavy", "size": "20 um", "shape": [64, 64], "amplitude": "1 um", "modes": [1, 2]}


def case(surface=SPHERE, sweep=(), elasticity=(), override=(), material=MATERIAL, **keys):
    interaction = {"law": "exponential", "work_of_adhesion": WORK, "length": "auto", **keys}
    interaction = {name: value for name, value in interaction.items() if value is not None}
    table = {"surface": surface, "material": material, "interaction": interaction, "loading": {"path": ["1 kPa"]}}
    study = make_study(table | {"sweep": dict(sweep), "elasticity": dict(elasticity), "override": list(override)})
    return study, study.cases


ALONG = {"kind": "transversely_isotropic", "axial_modulus": "16 MPa", "axial_poissons_ratio": 0.5}
WAVES = 0.5 * ((2 * np.pi / 20e-6) ** 2 + (4 * np.pi / 20e-6) ** 2) * 1e-6 / 2  # <cos² cos²> is a quarter


def test_the_tabor_parameter_is_three_or_the_range_a_tenth_of_the_rms_height():
    for surface, elasticity, radius in (
        *((SPHERE, {}, 1e-4), (WAVE, {}, 1 / WAVES)),
        (SPHERE, ALONG | {"axial_shear_modulus": "5 MPa"}, 1e-4),
    ):
        study, (one,) = case(surface, elasticity=elasticity)
        assert (one.solid.contact_modulus > 2 * MODULUS) == bool(elasticity)
        tabor = reference.tabor_parameter(radius, one.solid.contact_modulus, WORK, one.law.length)
        assert 3 <= tabor < 3.3  # two digits, rounded down
        assert float(f"{one.law.length:.2g}") == pytest.approx(one.law.length, abs=0, rel=1e-12)
        assert one.interaction.length == one.law.length
        assert study.choices == (
            f'range of adhesion (interaction.length = "auto"): {length(one.law.length)}, the longest of a Tabor '
            f"parameter above 3; Tabor parameter {tabor:.2g}: JKR-like",
        )
    study, (one,) = case(WAVE | {"amplitude": "0.1 um"})
    assert one.law.length == pytest.approx(5e-9, abs=0, rel=1e-9)
    assert "a tenth of the rms height; Tabor parameter" in study.choices[0]


def test_each_point_of_a_sweep_has_its_own():
    radii = ["100 um", "800 um"]
    study, cases = case(sweep={"interaction.well_depth_ratio": [1, 8], "surface.radius": radii})
    # ℓ ∝ (R Δγ²)^(1/3), to two digits.
    lengths = np.array([one.law.length for one in cases])
    np.testing.assert_allclose(lengths / lengths[0], [1, 2, 4, 8], rtol=0.1)
    assert len(study.choices) == 4
    exception = {"when": {"surface.radius": "800 um"}, "interaction.length": "auto"}
    study, (given, chosen) = case(sweep={"surface.radius": radii}, override=[exception], length="1 nm")
    assert given.law.length == 1e-9 < 1e-7 < chosen.law.length
    assert len(study.choices) == 1


def test_what_cannot_be_chosen():
    for surface, keys, culprit in (
        ({"kind": "flat", "size": 1e-6, "shape": [8, 8]}, {}, "a flat surface has no curvature"),
        (SPHERE, {"law": "hard_wall"}, "does not attract"),
        (SPHERE, {"work_of_adhesion": "1 N"}, "interaction.work_of_adhesion"),
        ({"kind": "file", "path": "nowhere.npy", "size": 1e-6}, {}, "nowhere.npy does not exist"),
        (
            SPHERE,
            {"law": "lennard_jones_10_4", "work_of_adhesion": None, "well_depth": 1e-21},
            "needs interaction.work_",
        ),
        (SPHERE, {"sweep": {"interaction.length": ["auto", 1e-9]}, "length": None}, "no number to sweep over"),
        (WAVE, {"material": MATERIAL | {"youngs_modulus": "70 GPa"}}, "not soft.*below atomic distances.*give the le"),
    ):
        with pytest.raises(InputError, match=culprit) as failure:
            case(surface, **keys)
        assert "\n" not in str(failure.value)


def test_the_pull_off_of_a_sphere_is_that_of_maugis():
    """Of R = w = E* = 1, from a tension that stretches nothing to one without range."""
    for parameter in np.geomspace(0.01, 50, 40):
        tension = parameter / (2 * np.cbrt(9 / (16 * np.pi)))
        assert reference.maugis_parameter(1, 1, 1, tension) == pytest.approx(parameter, abs=0, rel=1e-12)
        exact = reference.maugis_dugdale_pull_off(parameter)
        assert sphere_pull_off(1, 1, 1, tension) == pytest.approx(exact, abs=0, rel=0.02)
