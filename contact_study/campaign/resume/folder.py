"""The folder of a running campaign, and the lock that keeps a second run away from it.

``bem.nc.parts`` holds what the run is and one folder per case, named after what decides its numbers. The dataset
appears, by rename, when all is done; then the folder goes.
"""

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr
from filelock import FileLock, Timeout

from contact_study.campaign.dataset.file import write_dataset
from contact_study.campaign.dataset.formats import put
from contact_study.campaign.files import load_json, save_json
from contact_study.campaign.steps import drop_damaged
from contact_study.problem.errors import InputError

_REPLACES = "replaces"


class Parts:
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

    def open(self, *, resume: bool, overwrite: bool) -> dict[str, Any] | None:
        """Take the folder for this campaign, clearing what is there (overwrite) or leaving it (resume).

        Returns
        -------
        dict or None
            What the steps that are there belong to, as :meth:`claim` wrote it; empty if nothing readable says so, None
            if there are no steps.

        Raises
        ------
        InputError
            If another run is writing, or steps are there that may be neither used nor cleared.
        """
        try:
            self._lock.acquire(blocking=False)
        except Timeout:
            raise InputError(
                f"{self.output}: another run is writing it; wait for its end or choose another output"
            ) from None
        if self.folder.exists() and overwrite:
            shutil.rmtree(self.folder)
        if not self._manifest.exists() and not any(self.folder.glob("case-*")):
            return None
        if not resume:
            raise InputError(
                f"{self.folder} holds the steps of an unfinished run; continue it with --resume "
                "or drop it with --overwrite"
            )
        return self._claimed()

    @property
    def _manifest(self) -> Path:
        return self.folder / "manifest.json"

    def _claimed(self) -> dict[str, Any]:
        """What :meth:`claim` wrote; empty if nothing readable says it."""
        try:
            return dict(load_json(self._manifest))
        except (OSError, ValueError, TypeError):
            return {}

    def belong_to(self, attributes: Mapping[str, Any]) -> bool:
        """Whether the folder, if there is one, holds steps of the run with these attributes."""
        there = self._claimed()
        return all(there.get(name) == value for name, value in attributes.items())

    def replaces(self) -> str | None:
        """What the steps are to replace, as :meth:`claim` was told; None for nothing."""
        return self._claimed().get(_REPLACES)

    def claim(self, attributes: Mapping[str, Any], replaces: str | None = None) -> None:
        """Write what the steps belong to, and the history of the dataset at the output that they are to replace."""
        self.folder.mkdir(parents=True, exist_ok=True)
        save_json(self._manifest, {**attributes, _REPLACES: replaces})

    def close(self) -> None:
        """Let other runs write."""
        if self._lock.is_locked:
            Path(self._lock.lock_file).unlink(missing_ok=True)
            self._lock.release()

    def finish(self, groups: Mapping[str, xr.Dataset]) -> None:
        """Write the dataset, inside the folder first, then rename it to the output and drop the folder."""
        dataset = self.folder / f"dataset{self.output.suffix}"
        write_dataset(dataset, groups)
        put(dataset, self.output)
        self.remove()

    def remove(self) -> None:
        """Drop the folder, whose dataset is written."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def case_folder(self, name: str) -> Path:
        """Folder of one case."""
        return self.folder / f"case-{name}"

    def drop_damaged(self) -> int:
        """Delete the files of cases that cannot be read; returns how many."""
        return sum(drop_damaged(folder) for folder in self.folder.glob("case-*"))
