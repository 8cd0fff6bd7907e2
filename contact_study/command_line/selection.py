"""Parts of a command's options: cases by ``--case KEY=VALUE``, a load step by ``--step``, other options KEY=VALUE."""

import argparse
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_study.inputs.errors import InputError

if TYPE_CHECKING:
    import xarray as xr


def add_selection(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    words = "value of a swept key, or theory=NAME"
    parser.add_argument("--case", action="append", default=[], metavar="KEY=VALUE", help=words)
    parser.add_argument("--step", type=int, metavar="N", help="load step, from 0 on; -1 is the last")


def opened(path: Path) -> "xr.Dataset":
    """Open the dataset of a run; raises InputError if it is none."""
    import xarray as xr

    from contact_study.campaign.store.files import engine_of, readable, require_dataset

    require_dataset(path)
    with readable(path):
        dataset = xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False)
    if "step" not in dataset.dims:
        raise InputError(f"{path}: holds no load steps; give the dataset of a run")
    return dataset


def case_dims(dataset: "xr.Dataset") -> list[str]:
    """Return the dimensions that a case has a place on: swept keys and theories."""
    from contact_study.results.schema import COORDINATES

    dims = {str(dim) for name in dataset.data_vars for dim in dataset[name].dims if "step" in dataset[name].dims}
    swept = {dim for dim in dims if dim in dataset.coords and dim not in COORDINATES}
    return [dim for dim in map(str, dataset.dims) if dim in swept or (dim in dims and dim == "theory")]


def selected(dataset: "xr.Dataset", cases: Sequence[str], step: int | None) -> "xr.Dataset":
    """Return the cases, and the load step, that are asked for."""
    from contact_study.study.schema.keys import suggestion

    for part in [part for asked in cases for part in asked.split(",")]:
        key, _, value = (words.strip() for words in part.partition("="))
        dims = case_dims(dataset)
        if key not in dims:
            known = ", ".join(dims) or "one case only"
            raise InputError(f"--case {part}: no swept key{suggestion(key, dims)}; there is {known}")
        place = next((n for n, one in enumerate(dataset[key].values) if _same(one, value, dataset[key])), None)
        if place is None:
            raise InputError(f"--case {part}: the dataset has {key} {_values(dataset[key])}")
        dataset = dataset.isel({key: place})
    if step is not None:
        steps = dataset.sizes["step"]
        if not -steps <= step < steps:
            raise InputError(f"--step {step}: the path has load steps 0 to {steps - 1}")
        dataset = dataset.isel(step=step)
    return dataset


def one_case(dataset: "xr.Dataset", must_choose: Path | None = None) -> "tuple[xr.Dataset, list[str]]":
    """Return a single case, the last of several (not of a file ``must_choose``), and the choice in words."""
    chosen = []
    for dim in case_dims(dataset):
        values, several = _values(dataset[dim]), dataset.sizes[dim] > 1
        if several and must_choose is not None:
            raise InputError(f"{must_choose}: holds {dim} {values}; choose by --case {dim}=VALUE")
        place = 0 if dim == "theory" else dataset.sizes[dim] - 1
        if several and dim != "theory":
            chosen.append(f"{dim}={_values(dataset[dim][place:])} (of {values})")
        dataset = dataset.isel({dim: place})
    return dataset, chosen


def one_step(dataset: "xr.Dataset") -> "tuple[xr.Dataset, list[str]]":
    """Return the last load step in contact that is there, unless one is chosen, and the choice in words."""
    import numpy as np

    if "step" not in dataset.dims:
        return dataset, []
    # Fields have no finite value where a state is missing or has detached.
    name = next((name for name in ("gap", "atom_height") if name in dataset), "mean_pressure")
    steps = range(dataset.sizes["step"] - 1, -1, -1)
    last = next((n for n in steps if np.isfinite(dataset[name].isel(step=n)).any()), steps[0])
    return dataset.isel(step=last), [f"step {last} (of 0 to {steps[0]})"] if len(steps) > 1 else []


def pair(words: str, option: str) -> tuple[str, str | int]:
    """Part an option's ``KEY=VALUE``; the number of a curve is whole."""
    key, equals, value = words.partition("=")
    if not equals:
        raise InputError(f"{option} {words}: expected KEY=VALUE")
    return key.strip(), int(value) if key.strip() == "curve" and value.strip().isdigit() else value.strip()


def _same(value: Any, asked: str, coordinate: "xr.DataArray") -> bool:
    if isinstance(value, str):
        return value == asked
    from contact_study.inputs import units

    unit = str(coordinate.attrs.get("units", "1")).replace("J m-2", "J/m^2")
    try:
        number = float(asked)
    except ValueError:
        number = units.quantity(asked, unit, f"--case {coordinate.name}")
    return math.isclose(number, float(value), rel_tol=1e-6)


def _values(coordinate: "xr.DataArray") -> str:
    return ", ".join(one if isinstance(one, str) else f"{one:.6g}" for one in coordinate.values)
