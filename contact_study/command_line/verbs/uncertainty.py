"""Intervals and shares of variance from the draws of a study."""

import argparse
import sys
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from contact_study.command_line.frame import epilog, print_table
from contact_study.inputs.errors import DONE, InputError

if TYPE_CHECKING:
    import xarray as xr

USAGE = "DRAWS.nc [--anchors SIM.nc | --gradient] [-o OUT.nc] [--figure FILE]"
END = epilog(
    "bem-adhesion run study.toml --model theory -o theory.nc",
    "bem-adhesion run study.toml -o bem.nc --uncertainty.draws 16",
    "bem-adhesion uncertainty theory.nc --anchors bem.nc -o answer.nc --figure tornado.png",
    "bem-adhesion uncertainty theory.nc --gradient",
)


def add(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, metavar="DRAWS.nc", help="dataset of a study with [uncertainty]")
    words = "simulation of some of the draws, to correct the answers"
    parser.add_argument("--anchors", type=Path, metavar="FILE.nc", help=words)
    words = "correct by one simulation, run now, and its derivatives"
    parser.add_argument("--gradient", action="store_true", help=words)
    parser.add_argument("-o", "--output", metavar="OUT.nc", help="dataset to write")
    parser.add_argument("--figure", metavar="FILE", help="tornado figure to write")
    parser.add_argument("--overwrite", action="store_true", help="replace existing files")


def run(given: argparse.Namespace) -> int:
    from contact_study import uncertainty
    from contact_study.campaign.store.files import check_inputs_kept, named_file, writable_output, write_aside
    from contact_study.command_line.selection import opened
    from contact_study.plots.style import RESOLUTION, format_of

    output, figure = (None if name is None else named_file(name) for name in (given.output, given.figure))
    if output is not None and output.suffix != ".nc":
        raise InputError(f"-o {output}: expected a name that ends in .nc")
    kind = None if figure is None else format_of(figure, "--figure")
    inputs = [given.file, *([given.anchors] if given.anchors else [])]
    for path in filter(None, (output, figure)):
        check_inputs_kept(path, inputs)
        if path.exists() and not given.overwrite:
            raise InputError(f"{path} exists; use --overwrite to replace it")
        writable_output(path)
    if given.gradient and given.anchors:
        raise InputError("--anchors and --gradient exclude each other")
    datasets = [opened(path).load() for path in inputs]
    try:
        if given.gradient:
            datasets.append(_central_simulation(datasets[0], given.file.parent))
        found = uncertainty(*datasets)
    except InputError as error:
        raise InputError(f"{given.file}: {error}") from None
    found.attrs["history"] = f"{datetime.now(UTC).isoformat(timespec='seconds')}: {given.words}"
    if output is not None:
        write_aside(output, found.to_netcdf)
    if figure is not None:
        from contact_study.plots import tornado

        drawn = tornado(found)
        write_aside(figure, lambda partial: drawn.savefig(partial, dpi=RESOLUTION, format=kind))
    print_table(("answer", "5 %", "median", "95 %", "shares of the variance"), [*_rows(found)])
    for path in filter(None, (output, figure)):
        print(path)
    if not any(name.endswith("_share") and found[name].notnull().any() for name in found):
        print(f"{given.command}: no shares: too few draws, or keys are correlated", file=sys.stderr)
    return DONE


def _central_simulation(dataset: "xr.Dataset", directory: Path) -> "xr.Dataset":
    """Simulate the central case of a dataset's study, with its derivatives."""
    import importlib
    import tomllib

    from contact_study.study.study import make_study

    if dataset.attrs.get("model") == "atomistic":
        raise InputError("--gradient: is one of boundary elements, which draws of atoms do not have; use --anchors")
    study = make_study(tomllib.loads(str(dataset.attrs["study_toml"])), directory)
    found: xr.Dataset = importlib.import_module("bem_adhesion.study.sensitivity").sensitivity(study)
    return found


def _rows(found: "xr.Dataset") -> Iterable[tuple[str, ...]]:
    """A row for each answer, load and theory."""
    from contact_study.results.uncertainty import ANSWERS

    for name in [name for name in ANSWERS if name in found]:
        dims = [dim for dim in found[name].dims if dim != "quantile"]
        for place in _places(found, dims):
            values = found[name].isel(place).values
            share = found[f"{name}_share"].isel(place)
            where = ", ".join(_where(found, dim, place[dim]) for dim in dims)
            order = [at for at in share.values.argsort()[::-1] if share.values[at] >= 0.01]
            words = (f"{share['parameter'].values[at]!s} {100 * share.values[at]:.0f} %" for at in order)
            units = found[name].attrs["units"]
            title = f"{name}{'' if units == '1' else f' ({units})'}{f', {where}' if where else ''}"
            yield title, *(f"{value:.3g}" for value in values), ", ".join(words) or "–"


def _places(found: "xr.Dataset", dims: list[str]) -> Iterable[dict[str, int]]:
    import itertools

    for indices in itertools.product(*(range(found.sizes[dim]) for dim in dims)):
        yield dict(zip(dims, indices, strict=True))


def _where(found: "xr.Dataset", dim: str, at: int) -> str:
    from contact_study.inputs.units import length, stress

    if dim != "step":
        return str(found[dim].values[at]) if found[dim].dtype.kind == "U" else f"{dim} {found[dim].values[at]}"
    if "applied_pressure" in found.coords and found["applied_pressure"].ndim == 1:
        return stress(float(found["applied_pressure"][at]))
    if "applied_gap" in found.coords and found["applied_gap"].ndim == 1:
        return length(float(found["applied_gap"][at]))
    return f"step {at}"
