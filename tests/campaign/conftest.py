"""What tests of the campaign share."""

import shutil

import pytest
import tomli_w

from contact_study.campaign.model import MODELS
from contact_study.campaign.store.case_file import CaseWriter
from tests.campaign.toy_model import SOLVED, TOY
from tests.campaign.toy_study import BASE, STUDY
from tests.commands import main


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


@pytest.fixture
def run(tmp_path, capsys):
    """Run a study on an output; returns the status, the steps solved and what was said."""

    def run_study(table, *arguments, output="bem.nc", model=TOY):
        (tmp_path / "study.toml").write_text(tomli_w.dumps(table))
        SOLVED.clear()
        capsys.readouterr()
        status = main(model, [str(tmp_path / "study.toml"), "-o", str(tmp_path / output), "--workers", "1", *arguments])
        return status, list(SOLVED), capsys.readouterr().err

    return run_study


@pytest.fixture(scope="module")
def base_dataset(tmp_path_factory):
    folder = tmp_path_factory.mktemp("base")
    (folder / "study.toml").write_text(tomli_w.dumps(BASE))
    assert main(TOY, [str(folder / "study.toml"), "-o", str(folder / "bem.nc"), "--workers", "1"]) == 0
    return folder / "bem.nc"


@pytest.fixture
def finished(base_dataset, tmp_path):
    """The dataset of the study, at the output."""
    for name in ("bem.nc", "bem.nc.restart"):
        shutil.copy(base_dataset.with_name(name), tmp_path)


@pytest.fixture
def stopped(run, monkeypatch):
    """Interrupt a run after so many steps."""

    def stop(table, after, *arguments, **options):
        save, count = CaseWriter.save_step, []

        def counted(file, number, step):
            save(file, number, step)
            count.append(number)
            if len(count) == after:
                raise KeyboardInterrupt

        with monkeypatch.context() as patch:
            patch.setattr(CaseWriter, "save_step", counted)
            assert run(table, *arguments, **options)[0] == 130

    return stop


@pytest.fixture
def toy_is_the_continuum(monkeypatch):
    monkeypatch.setitem(MODELS, "continuum", TOY)
