"""The folder of a running campaign, and the lock that keeps a second run away from it.

``bem.nc.parts`` holds what the run is and one file per case, named after what decides its numbers. The dataset appears,
by rename, when all is done, then the states beside it; then the folder goes, what says whose it is last.
"""

import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from filelock import FileLock, Timeout

from contact_study.cache import has_locks
from contact_study.campaign.dataset.file import history_of, write_dataset
from contact_study.campaign.dataset.formats import mark_of, put, put_back
from contact_study.campaign.dataset.states import States, states_file, write_states
from contact_study.campaign.engines.base import CampaignError
from contact_study.campaign.store.case_file import CaseFile
from contact_study.campaign.store.files import load_json, save_json
from contact_study.errors import InputError

_REPLACES, _STORAGE = "replaces", "storage"
_KIND_OF_STORAGE = 2  # how steps are kept; 1 were folders of a file a step


class WorkDirectory:
    """The folder of a running campaign.

    Parameters
    ----------
    output : pathlib.Path
        The dataset it will become.
    """

    def __init__(self, output: Path):
        self.output = output
        self.folder = output.with_name(output.name + ".parts")
        self._lock = FileLock(str(self.folder) + ".lock")
        self._stood: tuple[int, ...] | None = None
        self._overwrites = self._is_ours = False

    def open(self, *, resume: bool, overwrite: bool) -> dict[str, Any] | None:
        """Take the folder for this campaign, clearing what is there (overwrite) or leaving it (resume).

        Returns
        -------
        dict or None
            What the steps that are there belong to, as :meth:`claim` wrote it; None if there are no steps.

        Raises
        ------
        InputError
            If another run is writing, or steps are there that may be neither used nor cleared.
        """
        self._take_lock()
        put_back(self._dataset, self.output)
        self._settle()
        self._stood, self._overwrites = mark_of(self.output), overwrite
        states = states_file(self.output)
        if not overwrite and states.exists() and States(states).history is None:
            raise InputError(f"{states}: exists and holds no states to go on from; move it, or choose another output")
        if overwrite:
            self.remove()
        if not self._manifest.exists() and not any(self.folder.glob("*case*")):
            return None
        if not resume:
            raise InputError(
                f"{self.folder} holds the steps of an unfinished run; continue it with --resume "
                "or drop it with --overwrite"
            )
        claimed = self._claimed()
        if claimed.get(_STORAGE) != _KIND_OF_STORAGE:
            if any(self.folder.glob("case-*")):
                fault = "holds steps as an earlier version kept them; finish them with that version, or"
            else:
                fault = "has lost what its steps belong to (manifest.json);"
            raise InputError(f"{self.folder}: {fault} drop them with --overwrite")
        return claimed

    def _take_lock(self) -> None:
        if not has_locks(self.folder.parent):
            raise InputError(
                f"{self.output}: the file system of its folder has no locks (flock), which keep a second run away; "
                "choose an output elsewhere, or have it mounted with locks"
            )
        try:
            self._lock.acquire(blocking=False)
        except Timeout:
            raise InputError(
                f"{self.output}: another run is writing it; wait for its end or choose another output"
            ) from None

    @property
    def _manifest(self) -> Path:
        return self.folder / "manifest.json"

    def _claimed(self) -> dict[str, Any]:
        """What :meth:`claim` wrote; empty if nothing readable says it."""
        try:
            return dict(load_json(self._manifest))
        except (OSError, ValueError, TypeError):
            return {}

    def replaces(self) -> str | None:
        """What the steps are to replace, as :meth:`claim` was told; None for nothing."""
        return self._claimed().get(_REPLACES)

    def claim(self, attributes: Mapping[str, Any], replaces: str | None = None) -> None:
        """Write what the steps belong to, and the history of the dataset at the output that they are to replace."""
        self._is_ours = True
        self.folder.mkdir(parents=True, exist_ok=True)
        save_json(self._manifest, {**attributes, _REPLACES: replaces, _STORAGE: _KIND_OF_STORAGE})

    def close(self) -> None:
        """Let other runs write."""
        if self._lock.is_locked:
            Path(self._lock.lock_file).unlink(missing_ok=True)
            self._lock.release()

    @property
    def _dataset(self) -> Path:
        return self.folder / f"dataset{self.output.suffix}"

    @property
    def _states(self) -> Path:
        return self.folder / "restart"

    def check_output(self) -> None:
        """Raise CampaignError if something else stands at the output than when the run began, and is not to be lost."""
        if not self._overwrites and mark_of(self.output) != self._stood:
            raise CampaignError(
                f"{self.output} has appeared or changed while this ran; move it away and run this again (a model with "
                "--resume)"
            )

    def write(self, groups: Mapping[str, xr.Dataset], states: Iterable[Mapping[str, np.ndarray]] | None) -> None:
        """Write the dataset and what stands beside it, inside the folder.

        Parameters
        ----------
        groups : mapping
            Groups of the dataset.
        states : iterable of mapping, or None
            State after the last point of each case, for the file beside it; None for no such file.
        """
        write_dataset(self._dataset, groups)
        self._states.unlink(missing_ok=True)
        if states is not None:
            write_states(self._states, str(groups[""].attrs["history"]), states)

    def publish(self) -> None:
        """Rename what is written to the output, and drop the folder.

        Raises
        ------
        CampaignError
            If something else stands at the output than when the run began.
        """
        self.check_output()
        put(self._dataset, self.output)
        there = states_file(self.output)
        if not self._states.exists() and States(there).history is not None:  # of the dataset that stood here before
            there.unlink()
        self._settle()
        self.remove()

    def _settle(self) -> None:
        """Put the states beside their dataset, if that has come to the output."""
        history = States(self._states).history
        if history is not None and history == history_of(self.output):
            self._states.replace(states_file(self.output))

    def tidy(self, attributes: Mapping[str, Any]) -> bool:
        """Finish what a run with these attributes has left that was killed after its dataset's rename.

        Returns
        -------
        bool
            Whether nothing is left: another run may be at work, or have left its steps.
        """
        if not self.folder.exists() and not Path(self._lock.lock_file).exists():
            return True
        try:
            self._take_lock()
        except (InputError, OSError):
            return False
        self._settle()
        there = self._claimed()
        if not any(self.folder.glob("*")) or all(there.get(name) == value for name, value in attributes.items()):
            self.remove()
        self.close()
        return not self.folder.exists()

    def remove(self) -> None:
        """Drop the folder, whose dataset is written, or which holds nothing; a kill leaves what says whose it is."""
        for path in self.folder.iterdir() if self.folder.is_dir() else ():
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            elif path != self._manifest:
                path.unlink(missing_ok=True)
        shutil.rmtree(self.folder, ignore_errors=True)

    def drop_if_empty(self) -> None:
        """Drop the folder, if this run has claimed it and no step of any case is in it."""
        if self._is_ours and not any(CaseFile(path).has_steps for path in self.folder.glob("*.case")):
            self.remove()

    def case_file(self, name: str) -> Path:
        """File of one case."""
        return self.folder / f"{name}.case"
