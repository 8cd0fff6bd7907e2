"""Assemble the groups of one dataset from the values of every case."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.dataset.file import StoredCase
from contact_study.campaign.progress import Progress
from contact_study.campaign.store.case_file import CaseFile
from contact_study.numerics.distributions import Bins, redistributed
from contact_study.results import schema
from contact_study.results.observables import FIXED_COORDINATES
from contact_study.results.path_results import PATH_RESULTS, path_results, series_of, with_forces
from contact_study.results.percolation import percolation_threshold
from contact_study.results.schema import COORDINATES, LABELS, TRAJECTORY, quantity_of, variable_of
from contact_study.study.case import Case
from contact_study.study.study import Study
from contact_study.study.sweep import SweptKey

CaseSource = CaseFile | StoredCase  # a finished case: its file, or its place in a dataset

# Position in the sweep, constants, and quantities of every step.
_Case = tuple[tuple[int, ...], dict[str, Any], list[dict[str, Any]]]


def assemble_cases(
    study: Study, bins: Bins, sources: Sequence[CaseSource], progress: Progress
) -> tuple[dict[str, xr.Dataset], list[str]]:
    """Assemble the groups of a study's dataset by name, "" for the root, from its cases in order; and warnings."""
    rebinned: list[int] = []
    coordinates = {"pressure_bin": bins.pressure, "gap_bin": bins.gap, **FIXED_COORDINATES}
    pairs = progress.through(list(zip(study.cases, sources, strict=True)), "cases written to the dataset")
    longest = max(len(case.path) for case in study.cases)
    groups = assemble(study.sweep, longest, (_read(*pair, bins, rebinned) for pair in pairs), coordinates)
    words = f"the distributions of {len(rebinned)} steps finished before were on other bins and are spread over this "
    words += "study's, within one bin; --overwrite computes them again"
    return groups, [words] if rebinned else []


def last_states(study: Study, sources: Sequence[CaseSource]) -> Iterator[dict[str, np.ndarray]] | None:
    """Restart state after the last step of every case, empty where it is missing; None if the study keeps none."""
    if not study.cases[0].output.restart:
        return None
    return (source.state(len(case.path) - 1) for case, source in zip(study.cases, sources, strict=True))


def _read(case: Case, source: CaseSource, bins: Bins, rebinned: list[int]) -> _Case:
    """A finished case on the study's bins; the numbers of its steps with others to ``rebinned``."""
    steps = []
    for number in range(len(case.path)):
        values, own = source.step(number)
        if own is not bins and not own.equal(bins):
            rebinned.append(number)
            before, after = own.edges_of, bins.edges_of
            for key in values:
                if (name := quantity_of(key)[1]) in before:
                    values[key] = redistributed(values[key], before[name], after[name])
        steps.append(values)
    constants = source.constants
    if "mean_separation" in steps[0]:  # a simulation's; a theory gives its path results itself
        control = case.loading.control
        # A longer path may have lost a path result of the shorter one.
        for name in [name for name in constants if name.removesuffix(schema.RESOLUTION_ERROR) in PATH_RESULTS]:
            del constants[name]
        found = path_results(series_of(steps, control, case.machine_compliance), control)
        constants |= with_forces(found, case.nominal_area) | percolation_threshold(steps)
    return case.index, constants, steps


def assemble(
    sweep: Mapping[str, SweptKey], steps: int, cases: Iterable[_Case], coordinates: Mapping[str, np.ndarray]
) -> dict[str, xr.Dataset]:
    """Assemble datasets by group from the steps of every case; shorter arrays are padded at their ends."""
    lengths = tuple(len(swept.values) for swept in sweep.values())
    arrays: dict[str, np.ndarray] = {}
    for index, constants, path in cases:
        for name, value in constants.items():
            _insert(arrays, f"{schema.REALISED}{name}" if name in sweep else name, {index: value}, lengths)
        for name in dict.fromkeys(name for values in path for name in values):
            along_path = {(*index, number): values[name] for number, values in enumerate(path) if name in values}
            _insert(arrays, name, along_path, (*lengths, steps))
    groups: dict[str, dict[str, dict[tuple[str, ...], np.ndarray]]] = {"": {}}
    # A group inherits dimensions and labels from the groups above it.
    along: dict[str, dict[str, None]] = {dim: {} for dim in LABELS}
    for key, array in arrays.items():
        labels, name = quantity_of(key)
        group = TRAJECTORY if labels == (TRAJECTORY,) else schema.LABELLED_GROUPS[len(labels)]
        labels = () if group == TRAJECTORY else labels
        for dim, label in zip(LABELS, labels, strict=False):
            along[dim][label] = None
        groups.setdefault(group, {}).setdefault(name, {})[labels] = array
    known = {**coordinates, **{dim: np.array([*labels]) for dim, labels in along.items()}}
    known["step"] = np.arange(steps, dtype=np.int32)
    root = groups[""]
    on_step = {name: root[name] for name in root if name in COORDINATES and variable_of(name).dims == ("step",)}
    return {
        group: _dataset({**on_step, **content}, sweep, known, (schema.FRAME,) if group == TRAJECTORY else ())
        for group, content in groups.items()
    }


