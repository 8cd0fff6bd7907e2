"""What tests of the comparison share: datasets of all models, and of one over seeds; they are read, never changed."""

import pytest

from contact_study.report import figures
from contact_study.report.read.datasets import read_inputs
from tests.report.synthetic import SEEDED, write, write_all


@pytest.fixture
def unrendered(monkeypatch):
    """Every figure is made and goes where it should, but empty: pixels are most of a report's time."""
    monkeypatch.setattr(figures, "saved", lambda figure, kind, name="": f'<svg width="500pt" id="{name}"/>'.encode())


@pytest.fixture(scope="session")
def files(tmp_path_factory):
    return write_all(tmp_path_factory.mktemp("files"), warnings="a grid too coarse")


@pytest.fixture(scope="session")
def inputs(files):
    return read_inputs(files)


@pytest.fixture(scope="session")
def seeds(tmp_path_factory):
    return write(tmp_path_factory.mktemp("seeds") / "seeds.nc", "continuum", SEEDED)
