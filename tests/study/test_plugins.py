"""Kinds from outside the package: in studies, sweeps, --help, on workers; what cannot be registered."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

COMMAND = "import sys; from contact_study import start; sys.exit(start.bem_adhesion())"
STUDY = """
[surface]
kind = "ridge"
size = ["40 nm", "40 nm"]
shape = [16, 16]
ridge_height = "1 nm"
[material]
youngs_modulus = "10 GPa"
poissons_ratio = 0.3
[elasticity]
kind = "stiff"
[interaction]
law = "own_morse"
work_of_adhesion = "0.1 J/m^2"
length = "3.28 angstrom"
width = "2 angstrom"
[loading]
path = ["0.1 GPa"]
[sweep]
"elasticity.stiffening" = [1, 2]
"interaction.width" = ["2 angstrom", "3 angstrom"]
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """Environment in which a package with a plug-in is installed."""
    folder = tmp_path_factory.mktemp("site")
    (folder / "own_kinds.py").write_text(Path(__file__).with_name("own_kinds.py").read_text())
    told = folder / "own_kinds-1.0.dist-info"
    told.mkdir()
    (told / "METADATA").write_text("Metadata-Version: 2.1\nName: own_kinds\nVersion: 1.0\n")
    (told / "entry_points.txt").write_text("[contact_study.plugins]\nown = own_kinds\n")
    return {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), *sys.path])}


def command(environment, *arguments):
    return subprocess.run([sys.executable, "-c", COMMAND, *arguments], env=environment, capture_output=True, text=True)


def test_a_plug_in_has_its_keys_in_help(installed):
    shown = command(installed, "--help").stdout
    for words in ("range of my attraction", "amplitude of my ridges", "factor of my modulus", "own_morse"):
        assert words in " ".join(shown.split())


def test_a_sweep_over_own_keys_runs_on_workers(installed, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY)
    done = command(installed, str(tmp_path / "study.toml"), "-o", str(tmp_path / "own.nc"), "--workers", "2")
    assert done.returncode == 0, done.stderr
    code = (
        "import xarray as xr, sys; d = xr.open_dataset(sys.argv[1]);"
        "assert dict(d.sizes)['stiffening'] == dict(d.sizes)['width'] == 2;"
        "assert (d.contact_modulus[1] == 2 * d.contact_modulus[0]).all(); assert d.converged.all();"
        "assert (d.largest_gap > d.mean_gap).all() and d.largest_gap.attrs['units'] == 'm'"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "own.nc")], check=True)


def test_a_plug_in_that_fails_is_one_line(installed, tmp_path):
    (tmp_path / "own_kinds.py").write_text("1 / 0")
    broken = {**installed, "PYTHONPATH": os.pathsep.join([str(tmp_path), installed["PYTHONPATH"]])}
    done = command(broken, "--help")
    assert done.returncode == 1
    assert done.stderr == "bem-adhesion: error: plug-in own (own_kinds) cannot be loaded: division by zero\n"


def test_registered_twice_is_once_and_a_name_is_one_meaning(installed):
    subprocess.run([sys.executable, Path(__file__).with_name("check_own_kinds.py"), STUDY], env=installed, check=True)