def _insert(
    arrays: dict[str, np.ndarray], name: str, values: Mapping[tuple[int, ...], Any], lengths: tuple[int, ...]
) -> None:
    """Insert values of a quantity into its array by their places along the first axes; create or enlarge it."""
    variable = variable_of(quantity_of(name)[1])
    some = {place: np.asarray(value) for place, value in values.items()}
    first = next(iter(some.values()))
    # Fields may have single precision.
    dtype = first.dtype if first.dtype == np.float32 and variable.dtype == np.float64 else variable.dtype
    before = [arrays[name]] if name in arrays else []
    shapes = {value.shape for value in some.values()} | {array.shape[len(lengths) :] for array in before}
    shape = tuple(map(max, zip(*shapes, strict=True)))
    if [(*lengths, *shape)] != [array.shape for array in before]:
        arrays[name] = np.full((*lengths, *shape), variable.empty, dtype=dtype)
        for array in before:
            arrays[name][tuple(map(slice, array.shape))] = array
    if not shape:
        everywhere = tuple(zip(*some, strict=True)) if lengths else ()
        arrays[name][everywhere] = [value.item() for value in some.values()] if lengths else first.item()
        return
    for place, value in some.items():
        arrays[name][place][tuple(map(slice, value.shape))] = value


def _dataset(
    content: Mapping[str, Mapping[tuple[str, ...], np.ndarray]],
    sweep: Mapping[str, SweptKey],
    coordinates: Mapping[str, np.ndarray],
    beyond: tuple[str, ...],
) -> xr.Dataset:
    """Make one group; quantities that are no coordinates have the dimensions ``beyond`` after their own."""
    data: dict[str, xr.Variable] = {}
    coords: dict[str, xr.Variable] = {}
    for name, arrays in content.items():
        own = variable_of(name).dims
        labels, array = LABELS[: len(next(iter(arrays)))], next(iter(arrays.values()))
        if labels:  # side by side, after the swept dimensions
            whole: dict[str, np.ndarray] = {}
            places = {
                tuple(int(np.argmax(coordinates[dim] == label)) for dim, label in zip(labels, place, strict=True)): part
                for place, part in arrays.items()
            }
            _insert(whole, name, places, tuple(len(coordinates[dim]) for dim in labels))
            array = np.moveaxis(whole[name], range(len(labels)), range(len(sweep), len(sweep) + len(labels)))
        dims = (*sweep, *labels, *own, *(() if name in COORDINATES else beyond))
        if name in COORDINATES or own[:1] != ("step",):
            for axis in reversed(range(len(sweep))):  # along which it may not change
                first = np.take(array, [0], axis=axis)
                same = array == first
                if array.dtype.kind == "f":
                    same |= np.isnan(array) & np.isnan(first)
                if np.all(same):
                    array, dims = np.take(array, 0, axis=axis), (*dims[:axis], *dims[axis + 1 :])
        (coords if name in COORDINATES else data)[name] = xr.Variable(dims, array, _attributes(name))
    # A coordinate that changes over the sweep cannot index its own dimension, which is then a plain index.
    indices = {name: f"{name}_index" for name, along in coords.items() if name in along.dims and along.ndim > 1}
    for variable in [*data.values(), *coords.values()]:
        variable.dims = tuple(indices.get(str(dim), dim) for dim in variable.dims)
    used = {dim for variable in [*data.values(), *coords.values()] for dim in variable.dims}
    for name, values in coordinates.items():
        if name in used and name not in coords:
            coords[name] = xr.Variable((name,), values, _attributes(name))
    for name, swept in sweep.items():
        attributes = {"units": swept.units, "long_name": swept.description}
        coords[name] = xr.Variable((name,), np.asarray(swept.values), attributes)
    return xr.Dataset(data, coords)


def _attributes(name: str) -> dict[str, Any]:
    variable = variable_of(name)
    return {"units": variable.units, "long_name": variable.long_name, **variable.attrs}
