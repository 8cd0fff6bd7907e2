"""Kinds from outside the package: in studies, sweeps, --help, on workers; what cannot be registered."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

STUDY = """
surface = { kind = "ridge", size = "40 nm", shape = [16, 16], ridge_height = "1 nm" }
material = { youngs_modulus = "10 GPa", poissons_ratio = 0.3 }
elasticity = { kind = "stiff" }
interaction = { law = "own_morse", work_of_adhesion = "0.1 J/m^2", length = "3.28 angstrom", width = "2 angstrom" }
loading = { path = ["0.1 GPa"] }
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


def test_a_plug_in_that_fails_is_one_line(installed, tmp_path):
    (tmp_path / "own_kinds.py").write_text("1 / 0")
    broken = {**installed, "PYTHONPATH": os.pathsep.join([str(tmp_path), installed["PYTHONPATH"]])}
    command = [Path(sys.executable).with_name("bem-adhesion"), "keys", "interaction"]
    done = subprocess.run(command, env=broken, capture_output=True, text=True)
    said = "bem-adhesion: error: plug-in own (own_kinds) cannot be loaded: division by zero\n"
    assert (done.returncode, done.stderr) == (1, said)


@pytest.mark.validation
def test_own_kinds_run_on_workers_have_keys_and_keep_their_names(installed):
    checks = [sys.executable, Path(__file__).with_name("check_own_kinds.py"), STUDY]
    shown = subprocess.run(checks, env=installed, check=True, capture_output=True, text=True).stdout
    for words in ("range of my attraction", "amplitude of my ridges", "factor of my modulus", "own_morse"):
        assert words in " ".join(shown.split())
