"""Reading quantities, whatever the folder holds that keeps the units' definitions."""

import subprocess
import sys

import pytest

from contact_study.problem import units


@pytest.fixture
def fresh(tmp_path, monkeypatch):
    monkeypatch.setenv("BEM_ADHESION_CACHE", str(tmp_path))
    units._registry.cache_clear()
    yield tmp_path
    units._registry.cache_clear()


def test_definitions_are_kept_and_damaged_ones_do_no_harm(fresh):
    assert units.quantity("3 GPa", "Pa", "key") == 3e9
    kept = [path for path in (fresh / "units").iterdir() if path.is_file()]
    assert kept
    for path in kept:
        path.write_bytes(b"garbage")
    units._registry.cache_clear()
    assert units.quantity("2 angstrom", "m", "key") == pytest.approx(2e-10, abs=0, rel=1e-15)


def test_a_folder_that_cannot_be_made_does_no_harm(fresh, monkeypatch):
    (fresh / "file").touch()
    monkeypatch.setenv("BEM_ADHESION_CACHE", str(fresh / "file" / "below"))
    assert units.quantity("3 GPa", "Pa", "key") == 3e9


def test_commands_start_without_dask():
    """Nor is it kept from those who use it."""
    code = "import sys, theory.run; assert 'dask' not in sys.modules; import dask.array; import pyfftw"
    pytest.importorskip("dask")
    subprocess.run([sys.executable, "-c", code], check=True)
