"""The command ``contact-merge``: datasets of one study in, one dataset out."""

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

import contact_study
from contact_study.campaign.command_line.command import DONE, NOT_CONVERGED, Parser, completed, guarded
from contact_study.campaign.dataset.provenance import unconverged
from contact_study.campaign.merge.merge import merge
from contact_study.campaign.progress import Progress
from contact_study.campaign.store.files import named_file

COMMAND = "contact-merge"


def main(arguments: Sequence[str] | None = None) -> int:
    """Join datasets; returns the exit status.

    0: done; 1: wrong input, nothing is written; 2: done, but some step of the inputs did not converge.
    """
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    return guarded(COMMAND, lambda: _main(arguments), interrupted="nothing was written")


def _main(arguments: Sequence[str]) -> int:
    parser = _parser()
    completed(parser)
    given = parser.parse_args(arguments)
    output = named_file(given.output)
    words = f"{COMMAND} {shlex.join(arguments)}"
    groups, notes = merge(given.datasets, output, words, Progress(COMMAND), given.along, given.overwrite)
    for note in notes:
        print(f"{COMMAND}: warning: {note}", file=sys.stderr)
    print(output)
    said = list(unconverged(groups))
    for line in said:
        print(f"{COMMAND}: {line}", file=sys.stderr)
    return NOT_CONVERGED if said else DONE


def _parser() -> Parser:
    parser = Parser(
        prog=COMMAND,
        description="Join datasets of one study, run in parts, into the dataset of the whole study, whose sweep holds "
        "the points of all. What stands in several of them must agree.",
        epilog="Exit status: 0 done, 1 wrong input (nothing is written), 2 done, but some step of the inputs did not "
        "converge, 130 interrupted.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "datasets", type=Path, nargs="+", metavar="PART.nc", help="datasets of one model, version and study"
    )
    parser.add_argument("-o", "--output", required=True, metavar="OUT.nc", help="dataset to write")
    parser.add_argument(
        "--along",
        action="append",
        default=[],
        metavar="SECTION.KEY",
        help="key in which the parts may differ though none sweeps it: it becomes a dimension (seeds do so unasked)",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace an existing dataset")
    parser.add_argument("--version", action="version", version=f"%(prog)s {contact_study.__version__}")
    return parser


if __name__ == "__main__":
    raise SystemExit(main())
