"""The view of a page as lines of Python, which also draw the files that the page exports."""

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from contact_study.campaign.store.files import engine_of
from contact_study.explore.selection import LoadPath, Model
from contact_study.results.schema import LABELS

_MAPS = {"height": "height_map", "gap": "gap_map", "pressure": "pressure_map"}
_COLUMNS = ("mean_pressure", "relative_contact_area", "mean_gap", "displacement", "total_force")
Ends = tuple[tuple[float, float], tuple[float, float]]


def figure_code(model: Model, chosen: Mapping[str, Any], step: int, field: str | None, ends: Ends | None = None) -> str:
    """Lines of Python that draw a state of a model with its curves, by :mod:`contact_study.plots`.

    ``field`` is that of the map, None for a model without fields; ``ends`` (y, x) are those of the section (m).
    """
    engine = ', engine="zarr"' if engine_of(model.path) == "zarr" else ""
    at = {name: getattr(value, "item", lambda value=value: value)() for name, value in chosen.items()}
    if LABELS[0] not in model.dataset.dims and model.entry.file == "theory":
        at[LABELS[0]] = model.name.partition(":")[0]
    lines = [
        "import xarray as xr",
        "from matplotlib.figure import Figure",
        "from contact_study import plots",
        f"case = xr.open_dataset({str(model.path.absolute())!r}{engine}){f'.sel({at!r})' if at else ''}",
        f"state = case.isel(step={step})",
    ]
    if field is None:
        lines += ['figure = Figure(figsize=(8, 3), layout="constrained")', "one, two = figure.subplots(1, 2)"]
        lines += ["plots.contact_area(case, one)", "plots.stress_distribution(state, two)"]
    else:
        lines += ['figure = Figure(figsize=(8, 6), layout="constrained")']
        lines += ["(one, two), (three, four) = figure.subplots(2, 2)"]
        lines += [f"plots.{_MAPS.get(field, 'contact_map')}(state, one)", "plots.contact_area(case, two)"]
        lines += [f"plots.section(state, axes=three{f', ends={ends!r}' if ends else ''})"]
        lines += ["plots.stress_distribution(state, four)"]
    return "\n".join([*lines, 'figure.savefig("view.png", dpi=200)', ""])


def drawn(code: str, kind: str) -> io.BytesIO:
    """The figure that :func:`figure_code` draws, as ``"png"`` or ``"svg"``."""
    names: dict[str, Any] = {}
    exec("\n".join(code.splitlines()[:-1]), names)
    stream = io.BytesIO()
    names["figure"].savefig(stream, format=kind, dpi=200)
    stream.seek(0)
    return stream


def table(cases: Mapping[str, xr.Dataset], paths: Mapping[str, LoadPath]) -> io.StringIO:
    """The states of the cases of models along their paths as a table (SI) with commas."""
    stream = io.StringIO()
    writer = csv.writer(stream)
    known = [name for name in _COLUMNS if any(name in case for case in cases.values())]
    writer.writerow(["model", "step", "branch", "prescribed", *known])
    for name, case in cases.items():
        path = paths[name]
        for place, step in enumerate(path.steps):
            values = [float(case[one][step]) if one in case else "" for one in known]
            way = "unloading" if path.unloading[place] else "loading"
            writer.writerow([name, int(step), way, path.prescribed[place], *values])
    stream.seek(0)
    return stream


def datasets_in(folder: Path) -> list[Path]:
    """Datasets of a folder and those that runs in it will make, at most two levels down."""
    found = {path for level in ("", "*/", "*/*/") for path in folder.glob(f"{level}*.nc")}
    found |= {path for level in ("", "*/", "*/*/") for path in folder.glob(f"{level}*.zarr")}
    found |= {path.with_suffix("") for level in ("", "*/", "*/*/") for path in folder.glob(f"{level}*.parts")}
    return sorted(path for path in found if not path.name.startswith("."))
