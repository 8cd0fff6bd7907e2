"""What scripts and research share: options, tables, files of rows, figures, rough surfaces, and how a run ends."""

import argparse
import resource
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_study.command_line.frame import Parser, guarded

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from bem_adhesion import Contact, Solution
    from contact_study.physics.surfaces.surface import Surface
    from contact_study.study.study import Study

ROOT = Path(__file__).resolve().parent.parent
RUN = (str(Path(sys.executable).with_name("bem-adhesion")), "run")
PAPER = Path("data/yang2008.toml")  # from the project's folder, where scripts run


class Option:
    """One option or argument of a script.

    Parameters
    ----------
    name : str
        ``"--points"``, or ``"study"`` for an argument by place.
    default : object
        Its value if it is not given, whose type the option has; a list takes several values, ``False`` makes a flag. A
        type in its place stands for no default: an argument by place is then required.
    words : str
        Noun phrase for ``--help``.
    **more : object
        What else ``add_argument`` takes.
    """

    def __init__(self, name: str, default: Any, words: str, **more: Any):
        self.name = name
        self.settings: dict[str, Any] = {"help": words}
        if default is False:
            self.settings |= {"action": "store_true"}
        elif isinstance(default, type):
            self.settings |= {"type": default}
        elif isinstance(default, list):
            self.settings |= {"type": type(default[0]), "nargs": "+", "default": default}
        else:
            self.settings |= {"type": type(default) if default != PAPER else Path, "default": default}
            self.settings |= {} if name.startswith("-") else {"nargs": "?"}
        self.settings |= more
        if name == "--from":  # a word of Python
            self.settings["dest"] = "source"

    def add(self, parser: argparse.ArgumentParser) -> None:
        """Add it to a parser."""
        names = [name.strip() for name in self.name.split(",")]
        parser.add_argument(*names, **self.settings)


STUDY = Option("study", PAPER, "study file")
FIGURE = Option("--figure", Path, "figure to draw")


class _Help(argparse.ArgumentDefaultsHelpFormatter, argparse.RawDescriptionHelpFormatter):
    """The module's docstring as it is written, and every default."""


def program(
    run: Callable[[argparse.Namespace], int | None], *options: Option, interrupted: str = "nothing is written"
) -> Callable[..., int]:
    """Make the ``main`` of a script.

    Parameters
    ----------
    run : callable
        Takes the options, prints its tables, returns an exit status or nothing.
    *options : Option
        What the command takes.
    interrupted : str
        What remains after Ctrl-C.

    Returns
    -------
    callable
        Arguments (by default the command's) -> exit status: 1 for a mistake of input, 130 for an interruption.
    """
    module = sys.modules[run.__module__]

    def main(arguments: Sequence[str] | None = None) -> int:
        parser = Parser(description=module.__doc__, formatter_class=_Help, allow_abbrev=False)
        for option in options:
            option.add(parser)
        name = Path(str(module.__file__)).stem
        return guarded(name, lambda: run(parser.parse_args(arguments)) or 0, interrupted=interrupted)

    return main


def tabulated(
    rows: Callable[[argparse.Namespace], "pd.DataFrame | Iterable[dict[str, Any]]"],
    lines: "Callable[[pd.DataFrame], Iterable[str]]",
    *options: Option,
) -> Callable[..., int]:
    """Make the ``main`` of a script whose rows come from a run, or from the file that another run wrote.

    Parameters
    ----------
    rows : callable
        Options -> the table, or its rows one by one, each of which is in the file as soon as it is there.
    lines : callable
        The table -> lines to print.
    """

    def run(given: argparse.Namespace) -> None:
        import pandas as pd

        if given.source is not None:
            table = pd.read_csv(given.source)
        elif isinstance(found := rows(given), pd.DataFrame):
            table = found
        else:
            kept = []
            for row in found:
                kept.append(row)
                print(row, file=sys.stderr, flush=True)
                write_rows(pd.DataFrame(kept), given.table)
            table = pd.DataFrame(kept)
        write_rows(table, given.table)
        print("\n".join(lines(table)))

    run.__module__ = lines.__module__
    keep = Option("--table", Path, "CSV to write the rows to")
    return program(
        run,
        *options,
        keep,
        Option("--from", Path, "CSV to print, in place of a run"),
        interrupted="finished rows are kept",
    )


