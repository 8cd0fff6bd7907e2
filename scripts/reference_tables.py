"""Tables of the documentation that the code itself makes: variables of a dataset, keys of a study.

python scripts/reference_tables.py variables
python scripts/reference_tables.py keys
"""

import argparse
import dataclasses
import sys
from collections.abc import Iterable, Sequence

from contact_study.campaign.command import Parser, guarded
from contact_study.campaign.schema import COORDINATES, VARIABLES
from contact_study.observables.constants import CONSTANTS
from contact_study.problem.study import all_keys


def main(arguments: Sequence[str] | None = None) -> int:
    return guarded("reference_tables", lambda: _main(arguments), interrupted="nothing is written")


def parser() -> Parser:
    made = Parser(
        description=__doc__.splitlines()[0], formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False
    )
    made.add_argument("table", choices=("variables", "keys"), help="which one")
    return made


def _main(arguments: Sequence[str] | None) -> int:
    print("\n".join(_variables() if parser().parse_args(arguments).table == "variables" else _keys()))
    return 0


def _variables() -> Iterable[str]:
    yield from ("| variable | dimensions | unit | meaning |", "|---|---|---|---|")
    for known in (CONSTANTS, {name: it for name, it in VARIABLES.items() if name not in CONSTANTS}, COORDINATES):
        for name, it in known.items():
            units = "" if it.units == "1" else it.units
            yield f"| `{name}` | {', '.join(it.dims)} | {units} | {_cell(it.long_name)} |"


def _keys() -> Iterable[str]:
    section = None
    for own, name, declaration, default in all_keys():
        if own != section:
            section = own
            yield from ("", f"**`[{section}]`**", "", "| key | kind | default | meaning |", "|---|---|---|---|")
        given = default not in (None, dataclasses.MISSING)
        shown = f"`{str(default).lower() if isinstance(default, bool) else default}`" if given else ""
        yield f"| `{name}` | {_cell(declaration.kind)} | {shown} | {_cell(declaration.description)} |"


def _cell(words: str) -> str:
    return words.replace("|", "\\|")


if __name__ == "__main__":
    sys.exit(main())
