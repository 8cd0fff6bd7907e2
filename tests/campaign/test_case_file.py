import numpy as np
import pytest

from contact_study.campaign.engines import CampaignError
from contact_study.campaign.store import case_file
from contact_study.campaign.store.case_file import CaseFile, CaseWriter
from contact_study.numerics.distributions import Bins
from contact_study.results.state import Step

BINS = Bins.evenly((-1.0, 2.0, 3), (0.0, 1e-9, 4))


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.case"


def step(number, size=3):
    values = {"area": 0.1 * number, "message": "ä", "converged": True, "iterations": number, "residual": np.inf}
    fields = {"gap": np.full((4, 6), number, np.float32), "none": np.empty((0, 2))}
    return Step(values, fields, {"state": np.full(size, float(number))}, BINS)


def test_what_is_saved_is_read_again(path):
    with CaseWriter(path, 3, last_state=True) as file:
        file.save_constants({"modulus": 1e9, "height": np.arange(6.0).reshape(2, 3).T})
        file.save_notes(["one", "two"])
        file.save_notes(["three"])
        for number in range(2):
            file.save_step(number, step(number))
        file.save_partial(2, {"series": np.arange(3)})
    file = CaseFile(path)
    assert (file.finished(3, True), file.finished(2, True), file.has_constants, file.damaged) == (2, 2, True, False)
    assert file.notes == ["one", "two", "three"]
    assert file.constants["modulus"] == 1e9
    np.testing.assert_array_equal(file.constants["height"], np.arange(6.0).reshape(2, 3).T)
    values, bins = file.step(1)
    assert bins.equal(BINS)
    assert (values["area"], values["message"], values["converged"], values["residual"]) == (0.1, "ä", True, np.inf)
    assert values["gap"].dtype == np.float32
    assert values["gap"].flags.writeable
    assert values["none"].shape == (0, 2)
    np.testing.assert_array_equal(file.state(1)["state"], [1, 1, 1])
    np.testing.assert_array_equal(file.partial(2)["series"], [0, 1, 2])
    assert file.step_text(1, "message") == "ä"
    assert file.step_text(2, "message") is None


def test_states_that_serve_nobody_do_not_pile_up(path, monkeypatch):
    monkeypatch.setattr(case_file, "_LEAST_GAIN", 1000)
    largest = 0
    with CaseWriter(path, 50, last_state=False) as file:
        file.save_constants({"modulus": 1e9})
        for number in range(50):
            file.save_step(number, step(number, 12_500))
            largest = max(largest, path.stat().st_size)
    assert largest < 0.4e6
    file = CaseFile(path)
    assert file.finished(50, last_state=True) == 50
    assert file.constants == {"modulus": 1e9}
    assert [file.step(number)[0]["iterations"] for number in range(50)] == list(range(50))
    assert [*path.parent.iterdir()] == [path]


def test_who_takes_up_a_case_has_it_to_himself(path):
    with CaseWriter(path, 3, last_state=True) as first:
        first.save_step(0, step(0))
        with CaseWriter(path, 3, last_state=True) as second:
            assert second.start == 1
            with pytest.raises(CampaignError, match=r"a\.case: was deleted, or taken over by another run"):
                first.save_step(1, step(7))
            second.save_step(1, step(1))
    assert CaseFile(path).step(1)[0]["iterations"] == 1
    assert not CaseFile(path).damaged
