"""Numbers as a reader wants them."""

import pytest

from contact_study.report.text import wording
from contact_study.report.text.wording import coordinate_label


@pytest.mark.parametrize(
    ("value", "digits", "plus", "shown"),
    [
        (-0.00532, 3, False, "−0.00532"),
        (1e-8, 3, False, "10⁻⁸"),
        (7.5e-5, 3, False, "7.5 · 10⁻⁵"),
        (0.25, 2, True, "+0.25"),
        (-3e-7, 2, True, "−3 · 10⁻⁷"),
    ],
)
def test_number(value, digits, plus, shown):
    assert wording.number(value, digits, plus) == shown


def test_percent_has_no_more_digits_than_it_means():
    assert wording.percent(-0.4449) == "−44 %"
    assert wording.percent(0.0449) == "+4.5 %"
    assert wording.percent_of(0.5) == "50 %"


@pytest.mark.parametrize(
    ("value", "error", "shown"),
    [
        (1.638, 0.0003, "1.6380 ± 0.0003"),
        (1.638, 0.02, "1.638 ± 0.020"),
        (-0.5, 0.00097, "−0.5000 ± 0.0010"),
        (2.0, 0.0, "2.000 ± 0.000"),
        (2.0, float("nan"), "2.000"),
    ],
)
def test_an_error_is_never_rounded_to_nothing(value, error, shown):
    assert wording.with_error(value, error, 3) == shown


def test_percent_with_its_error():
    assert wording.percent(0.0449, 0.003) == "+4.5 ± 0.3 %"
    assert wording.percent(-0.4449, 0.0004) == "−44.49 ± 0.04 %"


def test_values_of_a_sweep():
    assert wording.varied(["1", "1"]) == "1"
    assert wording.varied(["1", "2", "1"]) == "1 and 2"
    assert wording.varied([str(number) for number in range(12)]) == "0 to 11 (12 values)"


@pytest.mark.parametrize(
    ("name", "value", "units", "shown"),
    [
        ("well_depth_ratio", 1.0, "1", "ε = ε₀"),
        ("well_depth_ratio", 1.5, "1", "ε = 1.5 ε₀"),
        ("rms_height", 5e-10, "m", "h_rms = 5 Å"),
        ("youngs_modulus", 77.2e9, "Pa", "E = 77.2 GPa"),
        ("work_of_adhesion", 0.69, "J m-2", "Δγ = 0.69 J/m²"),
        ("well_depth", 18.6 * 1.602176634e-22, "J", "ε = 18.6 meV"),
        ("law", "lennard_jones_9_3", "1", "law = 9-3"),
        ("law", "hard_wall", "1", "law = hard wall"),
        ("kind", "self_affine", "1", "kind = self affine"),
        ("low_mode", 2.0, "1", "q_L L/2π = 2"),
    ],
)
def test_coordinates_have_symbols_and_units(name, value, units, shown):
    assert coordinate_label(name, value, units) == shown


def test_no_negative_zero():
    assert wording.fixed(-1e-9, 3) == "0.000"


@pytest.mark.parametrize(
    ("pressure", "name"), [(10e9, "GPa"), (1e9, "GPa"), (1e6, "MPa"), (250e3, "kPa"), (3.0, "Pa"), (0.0, "Pa")]
)
def test_pressure_unit(pressure, name):
    assert wording.pressure_unit(pressure).name == name


def test_length():
    assert wording.length(1040e-10) == "104 nm"
    assert wording.length(3.28e-10) == "3.28 Å"
    assert wording.length(500e-9) == "500 nm"
    assert wording.length(1e-6) == "1 µm"
    assert wording.length(0.1) == "100 mm"
