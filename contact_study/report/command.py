"""The command ``contact-compare``: datasets of the models in, their comparison, or a report of one, out."""

import os
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import contact_study
from contact_study import units
from contact_study.campaign.command_line.command import DONE, NOT_CONVERGED, Parser, complete, guarded
from contact_study.campaign.dataset.provenance import git_commit
from contact_study.campaign.store.files import named_file, real, writable_output, writing
from contact_study.errors import InputError
from contact_study.report.align.deviations import MISSING, compute_deviations, pairs_of
from contact_study.report.align.ensemble import ensemble_statistics
from contact_study.report.align.regime import compute_regime
from contact_study.report.align.tree import comparison_tree
from contact_study.report.facts.findings import find, surface_deviations
from contact_study.report.figures.illustrations import Figures, draw
from contact_study.report.models import FORMATS
from contact_study.report.page import FIGURE_TITLES, collected_warnings, render_report
from contact_study.report.read.datasets import Inputs, read_inputs
from contact_study.report.read.scatter import read_scatter
from contact_study.report.tables.settings import unconverged_steps
from contact_study.results.schema import CONVENTIONS, SCHEMA_VERSION

COMMAND = "contact-compare"
FIGURE_FILES = {name: f"figure_{number}_{name}" for number, name in enumerate(FIGURE_TITLES, 1)}


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare datasets; returns the exit status.

    0: done; 1: wrong input, nothing is written; 2: done, but some step of the inputs did not converge.

    One dataset is reported on; there is nothing to compare it with.
    """
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    return guarded(COMMAND, lambda: _main(arguments), interrupted="nothing was written")


def _main(arguments: Sequence[str]) -> int:
    parser = _parser()
    complete(parser)
    given = parser.parse_args(arguments)
    formats = list(dict.fromkeys(given.figure_format or ["png"]))
    output, report = named_file(given.output), named_file(given.report) if given.report else None
    planned = [output, *([report] if report else [])]
    if given.figures:
        planned += [given.figures / f"{name}.{kind}" for kind in formats for name in FIGURE_FILES.values()]
    _check_outputs(planned, [*given.datasets, *([given.scatter] if given.scatter else [])], overwrite=given.overwrite)
    wanted = (
        units.quantity(given.reference_pressure, "Pa", "--reference-pressure") if given.reference_pressure else None
    )
    inputs = read_inputs(given.datasets, given.average)
    if wanted is not None and inputs.control != "pressure":
        raise InputError("--reference-pressure: these studies prescribe the gap; leave it out")
    scatter = read_scatter(given.scatter, inputs) if given.scatter else None
    for note in (*inputs.notes, *(scatter.notes if scatter else ())):
        print(f"{COMMAND}: warning: {note}", file=sys.stderr)
    deviations = compute_deviations(inputs.models, inputs.control) if pairs_of(inputs.models) else None
    if deviations is not None and (deviations["state"] == MISSING).all():
        raise InputError("these datasets have no point of their loading paths in common; run the same study")
    regime = compute_regime(inputs)
    attrs = _attributes(inputs, output, arguments)
    of_surfaces = ensemble_statistics({scatter.model: scatter.dataset}) if scatter else {}
    shown = inputs.with_first_spectra.models
    from_surfaces = surface_deviations(inputs.models, scatter.model, scatter.dataset) if scatter else None
    drawn = draw(inputs, wanted, formats, scatter) if given.figures or report else Figures()
    tree = comparison_tree(inputs, deviations, regime, attrs, of_surfaces, from_surfaces)
    outputs: dict[Path, Callable[[Path], Any]] = {
        output: lambda path: tree.to_netcdf(path, engine="netcdf4", write_inherited_coords=True)
    }
    if given.figures:
        for kind in formats:
            files = drawn.files(kind).items()
            outputs |= {given.figures / f"{FIGURE_FILES[name]}.{kind}": _writer(content) for name, content in files}
    if report:
        findings = find(shown, deviations, regime, of_surfaces, from_surfaces).sentences()
        page = render_report(inputs, deviations, regime, drawn, {**attrs, "file": output.name}, findings)
        outputs[report] = _writer(page.encode())
    _write(outputs)
    print(*outputs, sep="\n")
    return _status(inputs)


def _parser() -> Parser:
    parser = Parser(
        prog=COMMAND,
        description="Compare datasets of bem-adhesion, md-reference and persson-theory: deviations, figures, report.",
        epilog="Exit status: 0 done, 1 wrong input (nothing is written), 2 done, but some step of the inputs did not "
        "converge, 130 interrupted.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "datasets",
        type=Path,
        nargs="+",
        metavar="MODEL.nc",
        help="datasets of one contact: one to report on, or several to compare, in any order",
    )
    parser.add_argument("-o", "--output", required=True, metavar="OUT.nc", help="dataset to write")
    parser.add_argument("--figures", type=Path, metavar="FOLDER", help="folder for the figures")
    parser.add_argument(
        "--figure-format",
        action="append",
        choices=FORMATS,
        help="format of the figures in their folder; may be given several times (default: png)",
    )
    parser.add_argument("--report", metavar="REPORT.html", help="report to write, one file with all in it")
    parser.add_argument("--overwrite", action="store_true", help="replace existing files")
    parser.add_argument(
        "--reference-pressure",
        metavar="P",
        help='pressure at which the distributions of the whole sweep are shown, such as "1 GPa"; the nearest one '
        "of the path is taken (default: p/E* = 0.00832 where the path has it, else its middle)",
    )
    parser.add_argument(
        "--average",
        metavar="KEY",
        help="swept key over which means and standard errors are shown, such as rms_height (default: seed)",
    )
    parser.add_argument(
        "--scatter",
        type=Path,
        metavar="SEEDS.nc",
        help="dataset of a simulation over several seeds of the same contact: its mean and standard deviation stand "
        "behind the models in the figures of contact area and mean gap",
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {contact_study.__version__}")
    return parser


def _check_outputs(planned: Sequence[Path], datasets: Sequence[Path], *, overwrite: bool) -> None:
    sources = {real(path) for path in datasets}
    seen: set[str] = set()
    if planned[0].suffix != ".nc":
        raise InputError(f"{planned[0]}: a comparison is written as NetCDF; expected a name that ends in .nc")
    for path in planned:
        if real(path) in sources:
            raise InputError(f"{path}: is one of the datasets to compare; choose another output")
        if real(path) in seen:
            raise InputError(f"{path}: is named twice; give every output its own file")
        seen.add(real(path))
        if path.is_dir():
            raise InputError(f"{path}: is a folder; name a file")
        if path.exists() and not overwrite:
            raise InputError(f"{path} exists; use --overwrite to replace it")


def _attributes(inputs: Inputs, output: Path, arguments: Sequence[str]) -> dict[str, str]:
    now = datetime.now(UTC).isoformat(timespec="seconds")
    histories = [str(inputs.groups[kind][""].attrs.get("history", "")) for kind in inputs.paths]
    references = [str(inputs.groups[kind][""].attrs.get("references", "")) for kind in inputs.paths]
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
            with writing(path):
                write(partials[path])
        for path, partial in partials.items():
            with writing(path):
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
