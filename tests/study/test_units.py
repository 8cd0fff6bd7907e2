"""Reading quantities, whatever the folder holds that keeps the units' definitions."""

import subprocess
import sys

import numpy as np
import pytest

from contact_study.inputs import units
from contact_study.inputs.errors import InputError
from contact_study.study.study import read_study


@pytest.fixture
def fresh(tmp_path, monkeypatch):
    monkeypatch.setattr(units, "own_cache_folder", lambda: tmp_path)
    forget = (units._registry.cache_clear, units._from_text.cache_clear)
    for each in forget:
        each()
    yield tmp_path
    for each in forget:
        each()


def test_definitions_are_kept_and_damaged_ones_do_no_harm(fresh):
    assert units.quantity("3 MN/m^2", "Pa", "key") == 3e6
    kept = [path for path in (fresh / "units").iterdir() if path.is_file()]
    assert kept
    for path in kept:
        path.write_bytes(b"garbage")
    units._registry.cache_clear()
    units._from_text.cache_clear()
    assert units.quantity("2 inch", "m", "key") == pytest.approx(0.0508, abs=0, rel=1e-15)


def test_definitions_are_not_read_from_a_folder_that_others_may_write(fresh, monkeypatch):
    """Pint keeps them pickled."""
    monkeypatch.setenv("BEM_ADHESION_CACHE", str(fresh / "shared"))
    assert units.quantity("3 MN/m^2", "Pa", "key") == 3e6
    assert (fresh / "units").is_dir()
    assert not (fresh / "shared").exists()


def test_a_folder_that_cannot_be_made_does_no_harm(fresh, monkeypatch):
    (fresh / "file").touch()
    monkeypatch.setattr(units, "own_cache_folder", lambda: fresh / "file" / "below")
    assert units.quantity("3 MN/m^2", "Pa", "key") == 3e6


def test_commands_start_without_dask():
    """Nor is it kept from those who use it."""
    code = "import sys, theory.study.model; assert 'dask' not in sys.modules; import dask.array; import pyfftw"
    pytest.importorskip("dask")
    subprocess.run([sys.executable, "-c", code], check=True)


def test_everyday_units_are_those_of_pint_to_the_last_bit():
    numbers = np.random.default_rng(0).normal(0, 100, 50)
    for unit, known in units._COMMON.items():
        for written in known:
            for number in numbers:
                expected = units._registry().Quantity(float(number), written).to(unit).magnitude
                assert units.quantity(f"{float(number)!r} {written}", unit, "key") == expected, written


@pytest.mark.parametrize(("text", "unit", "is_one"), [("1 nN", "N", True), ("1 GPa", "N", False), ("1 kgf", "N", True)])
def test_kinds_of_units(text, unit, is_one):
    assert units.is_a(text, unit) == is_one


def test_an_integer_beyond_any_float_is_one_line():
    with pytest.raises(InputError, match=r"^key: a number of 401 digits is far from any size of use; expected"):
        units.quantity(10**400, "Pa", "key")


@pytest.mark.parametrize("digits", [400, 5000])
def test_a_study_with_such_a_number_is_one_line(tmp_path, digits):
    (tmp_path / "study.toml").write_text(f"[material]\nyoungs_modulus = 1{digits * '0'}\n")
    with pytest.raises(InputError) as refused:
        read_study(tmp_path / "study.toml")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("metres", "words"),
    [((1e-9,), "1 nm"), ((9.99999e-7,), "1 µm"), ((2e-6, 5e-7), "2 x 0.5 µm"), ((3e-13,), "0.3 pm"), ((42.0,), "42 m")],
)
def test_lengths_in_words(metres, words):
    assert units.length(*metres) == words


@pytest.mark.parametrize(
    ("pascals", "words"), [(-9e9, "-9 GPa"), (1.7241e8, "172 MPa"), (999.9, "1 kPa"), (0.02, "0.02 Pa"), (0.0, "0 Pa")]
)
def test_stresses_in_words(pascals, words):
    assert units.stress(pascals) == words
