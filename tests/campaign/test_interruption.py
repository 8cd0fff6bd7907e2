import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import tomli_w
import xarray as xr

from contact_study.campaign import record
from contact_study.campaign.store.case_file import CaseFile
from tests.campaign.toy_study import MORE, assert_same, changed, steps_on_disk


@pytest.mark.validation
@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="finds the workers in /proc")
@pytest.mark.parametrize("when", ["a step is finished", "workers start"])
def test_interrupt_keeps_steps_and_says_so(tmp_path, when):
    (tmp_path / "study.toml").write_text(tomli_w.dumps(MORE))
    toy = [sys.executable, "-m", "tests.campaign.toy_model", tmp_path / "study.toml", "-o", tmp_path / "bem.nc"]
    slow = {**os.environ, "TOY_SECONDS": "0.3"}
    with subprocess.Popen(
        [*toy, "--workers", "3"], env=slow, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        starting, deadline = when == "workers start", time.monotonic() + 60
        # The resource tracker and two workers; or a step.
        while len(children.read_text().split()) < 3 if starting else not steps_on_disk(tmp_path / "bem.nc.parts"):
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.01)
        time.sleep(0.2 * starting)  # into their imports
        os.killpg(process.pid, signal.SIGINT)  # what Ctrl-C does: the whole group
        _, stderr = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "Traceback" not in stderr
    if not starting:
        assert "continue with --resume" in stderr
        assert steps_on_disk(tmp_path / "bem.nc.parts")


# Of one case, which warns at its first step.
ONE = changed(sweep={"interaction.well_depth_ratio": [2]}, loading={"path": ["0.1 GPa", "-0.5 GPa", "1 GPa", "2 GPa"]})


@pytest.fixture
def interrupted(stopped, tmp_path):
    stopped(ONE, 3)
    assert not (tmp_path / "bem.nc").exists()
    return tmp_path / "bem.nc.parts"


@pytest.mark.parametrize("there", ["the same study", "another study", "no dataset"])
def test_steps_that_replace_what_stands_there_go_on(run, stopped, built, tmp_path, there):
    output = tmp_path / "bem.nc"
    if there == "no dataset":
        output.write_text("notes")
    else:
        run(ONE, *(["--surface.seed", "5"] if there == "another study" else []))
    before = output.read_bytes()
    stopped(ONE, 3, "--overwrite")
    stopped(ONE, 3, "--overwrite")  # a second time from the start
    assert output.read_bytes() == before
    status, _, said = run(ONE, "--resume")
    assert status == 0
    assert "3 of 4 steps were finished before" in said
    assert_same(output, built(ONE))
    assert not (tmp_path / "bem.nc.parts").exists()


def flipped(kind, number, where=None):
    def act(content, records):
        record = records[kind, number]
        content[record.end - 1 if where is None else record.start + where] ^= 1
        return content

    return act


DAMAGE = {
    **{
        f"torn at {where}": (lambda content, _, where=where: content[: int(where * len(content))], "")
        for where in (0.0, 0.5, 0.999, 1.0)
    },
    **{f"{kind} {n}": (flipped(kind, n), "1 damaged") for kind, n in ((b"cons", 0), (b"stat", 2), (b"note", 0))},
    **{f"byte {where}": (flipped(b"step", 1, where), "1 damaged") for where in (0, 10, 40)},
    "a length": (flipped(b"step", 1, 18), ""),  # the rest may be longer than the file, as what a kill has torn
}


@pytest.mark.parametrize("name", DAMAGE)
def test_what_is_damaged_on_disk_is_computed_again(run, built, interrupted, tmp_path, name):
    (path,) = interrupted.glob("*.case")
    act, words = DAMAGE[name]
    path.write_bytes(act(bytearray(path.read_bytes()), CaseFile(path)._records))
    status, _, said = run(ONE, "--resume")
    assert status == 0
    assert words in said
    assert ("damaged" in said) == bool(words)
    assert_same(tmp_path / "bem.nc", built(ONE))
    with xr.open_dataset(tmp_path / "bem.nc") as dataset:
        kept = "" if "note" in name else "well_depth_ratio = 2.0: a grid too coarse"
        assert dataset.attrs["warnings"] == kept
        assert f"warning: {kept}" in said or not kept


def test_another_commit_is_said(run, interrupted, monkeypatch):
    monkeypatch.setattr(record, "git_commit", lambda: "another")
    assert "the next of another" in run(ONE, "--resume")[2]
    monkeypatch.undo()
    assert "is of commit another" in run(ONE, "--resume")[2]
