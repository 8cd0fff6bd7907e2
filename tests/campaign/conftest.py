"""What tests of the campaign share."""

import shutil
from contextlib import contextmanager
from unittest.mock import Mock

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
    def run_study(table, *arguments, output="bem.nc", model=TOY):
        (tmp_path / "study.toml").write_text(tomli_w.dumps(table))
        SOLVED.clear()
        capsys.readouterr()
        status = main(model, [str(tmp_path / "study.toml"), "-o", str(tmp_path / output), "--workers", "1", *arguments])
        return status, list(SOLVED), capsys.readouterr().err

    return run_study


@pytest.fixture(scope="session")
def built(tmp_path_factory):
    known = {}

    def build(table, *arguments, model=TOY, name="bem.nc"):
        key = (tomli_w.dumps(table), arguments, model, name)
        if key not in known:
            folder = tmp_path_factory.mktemp("built")
            (folder / "study.toml").write_text(key[0])
            command = [str(folder / "study.toml"), "-o", str(folder / name), "--workers", "1", *arguments]
            assert main(model, command) in (0, 2)
            known[key] = folder / name
        return known[key]

    return build


@pytest.fixture
def finished(built, tmp_path):
    for name in ("bem.nc", "bem.nc.restart"):
        shutil.copy(built(BASE).with_name(name), tmp_path)


@pytest.fixture
def after_step(monkeypatch):
    @contextmanager
    def patched(act, count=1):
        save, saved = CaseWriter.save_step, []

        def counted(file, number, step):
            save(file, number, step)
            saved.append(number)
            if len(saved) == count:
                act()

        with monkeypatch.context() as patch:
            patch.setattr(CaseWriter, "save_step", counted)
            yield

    return patched


def fail(error):
    return Mock(side_effect=error)


interrupt = fail(KeyboardInterrupt)


@pytest.fixture
def stopped(run, after_step):
    def stop(table, after, *arguments, **options):
        with after_step(interrupt, after):
            assert run(table, *arguments, **options)[0] == 130

    return stop


@pytest.fixture
def toy_is_the_continuum(monkeypatch):
    monkeypatch.setitem(MODELS, "continuum", TOY)
