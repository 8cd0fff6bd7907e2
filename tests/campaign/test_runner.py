"""How many processes and threads a study has, by the cores of the machine."""

import dataclasses

import pytest

from contact_study.campaign import engines
from contact_study.campaign import run as runner
from tests.campaign.toy_model import TOY
from tests.commands import main

RUN = engines.run


@pytest.mark.parametrize(
    ("cores", "busy", "asked", "chosen"),
    [
        (2, 1, None, (2, 1)),
        (8, 1, None, (4, 2)),  # there are four cases
        (8, 1, 3, (3, 2)),
        (1, 2, None, (1, 1)),
        (2, 2, None, (2, 1)),  # two cases for each process
        (3, 2, None, (1, 3)),
        (5, 2, None, (2, 2)),
        (16, 2, None, (4, 4)),
        (2, 2, 2, (2, 1)),  # what is asked for is done
        (4, 2, 1, (1, 4)),
    ],
)
def test_a_case_has_the_cores_that_it_keeps_busy(study, tmp_path, monkeypatch, cores, busy, asked, chosen):
    found = []

    def kept(tasks, workers, *rest):
        found.append((workers, tasks[0].args[1]))
        RUN(tasks, 1, *rest)

    monkeypatch.setattr(runner, "available_cores", lambda: cores)
    monkeypatch.setattr(engines, "run", kept)
    model = dataclasses.replace(TOY, threads=busy)
    workers = [] if asked is None else ["--workers", str(asked)]
    assert main(model, [str(study), "-o", str(tmp_path / "bem.nc"), *workers]) == 0
    assert found == [chosen]
