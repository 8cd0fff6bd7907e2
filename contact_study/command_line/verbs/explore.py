"""Look at datasets on a page."""

import argparse
from pathlib import Path

from contact_study.command_line.frame import epilog
from contact_study.inputs.errors import DONE, InputError

USAGE = "FILE.nc ... --html PAGE.html"
END = epilog("bem-adhesion explore bem.nc --html page.html", "bem-adhesion explore bem.nc theory.nc --html page.html")


def add(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE.nc", help="datasets of runs")
    words = "one file with slider, maps and curves, which needs no network"
    parser.add_argument("--html", metavar="PAGE", required=True, help=words)


def run(given: argparse.Namespace) -> int:
    from contact_study.campaign.store.files import check_inputs_kept, named_file, writable_output

    try:
        from contact_study.explore.static_page import write_static_page
    except ImportError as error:
        if (error.name or "").partition(".")[0] not in ("bokeh", "panel"):
            raise
        raise InputError("explore: needs the package bokeh; pip install 'bem-adhesion[explore]'") from None
    output = named_file(given.html)
    if output.suffix.lower() not in (".html", ".htm"):
        raise InputError(f"--html {output}: expected a name that ends in .html")
    check_inputs_kept(output, given.files)
    writable_output(output)
    write_static_page(given.files, output)
    print(output)
    return DONE
