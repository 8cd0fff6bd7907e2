"""The analytic references against limits and published numbers of their own."""

import numpy as np
import pytest

from theory import references as reference


def test_maugis_pull_off_and_parameter():
    found = [reference.maugis_dugdale_pull_off(parameter) for parameter in (0.01, 0.5, 5)]
    assert found == pytest.approx([1.9983, 1.7182, 1.5063], abs=5e-5)  # published with four digits
    arguments = {"radius": 1e-6, "contact_modulus": 1e9, "work_of_adhesion": 0.05}
    length = 3e-10
    tabor = reference.tabor_parameter(**arguments, length=length)
    for peak, ratio in ((16 / (9 * np.sqrt(3)), 1.1570), (1.8850, 2.125)):
        found = reference.maugis_parameter(**arguments, peak_tensile_stress=peak * 0.05 / length)
        assert found / tabor == pytest.approx(ratio, abs=5e-4)
    # F/πwR and a/(3πwR²/4E*)^(1/3): DMT a³ = F + 2, JKR F = a³ − a√(6a).
    load, radius = reference.maugis_dugdale_contact(1e-3, np.array([50.0, 100.0, 200.0]))
    np.testing.assert_allclose(radius**3, load + 2, rtol=0.02, atol=0.02)
    load, radius = reference.maugis_dugdale_contact(30.0, np.array([1e-3, 2e-3]))
    np.testing.assert_allclose(load, radius**3 - radius * np.sqrt(6 * radius), rtol=0.02)


def test_jkr_and_dmt_limits():
    radius, modulus, force = 1e-6, 1e9, 1e-7
    hertz = reference.hertz_contact_radius(force, radius, modulus)
    assert reference.jkr_contact_radius(force, radius, modulus, 0.0) == pytest.approx(hertz)
    pulled = reference.dmt_contact_radius(force - 2 * np.pi * 0.05 * radius, radius, modulus, 0.05)
    assert pulled == pytest.approx(hertz)
    unloaded = reference.jkr_contact_radius(0.0, radius, modulus, 0.05)
    assert reference.jkr_approach(unloaded, radius, modulus, 0.05) == pytest.approx(unloaded**2 / (3 * radius))
    pull_off = reference.jkr_pull_off_force(radius, 0.05)
    cube = reference.jkr_contact_radius(pull_off * (1 - 1e-12), radius, modulus, 0.05) ** 3
    # A square root of the distance 1e-12 to the fold.
    assert cube == pytest.approx(9 * np.pi * 0.05 * radius**2 / (8 * modulus), rel=1e-5)


def test_hertz_pressure_carries_the_force():
    edge = reference.hertz_contact_radius(1e-7, 1e-6, 1e9)
    r = np.linspace(0, 1.01 * edge, 20001)
    pressure = reference.hertz_pressure(r, 1e-7, 1e-6, 1e9)
    assert np.trapezoid(2 * np.pi * r * pressure, r) == pytest.approx(1e-7, rel=1e-5)  # trapezia at a root singularity
    assert pressure[0] == pytest.approx(1.5e-7 / (np.pi * edge**2), rel=1e-12)
    assert pressure[-1] == 0


def test_waves_close_and_snap_and_an_egg_box_has_its_limits():
    assert reference.wave_relative_area(1.0) == pytest.approx(1)
    assert reference.wave_relative_pressure(reference.wave_relative_area(0.3)) == pytest.approx(0.3)
    assert reference.wave_relative_mean_gap(1e-9, 0.0) == pytest.approx(1)
    area = np.linspace(0.001, 0.999, 10000)
    assert reference.wave_relative_pressure(area, 0.56).max() > 0
    assert reference.wave_relative_pressure(area, 0.575).max() < 0
    assert reference.egg_box_heavy_area(1.0) == 1
    expected = 2 * np.pi * (3 * np.sqrt(2) * 1e-6 / (32 * np.pi)) ** (2 / 3)
    assert reference.egg_box_light_area(1e-6) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("function", "arguments", "named"),
    [
        ("hertz_contact_radius", (-1e-9, 1e-6, 1e9), "force"),
        ("jkr_contact_radius", (-1.501e-6 * np.pi * 0.05, 1e-6, 1e9, 0.05), "force"),
        ("jkr_contact_radius", (0.0, 1e-6, 1e9, -0.05), "work_of_adhesion"),
        ("tabor_parameter", (1e-6, np.nan, 0.05, 3e-10), "contact_modulus"),
        ("maugis_dugdale_contact", (0.0, 1.0), "maugis_parameter"),
        ("wave_relative_area", (1.1,), "relative_pressure"),
        ("wave_relative_pressure", (np.array([0.5, -0.1]),), "relative_area"),
    ],
)
def test_what_no_contact_can_be_is_named(function, arguments, named):
    with pytest.raises(ValueError, match=named):
        getattr(reference, function)(*arguments)
