"""Runs that are stopped, and what of their steps is taken up again."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr

from contact_study.campaign.dataset import provenance
from contact_study.campaign.store.case_file import CaseFile, CaseWriter
from tests.campaign.toy_study import assert_same, run, steps_on_disk


def test_killed_run_resumes_to_the_same_dataset(study, tmp_path):
    assert run(study, "-o", tmp_path / "whole.nc", "--workers", 1) == 0
    output = tmp_path / "killed.nc"
    command = [sys.executable, "-m", "tests.campaign.toy_model", str(study), "-o", str(output), "--workers", "2"]
    slow = {**os.environ, "TOY_SECONDS": "0.2"}
    process = subprocess.Popen(command, env=slow, stderr=subprocess.DEVNULL, start_new_session=True)
    parts = tmp_path / "killed.nc.parts"
    deadline = time.monotonic() + 60
    while steps_on_disk(parts) < 3 and time.monotonic() < deadline:
        time.sleep(0.02)
    process.kill()
    process.wait()
    assert not output.exists()
    kept = steps_on_disk(parts)
    assert 3 <= kept < 14
    resumed = subprocess.run([*command, "--resume"], capture_output=True, text=True)
    assert resumed.returncode == 0, resumed.stderr
    assert re.search(r"\d+ of 14 steps were finished before", resumed.stderr)
    assert_same(tmp_path / "whole.nc", output)
    assert not parts.exists()


def test_interrupt_keeps_steps_and_says_so(study, tmp_path):
    output = tmp_path / "bem.nc"
    command = [sys.executable, "-m", "tests.campaign.toy_model", str(study), "-o", str(output), "--workers", "2"]
    process = subprocess.Popen(
        command, env={**os.environ, "TOY_SECONDS": "0.3"}, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    while not steps_on_disk(tmp_path / "bem.nc.parts"):
        assert process.poll() is None
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)  # what Ctrl-C does: the whole group
    _, stderr = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "continue with --resume" in stderr
    assert "Traceback" not in stderr
    assert steps_on_disk(tmp_path / "bem.nc.parts")


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="finds the workers in /proc")
def test_interrupt_while_workers_start(study, tmp_path):
    command = [sys.executable, "-m", "tests.campaign.toy_model", study, "-o", tmp_path / "bem.nc", "--workers", "3"]
    slow = {**os.environ, "TOY_SECONDS": "0.3"}
    process = subprocess.Popen(command, env=slow, stderr=subprocess.PIPE, text=True, start_new_session=True)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while len(children.read_text().split()) < 3:  # the resource tracker and two workers
        assert process.poll() is None
    time.sleep(0.2)  # into their imports
    os.killpg(process.pid, signal.SIGINT)
    _, stderr = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "Traceback" not in stderr


@pytest.fixture
def stopped(monkeypatch):
    """Run a study of one case that is interrupted after three steps."""
    save = CaseWriter.save_step

    def stop_after_three(file, number, step):
        save(file, number, step)
        if number == 2:
            raise KeyboardInterrupt

    def stopped_run(*arguments):
        with monkeypatch.context() as patch:
            patch.setattr(CaseWriter, "save_step", stop_after_three)
            assert run(*arguments) == 130

    return stopped_run


@pytest.fixture
def interrupted(study, tmp_path, stopped):
    """An output whose run was interrupted after three steps, in the only case, which warns at its first."""
    output = tmp_path / "bem.nc"
    study.write_text(study.read_text().replace("[1, 4]", "[2]").replace("[1, 2]", "[1]"))
    study.write_text(study.read_text().replace('when = { "interaction.well_depth_ratio" = 4 }', OVERRIDE_ALL))
    assert run(study, "-o", tmp_path / "whole.nc") == 0
    stopped(study, "-o", output)
    assert not output.exists()
    return output


OVERRIDE_ALL = 'when = { "interaction.well_depth_ratio" = 2 }'


@pytest.mark.parametrize("there", ["the same study", "another study", "no dataset"])
def test_steps_that_replace_what_stands_there_go_on(study, interrupted, tmp_path, capsys, stopped, there):
    output = tmp_path / "there.nc"
    if there == "no dataset":
        output.write_text("notes")
    else:
        keys = ["--surface.seed", 5] if there == "another study" else []
        assert run(study, "-o", output, *keys) == 0
    before = output.read_bytes()
    stopped(study, "-o", output, "--overwrite")
    stopped(study, "-o", output, "--overwrite")  # a second time from the start
    assert output.read_bytes() == before
    capsys.readouterr()
    assert run(study, "-o", output, "--resume") == 0
    assert "3 of 4 steps were finished before" in capsys.readouterr().err
    assert_same(tmp_path / "whole.nc", output)
    assert not (tmp_path / "there.nc.parts").exists()


def test_warnings_of_finished_steps_survive_a_resume(study, interrupted, capsys):
    capsys.readouterr()
    assert run(study, "-o", interrupted, "--resume") == 0
    assert "warning: well_depth_ratio = 2.0, seed = 1: a grid too coarse" in capsys.readouterr().err
    with xr.open_dataset(interrupted) as dataset:
        assert "a grid too coarse" in dataset.attrs["warnings"]


def records_of(path):
    """Kind, number and place of the records of a case's file."""
    return {(record.kind, record.number): record for record in CaseFile(path)._records.values()}


