"""Gap fields of another dataset, as starts for the steps of a case."""

from pathlib import Path

import numpy as np
import xarray as xr

from contact_study.problem.case import Case
from contact_study.problem.errors import InputError


def check_predictor(path: Path) -> None:
    """Make sure that a dataset can serve as predictor.

    Raises
    ------
    InputError
        If it cannot be read or holds no gap fields.
    """
    if not path.is_file():
        raise InputError(f"--predictor: {path} does not exist")
    try:
        with xr.open_dataset(path) as dataset:
            if "gap" not in dataset or dataset["gap"].dims[-2:] != ("y", "x"):
                raise InputError(f"--predictor: {path} holds no gap fields; write it with output.fields = true")
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"--predictor: {path} is no readable dataset") from None


class GapFields:
    """Gap field (y, x) of each path point of one case, or None where the dataset has no such converged state.

    Parameters
    ----------
    path : pathlib.Path
        Dataset of the continuum.
    case : Case
        The case to be started; matched by its sweep coordinates and prescribed values.
    """

    def __init__(self, path: Path, case: Case):
        self._path = path
        self._case = case

    def __call__(self, number: int) -> np.ndarray | None:
        wanted, branch = self._case.path[number]
        with xr.open_dataset(self._path, decode_timedelta=False) as dataset:
            for name, value in self._case.coordinates.items():
                if name in dataset.dims:
                    if value not in dataset[name].values:
                        return None
                    dataset = dataset.sel({name: value})
            applied = dataset[f"applied_{self._case.loading.control}"].values
            # The same study file gives the same floats; 1e-9 forgives a value written in another unit.
            same = np.isclose(applied, wanted, rtol=1e-9, atol=0.0) & (
                dataset["branch"].values == (branch == "unloading")
            )
            usable = same & (dataset["converged"].values == 1) & (dataset["detached"].values != 1)
            if not usable.any():
                return None
            # A path may visit one pressure twice: the visit nearest in order is the one meant.
            visits = np.flatnonzero(usable)
            return dataset["gap"].isel(step=int(visits[np.argmin(np.abs(visits - number))])).values
