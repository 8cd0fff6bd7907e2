"""The wheel: what is in it, and that it works alone, installed in a fresh environment, from any folder."""

import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pytest
import xarray as xr

import contact_study

pytestmark = pytest.mark.validation
ROOT = Path(contact_study.__file__).parent.parent
PACKAGES = ("contact_study", "bem_adhesion", "md_reference", "theory")
# Nothing may come from this environment.
CLEAN = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "PYTEST"))}


def run(*command, folder):
    done = subprocess.run([*map(str, command)], cwd=folder, env=CLEAN, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def folder():
    """A folder with the project's source and wheel, gone afterwards: an environment takes half a gigabyte."""
    with tempfile.TemporaryDirectory() as name:
        source = Path(name) / "source"
        source.mkdir()
        for package in (*PACKAGES, "tests"):
            shutil.copytree(ROOT / package, source / package, ignore=shutil.ignore_patterns("__pycache__"))
        for file in ("pyproject.toml", "README.md", "LICENSE"):
            shutil.copy(ROOT / file, source)
        run(sys.executable, "-m", "pip", "wheel", "./source", "--no-deps", "-q", "-w", "built", folder=name)
        yield Path(name)


def test_wheel_holds_the_packages_and_nothing_else(folder):
    (wheel,) = (folder / "built").iterdir()
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.partition("/")[0] for name in names}
    assert tops == {*PACKAGES, f"bem_adhesion-{contact_study.__version__}.dist-info"}
    studies = {file.name for file in (ROOT / "contact_study" / "example_studies").iterdir()}
    assert {name.rpartition("/")[2] for name in names if name.endswith(".toml")} == {*studies, "models.toml"}
    modules = {str(file.relative_to(ROOT)) for package in PACKAGES for file in (ROOT / package).rglob("*.py")}
    assert {name for name in names if name.endswith(".py")} == modules
    assert {name for name in names if name.endswith("py.typed")} == {f"{package}/py.typed" for package in PACKAGES}


def test_installed_wheel_works_from_any_folder(folder):
    (wheel,) = (folder / "built").iterdir()
    environment, elsewhere = folder / "environment", folder / "elsewhere"
    run(sys.executable, "-m", "venv", environment, folder=folder)
    elsewhere.mkdir()
    bin_ = environment / "bin"
    run(bin_ / "python", "-m", "pip", "install", "-q", "--no-compile", wheel, folder=elsewhere)
    (elsewhere / "study.toml").write_text(run(bin_ / "bem-adhesion", "--example", "first", folder=elsewhere))
    run(bin_ / "bem-adhesion", "study.toml", "-o", "bem.nc", "--workers", 1, folder=elsewhere)
    run(bin_ / "contact-compare", "bem.nc", "-o", "comparison.nc", "--report", "report.html", folder=elsewhere)
    assert "a first study" in (elsewhere / "report.html").read_text()
    assert run(bin_ / "persson-theory", "--version", folder=elsewhere).split()[1] == contact_study.__version__
    with xr.open_dataset(elsewhere / "bem.nc") as dataset:
        assert (dataset.converged == 1).all()
        assert dataset.attrs["git_commit"] == "unknown"
