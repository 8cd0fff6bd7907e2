"""The finished steps of a run that is under way, or was stopped, as the dataset that they would make."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from contact_study.campaign.dataset.assembly import assemble
from contact_study.campaign.dataset.work_directory import WorkDirectory
from contact_study.campaign.model import MODELS
from contact_study.campaign.record import Run
from contact_study.campaign.store.case_file import CaseFile
from contact_study.inputs.errors import InputError
from contact_study.results.observables import FIXED_COORDINATES
from contact_study.results.schema import variable_of

_FIELDS = ("gap", "pressure")


def read_unfinished(output: Path) -> xr.Dataset | None:
    """Return the root group of the steps that an unfinished run has on disk; None without a run or a step.

    Fields stay on disk until they are used. The run is not disturbed: nothing is locked and nothing written.
    """
    work = WorkDirectory(output)
    attributes = work.record()
    if not attributes:
        return None
    try:
        run = Run.read(attributes, output.parent, MODELS[str(attributes["model"])])
    except InputError as error:
        raise InputError(f"{work.folder}: {error}") from None
    files = [CaseFile(work.case_file(name)) for name in run.case_names]
    cases, study = list(zip(run.study.cases, files, strict=True)), run.study
    kept: dict[tuple[int, ...], CaseFile] = {}

    def values() -> Iterator[tuple[tuple[int, ...], dict[str, Any], list[dict[str, Any]]]]:
        for case, file in cases:
            numbers = [number for number in range(len(case.path)) if file.has_step(number)]
            steps: list[dict[str, Any]] = [{} for _ in range(numbers[-1] + 1)] if numbers else []
            for number in numbers:
                found = file.step(number)[0]
                if any(name in found for name in _FIELDS):
                    kept[*case.index, number] = file
                steps[number] = {name: value for name, value in found.items() if name not in _FIELDS}
            if steps and file.has_constants:
                yield case.index, file.constants, steps

    longest = max(len(case.path) for case in study.cases)
    known = {"pressure_bin": study.bins.pressure, "gap_bin": study.bins.gap, **FIXED_COORDINATES}
    if not any(file.has_steps for file in files):
        return None
    dataset = assemble(study.sweep, longest, values(), known)[""].assign_attrs(attributes)
    # Points are numbered where cells differ, as they do from cases that have not begun.
    plane = [axis if axis in dataset.dims else f"{axis}_index" for axis in "yx"]
    if kept and {*plane} <= set(dataset.dims):
        swept = (len(swept.values) for swept in study.sweep.values())
        shape = (*swept, longest, *(dataset.sizes[axis] for axis in plane))
        for name in _FIELDS:
            lazy = indexing.LazilyIndexedArray(_Field(name, shape, kept))
            attrs = {"units": variable_of(name).units, "long_name": variable_of(name).long_name}
            dataset[name] = xr.Variable((*study.sweep, "step", *plane), lazy, attrs)
    return dataset


class _Field(BackendArray):
    """A field over all states, of which each is read when it is used; NaN where there is none."""

    def __init__(self, name: str, shape: tuple[int, ...], files: dict[tuple[int, ...], CaseFile]):
        self.name, self.shape, self.files, self.dtype = name, shape, files, np.dtype(np.float64)

    def __getitem__(self, key: Any) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.BASIC, self._read)

    def _read(self, key: tuple[Any, ...]) -> np.ndarray:
        *states, y, x = key
        numbers = [range(size)[one] for size, one in zip(self.shape, states, strict=False)]
        several = [[one] if isinstance(one, int) else list(one) for one in numbers]
        found = np.full((*map(len, several), *self.shape[-2:]), np.nan)
        for at in np.ndindex(found.shape[:-2]):
            place = tuple(own[i] for own, i in zip(several, at, strict=True))
            if place in self.files:
                values = self.files[place].step(place[-1])[0].get(self.name)
                if values is not None:
                    found[at][tuple(map(slice, values.shape))] = values
        chosen = tuple(0 if isinstance(one, int) else slice(None) for one in numbers)
        return found[(*chosen, y, x)]