@pytest.mark.parametrize("where", [0.0, 0.5, 0.999])
def test_a_torn_file_is_gone_on_with(study, interrupted, tmp_path, capsys, where):
    (torn,) = (tmp_path / "bem.nc.parts").glob("*.case")
    torn.write_bytes(torn.read_bytes()[: int(where * torn.stat().st_size)])
    capsys.readouterr()
    assert run(study, "-o", interrupted, "--resume") == 0
    assert "damaged" not in capsys.readouterr().err
    assert_same(tmp_path / "whole.nc", interrupted)


KEYS = [(b"cons", 0), (b"note", 0), (b"step", 1), (b"stat", 2), (b"step", 2)]


@pytest.mark.parametrize(
    ("key", "where"), [*[(key, -1) for key in KEYS], *[((b"step", 1), where) for where in (0, 10, 18, 40)]]
)
def test_changed_bits_on_disk_are_computed_again(study, interrupted, tmp_path, capsys, key, where):
    (damaged,) = (tmp_path / "bem.nc.parts").glob("*.case")
    record = records_of(damaged)[key]
    content = bytearray(damaged.read_bytes())
    content[record.start + where if where >= 0 else record.end - 1] ^= 1
    damaged.write_bytes(content)
    capsys.readouterr()
    assert run(study, "-o", interrupted, "--resume") == 0
    torn = where == 18  # the length: the rest may be longer than the file, as what a kill has torn
    assert "1 damaged files" in capsys.readouterr().err or torn
    assert_same(tmp_path / "whole.nc", interrupted)


def test_another_commit_is_said(study, interrupted, monkeypatch, capsys):
    monkeypatch.setattr(provenance, "git_commit", lambda: "another")
    assert run(study, "-o", interrupted, "--resume") == 0
    assert "the next of another" in capsys.readouterr().err
    monkeypatch.undo()
    assert run(study, "-o", interrupted, "--resume") == 0
    assert "is of commit another" in capsys.readouterr().err


@pytest.mark.parametrize("content", [None, "[1]"])
def test_steps_without_a_manifest_are_not_mixed(study, interrupted, tmp_path, capsys, content):
    manifest = tmp_path / "bem.nc.parts" / "manifest.json"
    manifest.unlink()
    if content is not None:
        manifest.write_text(content)
    before = sorted(tmp_path.rglob("*"))
    assert run(study, "-o", interrupted) == 1
    assert run(study, "-o", interrupted, "--resume") == 1
    assert "has lost the record of its run (manifest.json)" in capsys.readouterr().err
    assert sorted(tmp_path.rglob("*")) == before
    assert run(study, "-o", interrupted, "--overwrite") == 0
