"""Merge datasets of one study into one."""

import argparse
import sys
from pathlib import Path

from contact_study.command_line.frame import epilog, report_convergence

USAGE = "PART.nc ... -o OUT.nc [--along SECTION.KEY] [--overwrite]"
END = epilog(
    "bem-adhesion merge part-*.nc -o whole.nc",
    "bem-adhesion merge soft.nc stiff.nc -o both.nc --along material.youngs_modulus",
    solves=True,
)


def add(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("datasets", type=Path, nargs="+", metavar="PART.nc", help="datasets of one model, version and study")
    add("-o", "--output", required=True, metavar="OUT.nc", help="dataset to write")
    differing = "key that differs between parts but is not swept"
    add("--along", action="append", default=[], metavar="SECTION.KEY", help=differing)
    add("--overwrite", action="store_true", help="replace an existing dataset")


def run(given: argparse.Namespace) -> int:
    from contact_study.campaign.merge import merge
    from contact_study.campaign.progress import Progress
    from contact_study.campaign.store.files import named_file

    output = named_file(given.output)
    groups, notes = merge(given.datasets, output, given.words, Progress(given.command), given.along, given.overwrite)
    for note in notes:
        print(f"{given.command}: warning: {note}", file=sys.stderr)
    print(output)
    return report_convergence(given.command, groups)
