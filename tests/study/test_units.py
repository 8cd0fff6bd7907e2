"""Reading quantities, whatever the folder holds that keeps the units' definitions."""

import subprocess
import sys

import numpy as np
import pytest

from contact_study.inputs import units
from contact_study.inputs.errors import InputError
from contact_study.study.study import read_study


def forget():
    units._registry.cache_clear()
    units._from_text.cache_clear()


@pytest.fixture
def fresh(tmp_path, monkeypatch):
    monkeypatch.setattr(units, "own_cache_folder", lambda: tmp_path)
    forget()
    yield tmp_path
    forget()


def test_definitions_are_kept_in_ones_own_folder_and_damaged_ones_do_no_harm(fresh, monkeypatch):
    """Pint keeps them pickled: not in a folder that others may write."""
    monkeypatch.setenv("BEM_ADHESION_CACHE", str(fresh / "shared"))
    assert units.quantity("3 MN/m^2", "Pa", "key") == 3e6
    kept = [path for path in (fresh / "units").iterdir() if path.is_file()]
    assert kept
    assert not (fresh / "shared").exists()
    for path in kept:
        path.write_bytes(b"garbage")
    forget()
    assert units.quantity("2 inch", "m", "key") == pytest.approx(0.0508, abs=0, rel=1e-15)


@pytest.mark.validation
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


def test_numbers_beyond_any_float_are_one_line(tmp_path):
    with pytest.raises(InputError, match=r"^key: a number of 401 digits is far from any size of use; expected"):
        units.quantity(10**400, "Pa", "key")
    (tmp_path / "study.toml").write_text(f"[material]\nyoungs_modulus = 1{5000 * '0'}\n")
    with pytest.raises(InputError) as refused:
        read_study(tmp_path / "study.toml")
    assert "\n" not in str(refused.value)


def test_lengths_and_stresses_in_words():
    assert [units.length(value) for value in (1e-9, 9.99999e-7, 3e-13, 42.0)] == ["1 nm", "1 µm", "0.3 pm", "42 m"]
    assert units.length(2e-6, 5e-7) == "2 x 0.5 µm"
    stresses = [units.stress(value) for value in (-9e9, 1.7241e8, 999.9, 0.02, 0.0)]
    assert stresses == ["-9 GPa", "172 MPa", "1 kPa", "0.02 Pa", "0 Pa"]
