"""The command ``contact-merge``: merge datasets of one study into one."""

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from contact_study.command_line.frame import Parser, complete, guarded, report_convergence
from contact_study.version import __version__

COMMAND = "contact-merge"


def main(arguments: Sequence[str] | None = None) -> int:
    """Merge datasets.

    Returns
    -------
    int
        Exit status. 0: done; 1: wrong input, nothing is written; 2: done, but some step of the inputs did not converge.
    """
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    return guarded(COMMAND, lambda: _main(arguments), interrupted="nothing was written")


def _main(arguments: Sequence[str]) -> int:
    parser = _parser()
    complete(parser)
    given = parser.parse_args(arguments)
    from contact_study.campaign.merge import merge
    from contact_study.campaign.progress import Progress
    from contact_study.campaign.store.files import named_file

    output = named_file(given.output)
    words = f"{COMMAND} {shlex.join(arguments)}"
    groups, notes = merge(given.datasets, output, words, Progress(COMMAND), given.along, given.overwrite)
    for note in notes:
        print(f"{COMMAND}: warning: {note}", file=sys.stderr)
    print(output)
    return report_convergence(COMMAND, groups)


def _parser() -> Parser:
    parser = Parser(
        prog=COMMAND,
        description="Merge datasets of one study, run in parts, into the dataset of the whole study, whose sweep holds "
        "the points of all. Datasets that overlap must agree.",
        epilog="Exit status: 0 done, 1 wrong input (nothing is written), 2 done, but some step of the inputs did not "
        "converge, 130 interrupted.",
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("datasets", type=Path, nargs="+", metavar="PART.nc", help="datasets of one model, version and study")
    add("-o", "--output", required=True, metavar="OUT.nc", help="dataset to write")
    add(
        "--along",
        action="append",
        default=[],
        metavar="SECTION.KEY",
        help="key in which the parts differ without a sweep: it becomes a dimension (seeds always do)",
    )
    add("--overwrite", action="store_true", help="replace an existing dataset")
    add("--version", action="version", version=f"%(prog)s {__version__}")
    return parser


if __name__ == "__main__":
    raise SystemExit(main())
