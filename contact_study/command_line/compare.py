"""The command ``contact-compare``: its options and what it may write; the comparison runs in ``comparison``."""

import sys
from collections.abc import Sequence
from pathlib import Path

import contact_study
from contact_study.campaign.store.files import named_file, real
from contact_study.command_line.frame import Parser, complete, guarded
from contact_study.inputs import units
from contact_study.inputs.errors import InputError
from contact_study.report.models import FIGURE_TITLES, FORMATS

COMMAND = "contact-compare"
FIGURE_FILES = {name: f"figure_{number}_{name}" for number, name in enumerate(FIGURE_TITLES, 1)}


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare datasets, or report on one, and return the exit status.

    0: done; 1: wrong input, nothing is written; 2: done, but some step of the inputs did not converge.
    """
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    return guarded(COMMAND, lambda: _main(arguments), interrupted="nothing was written")


def _main(arguments: Sequence[str]) -> int:
    parser = _parser()
    complete(parser)
    given = parser.parse_args(arguments)
    formats = list(dict.fromkeys(given.figure_format or ["png"]))
    output, report = named_file(given.output), named_file(given.report) if given.report else None
    pictures = (
        {kind: {name: given.figures / f"{file}.{kind}" for name, file in FIGURE_FILES.items()} for kind in formats}
        if given.figures
        else {}
    )
    planned = [output, *([report] if report else []), *(path for files in pictures.values() for path in files.values())]
    _check_outputs(planned, [*given.datasets, *([given.scatter] if given.scatter else [])], overwrite=given.overwrite)
    reference = (
        units.quantity(given.reference_pressure, "Pa", "--reference-pressure") if given.reference_pressure else None
    )
    # Imported after the options: xarray and matplotlib take most of a second.
    from contact_study.report.comparison import Request, compare

    request = Request(
        given.datasets, output, report, pictures, reference, given.average, given.scatter, COMMAND, arguments
    )
    return compare(request)


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
        help="dataset of a simulation over several seeds of the same contact: its mean and standard deviation are "
        "drawn behind the models in the figures of contact area and mean gap",
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


if __name__ == "__main__":
    raise SystemExit(main())