def write_rows(table: "pd.DataFrame", path: Path | None) -> None:
    """Write a table to a CSV file, to six digits, if there is one to write."""
    if path is not None:
        table.to_csv(path, index=False, float_format="%.6g")


def read_rows(path: Path | None, columns: Sequence[str]) -> "pd.DataFrame":
    """Rows of a CSV file; none of these columns if there is no such file yet."""
    import pandas as pd

    return pd.read_csv(path) if path is not None and path.exists() else pd.DataFrame(columns=list(columns))


def row(*cells: object) -> str:
    """A line of a Markdown table."""
    return f"| {' | '.join(map(str, cells))} |"


def head(*names: object) -> str:
    """The two lines above its rows."""
    return f"{row(*names).replace('|  |', '| |')}\n{'|---' * len(names)}|"


def show(names: Iterable[object], rows: Iterable[Iterable[object]]) -> None:
    """Print a Markdown table, each row as soon as it is there."""
    print(head(*names), flush=True)
    for cells in rows:
        print(row(*cells), flush=True)


def minus(text: str) -> str:
    """A number with the sign that print has."""
    return text.replace("-", "−")


def per_cent(one: float, other: float, digits: int = 1) -> str:
    """Relative difference of a value from another, with its sign."""
    return f"{100 * (one / other - 1):+.{digits}f} %"


def save(figure: "Figure", path: Path | None) -> None:
    """Write a figure, if there is a file for it, and print its name on stderr."""
    from contact_study.campaign.store.files import write_aside
    from contact_study.plots.style import RESOLUTION

    if path is not None:
        options = {"dpi": RESOLUTION, "format": path.suffix[1:], "metadata": {"Software": None}}
        write_aside(path, lambda partial: figure.savefig(partial, **options))
        print(path, file=sys.stderr)


def processor_time(work: Callable[[], object]) -> float:
    """Processor time of a call (s)."""
    began = time.process_time()
    work()
    return time.process_time() - began


def children_time() -> float:
    """Processor time of all processes that have been waited for (s)."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def peak_memory() -> float:
    """Largest memory of this process so far (bytes)."""
    # getrusage counts what the parent held when this process was made, /proc does not.
    status = Path("/proc/self/status")
    if not status.exists():  # not Linux
        return 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    (line,) = [line for line in status.read_text().splitlines() if line.startswith("VmHWM:")]
    return 1024.0 * float(line.split()[1])


def rough_surface(size: float, points: int, rms_height: float, **keys: Any) -> "Surface":
    """Realise a self-affine surface of Hurst exponent 0.8 (lengths in m); ``keys`` as in ``[surface]`` of a study."""
    from contact_study.study.case import realise
    from contact_study.study.study import make_study

    keys = {"hurst_exponent": 0.8, "seed": 1} | keys
    study = {
        "surface": {"kind": "self_affine", "size": size, "shape": [points, points], "rms_height": rms_height, **keys},
        "material": {"youngs_modulus": 1.0, "poissons_ratio": 0.0},
        "interaction": {"law": "hard_wall"},
        "loading": {"path": [1e-3]},
    }
    return realise(make_study(study).cases[0])


def shrunk(study: "Study", fraction: float) -> dict[str, Any]:
    """A study's table with cell, grid and roughness at a fraction of their lengths, its slopes kept."""
    import copy

    from contact_study.inputs.errors import InputError

    table, surface = copy.deepcopy(dict(study.table)), study.cases[0].surface
    if fraction != 1.0:
        if surface.kind != "self_affine":
            raise InputError(f'surface.kind = "{surface.kind}": only self-affine surfaces can be scaled')
        table["surface"] |= {
            "size": [fraction * length for length in surface.size],
            "shape": [round(fraction * points) for points in surface.shape],
            "rms_height": fraction * surface.rms_height,
        }
    return table


def walk(contact: "Contact", loads: Iterable[float]) -> "Iterator[Solution]":
    """Yield the states of a loading path from separation, each from the one before."""
    state = contact.separated()
    for load in loads:
        found = contact.step(state, load)
        state = found.state
        yield found
