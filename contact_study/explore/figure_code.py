"""The view of a page as lines of Python, which also draw the files that the page exports."""

import io
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from contact_study.campaign.store.files import engine_of
from contact_study.report.read.lazy import Model
from contact_study.results.schema import LABELS

_MAPS = {"height": "height_map", "gap": "gap_map", "pressure": "pressure_map"}
Ends = tuple[tuple[float, float], tuple[float, float]]


def figure_code(model: Model, chosen: Mapping[str, Any], step: int, field: str | None, ends: Ends | None = None) -> str:
    """Lines of Python that draw a state of a model with its curves, by :mod:`contact_study.plots`.

    ``field`` is that of the map, None for a model without fields; ``ends`` (y, x) are those of the section (m).
    """
    engine = ', engine="zarr"' if engine_of(model.path) == "zarr" else ""
    at = {name: getattr(value, "item", lambda value=value: value)() for name, value in chosen.items()}
    if LABELS[0] in model.root.dims:
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


def drawn(code: str, model: Model, kind: str) -> io.BytesIO:
    """The figure that :func:`figure_code` draws of a model, as ``"png"`` or ``"svg"``."""
    names: dict[str, Any] = {"xr": SimpleNamespace(open_dataset=lambda *_, **__: model.root)}  # is open already
    exec("\n".join(code.splitlines()[1:-1]), names)
    stream = io.BytesIO()
    names["figure"].savefig(stream, format=kind, dpi=200)
    stream.seek(0)
    return stream


def datasets_in(folder: Path) -> list[Path]:
    """Datasets of a folder and those that runs in it will make, at most two levels down."""
    found = {path for level in ("", "*/", "*/*/") for end in ("nc", "zarr") for path in folder.glob(f"{level}*.{end}")}
    found |= {path.with_suffix("") for level in ("", "*/", "*/*/") for path in folder.glob(f"{level}*.parts")}
    return sorted(path for path in found if not path.name.startswith("."))
