"""Numbers as a reader wants them."""

import pytest

from contact_study.comparison import wording


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


def test_no_negative_zero():
    assert wording.fixed(-1e-9, 3) == "0.000"


@pytest.mark.parametrize(
    ("pressure", "name"), [(10e9, "GPa"), (1e9, "GPa"), (1e6, "MPa"), (250e3, "kPa"), (3.0, "Pa"), (0.0, "Pa")]
)
def test_pressure_unit(pressure, name):
    assert wording.pressure_unit(pressure).name == name


def test_length():
    assert wording.length(1040e-10) == "1040 Å"
    assert wording.length(3.28e-10) == "3.28 Å"
    assert wording.length(500e-9) == "500 nm"
    assert wording.length(1e-6) == "1 µm"
    assert wording.length(0.1) == "100 mm"
