"""Compare datasets, or report on one."""

import argparse
from pathlib import Path

from contact_study.command_line.frame import epilog
from contact_study.inputs.errors import InputError
from contact_study.report.models import FIGURE_TITLES, FORMATS

FIGURE_FILES = {name: f"figure_{number}_{name}" for number, name in enumerate(FIGURE_TITLES, 1)}
USAGE = "FILE.nc ... -o FOLDER [options]"
END = epilog(
    "bem-adhesion compare bem.nc -o comparison",
    "bem-adhesion compare bem.nc md.nc theory.nc -o comparison --figure-format pdf",
    "bem-adhesion compare bem.nc md.nc -o comparison.nc --report report.html",
    solves=True,
)


def add(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("datasets", type=Path, nargs="+", metavar="FILE.nc", help="datasets of one contact; one alone is reported on")
    add(
        "-o", "--output", required=True, metavar="FOLDER", help="folder of dataset, report and figures, or OUT.nc alone"
    )
    add("--report", metavar="FILE", help="report to write, one HTML file; default: FOLDER/report.html")
    add("--figures", type=Path, metavar="FOLDER", help="folder of the figures; default: FOLDER/figures")
    words = f"{', '.join(FORMATS)}; may be repeated"
    add("--figure-format", action="append", choices=FORMATS, metavar="FORMAT", help=words)
    add("--overwrite", action="store_true", help="replace existing files")
    add("--reference-pressure", metavar="P", help='pressure of the distributions, such as "1 GPa"')
    add("--average", metavar="KEY", help="swept key that is averaged over, such as rms_height; default: seed")
    add("--scatter", type=Path, metavar="FILE", help="dataset over several surfaces, of which the scatter is drawn")


def run(given: argparse.Namespace) -> int:
    from contact_study.campaign.store.files import named_file, real
    from contact_study.inputs import units

    output, figures, report = given.output, given.figures, given.report
    if output and not Path(output).suffix:  # a folder for all
        figures, report = figures or Path(output, "figures"), report or Path(output, "report.html")
        output = Path(output, "comparison.nc")
    output, report = named_file(output), named_file(report) if report else None
    pictures = {
        kind: {name: figures / f"{file}.{kind}" for name, file in FIGURE_FILES.items()}
        for kind in dict.fromkeys(given.figure_format or ["png"])
        if figures
    }
    planned = [output, *([report] if report else []), *(path for files in pictures.values() for path in files.values())]
    if output.suffix != ".nc":
        raise InputError(f"{output}: a comparison is written as NetCDF; expected a name that ends in .nc")
    sources, seen = {real(path) for path in (*given.datasets, given.scatter) if path}, set[str]()
    for path in planned:
        if real(path) in sources:
            raise InputError(f"{path}: is one of the datasets to compare; choose another output")
        if real(path) in seen:
            raise InputError(f"{path}: is named twice; give every output its own file")
        seen.add(real(path))
        if path.is_dir():
            raise InputError(f"{path}: is a folder; name a file")
        if path.exists() and not given.overwrite:
            raise InputError(f"{path} exists; use --overwrite to replace it")
    pressure = given.reference_pressure
    reference = units.quantity(pressure, "Pa", "--reference-pressure") if pressure else None
    from contact_study.report.comparison import Request, compare

    about = given.average, given.scatter, given.command, given.arguments
    return compare(Request(given.datasets, output, report, pictures, reference, *about))
