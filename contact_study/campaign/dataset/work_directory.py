"""The work directory of a run, ``bem.nc.parts``, and the lock that excludes a second run.

It holds the record of the run and one file per case, named after what decides its numbers. The finished dataset moves
to the output by rename, then its restart states; the directory goes, the manifest last. The next run finishes a kill.
"""

import json
import shutil
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from filelock import FileLock, Timeout

from contact_study.campaign.dataset import file
from contact_study.campaign.dataset.file import States, attributes_of, history_of, states_file
from contact_study.campaign.engines import CampaignError
from contact_study.campaign.store.case_file import CaseFile
from contact_study.campaign.store.files import is_dataset, is_zarr, mark_of, write_aside
from contact_study.inputs.errors import InputError
from contact_study.inputs.files import has_locks

_REPLACES, _STORAGE = "replaces", "storage"
_STORAGE_VERSION = 2  # one file per case; version 1 had a folder per case with one file per step


class WorkDirectory:
    """The work directory of the run that writes a dataset to ``output``."""

    def __init__(self, output: Path):
        self.output = output
        self.folder = output.with_name(output.name + ".parts")
        self._lock = FileLock(str(self.folder) + ".lock")
        self._manifest = self.folder / "manifest.json"
        self._dataset = self.folder / f"dataset{output.suffix}"
        self._states = self.folder / "restart"
        self._earlier = self.folder / f"earlier-{output.name}"
        self._output_mark: tuple[int, ...] | None = None
        self._overwrites = self._is_claimed = False

    def case_file(self, name: str) -> Path:
        return self.folder / f"{name}.case"

    def open(self, *, resume: bool, overwrite: bool) -> dict[str, Any] | None:
        """Lock the directory; clear it (overwrite) or keep its steps (resume); returns what :meth:`claim` recorded."""
        self._acquire_lock()
        if not self.output.exists() and is_dataset(self._earlier):  # a kill between two renames
            self._earlier.rename(self.output)
        self._publish_states()
        self._output_mark, self._overwrites = mark_of(self.output), overwrite
        states = states_file(self.output)
        if not overwrite and states.exists() and States(states).history is None:
            raise InputError(f"{states}: exists and holds no restart states; move it, or choose another output")
        if overwrite or (self._manifest.exists() and not resume and not self._holds_cases()):
            self.remove()
        if not self._manifest.exists() and not self._holds_cases():
            return None
        if not resume:
            raise InputError(
                f"{self.folder} holds the steps of an unfinished run; continue it with --resume "
                "or drop it with --overwrite"
            )
        claimed = self.record()
        if claimed.get(_STORAGE) != _STORAGE_VERSION:
            if any(self.folder.glob("case-*")):
                raise InputError(
                    f"{self.folder}: holds steps in the format of an earlier version; finish them with that version, "
                    "or drop them with --overwrite"
                )
            raise InputError(
                f"{self.folder}: has lost the record of its run (manifest.json); drop them with --overwrite"
            )
        return claimed

    def _acquire_lock(self) -> None:
        fault = "the file system of its folder has no locks (flock), which exclude a second run; choose an output "
        fault += "elsewhere, or have it mounted with locks"
        if has_locks(self.folder.parent):
            with suppress(Timeout):
                self._lock.acquire(blocking=False)
                return
            fault = "another run is writing it; wait for its end or choose another output"
        raise InputError(f"{self.output}: {fault}")

    def _holds_cases(self) -> bool:
        return any(self.folder.glob("*case*"))

    def record(self) -> dict[str, Any]:
        """Read what :meth:`claim` wrote; empty if it is missing or unreadable."""
        with suppress(OSError, ValueError, TypeError):
            return dict(json.loads(self._manifest.read_text(encoding="utf-8")))
        return {}

    def replaces(self) -> str | None:
        """History of the dataset that the steps replace; None if they replace none."""
        return self.record().get(_REPLACES)

    def claim(self, attributes: Mapping[str, Any], replaces: str | None = None) -> None:
        """Record the run that the steps belong to, and the history of the dataset that they replace."""
        self._is_claimed = True
        self.folder.mkdir(parents=True, exist_ok=True)
        text = json.dumps({**attributes, _REPLACES: replaces, _STORAGE: _STORAGE_VERSION}, indent=1)
        write_aside(self._manifest, lambda partial: partial.write_text(text, encoding="utf-8"))

    def close(self) -> None:
        if self._lock.is_locked:
            Path(self._lock.lock_file).unlink(missing_ok=True)
            self._lock.release()

    def check_output(self) -> None:
        """Raise CampaignError if a file appeared at the output since the run began, or changed there."""
        if not self._overwrites and mark_of(self.output) != self._output_mark:
            raise CampaignError(
                f"{self.output} has appeared or changed while this ran; move it away and run this again (a model with "
                "--resume)"
            )

    def write(self, groups: Mapping[str, xr.Dataset], states: Iterable[Mapping[str, np.ndarray]] | None) -> None:
        """Write the dataset, and the state after the last point of each case if given, inside the directory."""
        file.write_dataset(self._dataset, groups)
        self._states.unlink(missing_ok=True)
        if states is not None:
            file.write_states(self._states, str(groups[""].attrs["history"]), states)

    def publish(self) -> None:
        """Rename what is written to the output, and remove the directory."""
        self.check_output()
        if self.output.is_dir():
            if not is_zarr(self.output) or not is_dataset(self.output):
                raise IsADirectoryError(f"{self.output}: is a folder, and no dataset that may be replaced")
            self.output.rename(self._earlier)  # no rename replaces a folder
        self._dataset.replace(self.output)
        old = states_file(self.output)
        if not self._states.exists() and States(old).history is not None:  # of the replaced dataset
            old.unlink()
        self._publish_states()
        self.remove()

    def _publish_states(self) -> None:
        """Move the restart states to their dataset, once it is at the output."""
        history = States(self._states).history
        if history is not None and history == history_of(self.output):
            self._states.replace(states_file(self.output))

    def clear_leftovers(self) -> bool:
        """Finish the work of a run killed after it had renamed its dataset; returns whether nothing is left."""
        if not self.folder.exists() and not Path(self._lock.lock_file).exists():
            return True
        try:
            self._acquire_lock()
        except (InputError, OSError):
            return False
        self._publish_states()
        written = attributes_of(self.output) or {}
        own = (_REPLACES, _STORAGE, "git_commit")
        claimed = {name: value for name, value in self.record().items() if name not in own}
        if (claimed and claimed.items() <= written.items()) or not any(self.folder.glob("*")):
            self.remove()
        self.close()
        return not self.folder.exists()

    def remove(self) -> None:
        """Remove the directory; a kill in between leaves the manifest."""
        for path in self.folder.iterdir() if self.folder.is_dir() else ():
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            elif path != self._manifest:
                path.unlink(missing_ok=True)
        shutil.rmtree(self.folder, ignore_errors=True)

    def drop_if_empty(self) -> None:
        """Remove the directory if this run has claimed it and no case in it has a step."""
        if self._is_claimed and not any(CaseFile(path).has_steps for path in self.folder.glob("*.case")):
            self.remove()
