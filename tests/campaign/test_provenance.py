"""The commit that a dataset names is one of this project."""

import subprocess

import pytest

from contact_study.campaign.dataset import provenance


def commit_seen_from(place, monkeypatch):
    monkeypatch.setattr(provenance, "__file__", str(place / "provenance.py"))
    return provenance.git_commit.__wrapped__()


@pytest.fixture
def repository(tmp_path):
    """Someone's repository with one commit."""
    git = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@b.c"]
    for words in (["init", "-q"], ["commit", "-q", "--allow-empty", "-m", "theirs"]):
        subprocess.run([*git, *words], check=True)
    return tmp_path


def test_a_checkout_names_its_commit(repository, monkeypatch):
    place = repository / "contact_study" / "campaign" / "dataset"
    place.mkdir(parents=True)
    head = subprocess.run(["git", "-C", str(place), "rev-parse", "HEAD"], capture_output=True, text=True, check=True)
    assert commit_seen_from(place, monkeypatch) == head.stdout.strip()


def test_an_environment_in_someone_s_repository_does_not_name_theirs(repository, monkeypatch):
    place = repository / ".venv" / "site-packages" / "contact_study" / "campaign" / "dataset"
    place.mkdir(parents=True)
    assert commit_seen_from(place, monkeypatch) == "unknown"


def test_outside_any_repository(tmp_path, monkeypatch):
    assert commit_seen_from(tmp_path, monkeypatch) == "unknown"
