"""Runs of a folder: commands in processes of their own, which go on when the page is closed.

A run's process and messages are beside its output, ``bem.nc.run``. No dataset is opened here.
"""

import json
import os
import re
import signal
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_COMMAND = "import sys; from contact_study.start import bem_adhesion; sys.exit(bem_adhesion())"
_COUNT = re.compile(r"\[(\d+)/(\d+)\]")
_TAIL = 2000  # characters of the messages


@dataclass(frozen=True)
class Run:
    """A run as its files tell: output, process, arguments, whether it lives, steps done and in all, last message."""

    output: Path
    process: int
    arguments: list[str]
    alive: bool
    done: int
    total: int
    message: str

    @property
    def unfinished(self) -> bool:
        return not self.alive and (_parts(self.output).exists() or not self.output.exists())

    @property
    def state(self) -> str:
        if self.alive:
            return f"runs, {self.done} of {self.total} steps" if self.total else "begins"
        return f"stopped, {self.done} of {self.total} steps" if self.unfinished else "finished"


def start(study: Path, output: Path, model: str) -> None:
    """Run a study beside its file, or go on with its run; returns at once."""
    found = run_of(output)
    if found is None or not found.alive:
        _begin(output, ["run", study.name, "-o", output.name, "--model", model])


def resume(output: Path) -> None:
    """Go on with a run that a page began."""
    found = run_of(output)
    if found is not None and not found.alive:
        _begin(output, found.arguments)


def _begin(output: Path, arguments: list[str]) -> None:
    more = ["--resume"] if _parts(output).exists() else []
    with _log(output).open("wb") as log:
        streams: dict[str, Any] = {"stdin": subprocess.DEVNULL, "stdout": log, "stderr": subprocess.STDOUT}
        command = [sys.executable, "-c", _COMMAND, *arguments, *more]
        process = subprocess.Popen(command, cwd=output.parent, start_new_session=True, **streams)
    _record(output).write_text(json.dumps({"process": process.pid, "arguments": arguments}), encoding="utf-8")


def stop(output: Path) -> None:
    """Interrupt a run as Ctrl-C does; its finished steps are kept."""
    found = run_of(output)
    if found is not None and found.alive:
        os.kill(found.process, signal.SIGINT)


def run_of(output: Path) -> Run | None:
    """The run of an output that a page began; None without one."""
    try:
        record = json.loads(_record(output).read_text(encoding="utf-8"))
        text = _log(output).read_text(encoding="utf-8", errors="replace")[-_TAIL:]
        process, arguments = int(record["process"]), [str(one) for one in record["arguments"]]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    counts, lines = _COUNT.findall(text), text.strip().splitlines()
    done, total = map(int, counts[-1]) if counts else (0, 0)
    return Run(output, process, arguments, _alive(process, output), done, total, lines[-1] if lines else "")


def runs_in(folder: Path) -> list[Run]:
    """The runs of a folder, the latest first."""
    records = sorted(folder.glob("*.run"), key=lambda path: path.stat().st_mtime, reverse=True)
    found = (run_of(path.with_suffix("")) for path in records)
    return [run for run in found if run is not None]


def _alive(process: int, output: Path) -> bool:
    """Test whether a process lives and is this run's, as numbers of processes are used again."""
    with suppress(ChildProcessError):
        os.waitpid(process, os.WNOHANG)  # a child that ended
    try:
        os.kill(process, 0)
    except OSError:
        return False
    command = Path(f"/proc/{process}/cmdline")
    return not command.exists() or output.name.encode() in command.read_bytes()


def _parts(output: Path) -> Path:
    return output.with_name(f"{output.name}.parts")


def _record(output: Path) -> Path:
    return output.with_name(f"{output.name}.run")


def _log(output: Path) -> Path:
    return output.with_name(f"{output.name}.log")
