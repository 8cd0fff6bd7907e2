"""The commit that a dataset names is one of this project."""

import subprocess

import pytest

from contact_study.campaign.dataset import provenance


@pytest.mark.parametrize("place", [".", ".venv/site-packages", None])
def test_only_a_checkout_names_its_commit(tmp_path, monkeypatch, place):
    """Not an environment in someone's repository, nor what is in none."""
    git = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@b.c"]
    if place is not None:
        subprocess.run([*git, "init", "-q"], check=True)
        subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", "theirs"], check=True)
    folder = tmp_path / (place or ".") / "contact_study" / "campaign" / "dataset"
    folder.mkdir(parents=True)
    monkeypatch.setattr(provenance, "__file__", str(folder / "provenance.py"))
    head = subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True, text=True).stdout.strip()
    assert provenance.git_commit.__wrapped__() == (head if place == "." else "unknown")
