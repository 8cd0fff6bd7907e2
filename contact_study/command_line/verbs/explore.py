"""Look at datasets, and set up a first study, on a page."""

import argparse
from pathlib import Path

from contact_study.command_line.frame import epilog
from contact_study.inputs.errors import DONE, InputError

USAGE = "[FILE.nc ...] [--port N] [--no-browser] | FILE.nc ... --html PAGE.html"
END = epilog(
    "bem-adhesion explore", "bem-adhesion explore bem.nc theory.nc", "bem-adhesion explore bem.nc --html page.html"
)


def add(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", type=Path, nargs="*", metavar="FILE.nc", help="datasets of runs, finished or not")
    parser.add_argument("--port", type=int, default=0, metavar="N", help="of the local address; default: a free one")
    parser.add_argument("--no-browser", action="store_true", help="print the address and open nothing")
    words = "write one file with slider, maps and curves, which needs no network"
    parser.add_argument("--html", metavar="PAGE", help=words)


def run(given: argparse.Namespace) -> int:
    from contact_study.campaign.store.files import check_inputs_kept, named_file, writable_output

    try:
        import bokeh  # noqa: F401
        import panel  # noqa: F401
    except ImportError as error:
        if (error.name or "").partition(".")[0] not in ("bokeh", "panel"):
            raise
        raise InputError("explore: needs the package panel; pip install 'bem-adhesion[explore]'") from None
    if given.html is None:
        if not 0 <= given.port < 65536:
            raise InputError(f"--port {given.port}: expected 1 to 65535")
        from contact_study.explore.server import serve_until_interrupted

        serve_until_interrupted(given.files, Path.cwd(), given.port, not given.no_browser)
        return DONE
    from contact_study.explore.static_page import write_static_page

    output = named_file(given.html)
    if output.suffix.lower() not in (".html", ".htm"):
        raise InputError(f"--html {output}: expected a name that ends in .html")
    if not given.files:
        raise InputError("--html: of which dataset? bem-adhesion explore bem.nc --html page.html")
    check_inputs_kept(output, given.files)
    writable_output(output)
    write_static_page(given.files, output)
    print(output)
    return DONE
