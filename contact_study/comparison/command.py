"""The command ``contact-compare``: datasets of the models in, their comparison out."""

import os
import shlex
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

import contact_study
from contact_study.campaign.command import DONE, NOT_CONVERGED, Parser, git_commit, guarded
from contact_study.campaign.schema import CONVENTIONS, SCHEMA_VERSION
from contact_study.campaign.storage import writable_output
from contact_study.comparison import bands, figures, plotted
from contact_study.comparison.captions import captions
from contact_study.comparison.cases import case_points, first_constant, select, sweep_points
from contact_study.comparison.datasets import Inputs, field_at, read_inputs
from contact_study.comparison.deviations import MISSING, compute_deviations
from contact_study.comparison.path_points import AVERAGED
from contact_study.comparison.regime import compute_regime
from contact_study.comparison.report import Figures, collected_warnings, render_report
from contact_study.comparison.tables import unconverged_steps
from contact_study.comparison.tree import comparison_tree
from contact_study.problem import units
from contact_study.problem.errors import InputError

COMMAND = "contact-compare"
FIGURE_FILES = {
    name: f"figure_{number}_{name}.png"
    for number, name in enumerate(("stress_distribution", "gap_distribution", "contact_area", "mean_gap", "gap_map"), 1)
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare datasets; returns the exit status.

    0: done; 1: wrong input, nothing is written; 2: done, but some step of the inputs did not converge.
    """
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    return guarded(COMMAND, lambda: _main(arguments), interrupted="nothing was written")


def _main(arguments: Sequence[str]) -> int:
    given = _parser().parse_args(arguments)
    planned = [given.output, *([given.report] if given.report else [])]
    if given.figures:
        planned += [given.figures / name for name in FIGURE_FILES.values()]
    _check_outputs(planned, given.datasets, overwrite=given.overwrite)
    wanted = (
        units.quantity(given.reference_pressure, "Pa", "--reference-pressure") if given.reference_pressure else None
    )
    inputs = read_inputs(given.datasets)
    if wanted is not None and inputs.control != "pressure":
        raise InputError("--reference-pressure: these studies prescribe the gap; leave it out")
    for note in inputs.notes:
        print(f"{COMMAND}: warning: {note}", file=sys.stderr)
    deviations = compute_deviations(inputs.models, inputs.control)
    if (deviations["state"] == MISSING).all():
        raise InputError("these datasets have no point of their loading paths in common; run the same study")
    regime = compute_regime(inputs)
    attrs = _attributes(inputs, given.output, arguments)
    drawn = _draw(inputs, wanted) if given.figures or given.report else Figures({}, {})
    tree = comparison_tree(inputs, deviations, regime, attrs)
    outputs: dict[Path, Callable[[Path], Any]] = {
        given.output: lambda path: tree.to_netcdf(path, engine="netcdf4", write_inherited_coords=True)
    }
    if given.figures:
        outputs |= {given.figures / FIGURE_FILES[name]: _writer(image) for name, image in drawn.images.items()}
    if given.report:
        page = render_report(inputs, deviations, regime, drawn, {**attrs, "file": given.output.name})
        outputs[given.report] = _writer(page.encode())
    _write(outputs)
    print(*outputs, sep="\n")
    return _status(inputs)


def _parser() -> Parser:
    parser = Parser(
        prog=COMMAND,
        description="Compare datasets of bem-adhesion, md-reference and persson-theory: deviations, figures, report.",
        epilog="Exit status: 0 done, 1 wrong input (nothing is written), 2 done, but some step of the inputs did not "
        "converge.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "datasets", type=Path, nargs="+", metavar="MODEL.nc", help="datasets of two or three models, in any order"
    )
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.nc", help="dataset to write")
    parser.add_argument("--figures", type=Path, metavar="FOLDER", help="folder for the figures (PNG)")
    parser.add_argument("--report", type=Path, metavar="REPORT.html", help="report to write, one file with all in it")
    parser.add_argument("--overwrite", action="store_true", help="replace existing files")
    parser.add_argument(
        "--reference-pressure",
        metavar="P",
        help='pressure at which the distributions of the whole sweep are shown, such as "1 GPa"; the nearest one '
        "of the path is taken (default: p/E* = 0.00832 where the path has it, else its middle)",
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {contact_study.__version__}")
    return parser


def _check_outputs(planned: Sequence[Path], datasets: Sequence[Path], *, overwrite: bool) -> None:
    sources = {path.resolve() for path in datasets}
    seen: set[Path] = set()
    for path in planned:
        if path.resolve() in sources:
            raise InputError(f"{path}: is one of the datasets to compare; choose another output")
        if path.resolve() in seen:
            raise InputError(f"{path}: is named twice; give every output its own file")
        seen.add(path.resolve())
        if path.is_dir():
            raise InputError(f"{path}: is a folder; name a file")
        if path.exists() and not overwrite:
            raise InputError(f"{path} exists; use --overwrite to replace it")


def _draw(inputs: Inputs, wanted: float | None) -> Figures:
    models, control = inputs.models, inputs.control
    points = sweep_points(models)
    shown = plotted.panel_points(models, control, wanted)
    scales = {point.label: plotted.scales(models, point) for point in points}
    scale, pressure = scales[shown.case.label], plotted.mean_pressure_unit(models)
    areas, gaps = plotted.contact_area_data(models, control), plotted.mean_gap_data(models, control)
    drawn = {
        "stress_distribution": figures.stress_distribution_figure(
            *plotted.stress_distribution_data(models, control, shown)
        ),
        "gap_distribution": figures.gap_distribution_figure(
            *plotted.gap_distribution_data(models, control, shown), scale.height_symbol
        ),
        "contact_area": figures.contact_area_figure(
            areas,
            pressure.name,
            bands.contact_area_bands(inputs.branches, points, pressure.size),
        ),
    }
    if any(np.isfinite(curve.x + curve.y).any() for curve in gaps):
        drawn["mean_gap"] = figures.mean_gap_figure(
            gaps, scale.height_symbol, bands.mean_gap_bands(inputs.branches, points, scales)
        )
    seed = _first_seed(inputs)
    distance = 0.0 if _is_hard_wall(inputs) else first_constant(models, shown.case, "contact_distance")
    maps = _gap_maps(inputs, shown, seed, distance)
    if maps:
        drawn["gap_map"] = figures.gap_map_figure(maps, _lateral_size(inputs, maps), distance)
    images = {name: figures.png(figure) for name, figure in drawn.items()}
    return Figures(images, captions(inputs, shown, scale, seed))


def _is_hard_wall(inputs: Inputs) -> bool:
    return inputs.study.cases[0].interaction.law == "hard_wall"


def _first_seed(inputs: Inputs) -> int | None:
    """The first seed that all models have which sweep it; None where none does."""
    swept = [list(dataset[AVERAGED].values) for dataset in inputs.models.values() if AVERAGED in dataset.dims]
    return next((int(seed) for seed in swept[0] if all(seed in other for other in swept)), None) if swept else None


def _lateral_size(inputs: Inputs, models: Iterable[str]) -> tuple[float, float]:
    """Periods along y and x (m), from the positions of the points."""
    dataset = inputs.models[next(iter(models))]
    y, x = (len(dataset[axis]) * float(dataset[axis][1] - dataset[axis][0]) for axis in ("y", "x"))
    return y, x


def _gap_maps(
    inputs: Inputs, shown: plotted.PanelPoints, seed: int | None, contact_distance: float
) -> dict[str, np.ma.MaskedArray]:
    """Gap of each simulation that kept it, at the state common to the figures, masked where there is contact."""
    maps = {}
    for model in ("atomistic", "continuum"):
        part = select(inputs.models[model], shown.case) if model in inputs.models else None
        if part is None or shown.common not in (path := case_points(part, inputs.control)):
            continue
        step = path.index(shown.common)
        selection = dict(shown.case.selection)
        if AVERAGED in part.dims:
            selection[AVERAGED] = seed
        gap = field_at(inputs.paths[model], "gap", selection, step)
        if gap is None or not np.isfinite(gap).all():
            continue
        pressure = field_at(inputs.paths[model], "pressure", selection, step) if _is_hard_wall(inputs) else None
        maps[model] = np.ma.masked_array(gap, gap < contact_distance if pressure is None else pressure > 0)
    return maps


def _attributes(inputs: Inputs, output: Path, arguments: Sequence[str]) -> dict[str, str]:
    now = datetime.now(UTC).isoformat(timespec="seconds")
    histories = [str(inputs.models[kind].attrs.get("history", "")) for kind in inputs.paths]
    references = [str(inputs.models[kind].attrs.get("references", "")) for kind in inputs.paths]
    return {
        "Conventions": CONVENTIONS,
        "title": inputs.study.title,
        "institution": "not given",
        "source": f"bem-adhesion {contact_study.__version__}, {COMMAND}",
        "history": "\n".join([f"{now}: {COMMAND} {shlex.join(arguments)}", *histories]),
        "references": "\n".join(dict.fromkeys(line for text in references for line in text.splitlines())),
        "created": now,
        "git_commit": git_commit(),
        "warnings": "\n".join(collected_warnings(inputs)),
        "model": "comparison",
        "study_toml": inputs.study.toml,
        "schema_version": SCHEMA_VERSION,
        "comment": "The fields gap and pressure stay in the models' own datasets.",
    }


def _writer(content: bytes) -> Callable[[Path], Any]:
    return lambda path: path.write_bytes(content)


def _write(outputs: Mapping[Path, Callable[[Path], Any]]) -> None:
    """Write every file aside, then rename them all: a failure leaves what was there before."""
    partials = {path: path.with_name(f".{path.name}.{os.getpid()}.tmp") for path in outputs}
    try:
        for path, write in outputs.items():
            writable_output(path)
            write(partials[path])
        for path, partial in partials.items():
            partial.replace(path)
    finally:
        for partial in partials.values():
            if partial.parent.is_dir():
                partial.unlink(missing_ok=True)


def _status(inputs: Inputs) -> int:
    failed = unconverged_steps(inputs.models)
    if not failed:
        return DONE
    print(
        f"{COMMAND}: {failed} of the inputs' steps did not converge; they are marked and left out of the deviations",
        file=sys.stderr,
    )
    return NOT_CONVERGED


if __name__ == "__main__":
    raise SystemExit(main())
