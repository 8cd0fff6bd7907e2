"""Infer constants of a contact from measured force curves."""

import argparse
import sys
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_study.command_line.frame import epilog, print_table
from contact_study.command_line.selection import pair
from contact_study.inputs.errors import DONE, InputError

if TYPE_CHECKING:
    import xarray as xr

USAGE = "CURVE ... [--fixed KEY=VALUE] [--prior KEY=VALUE] [-o FIT.nc]"
END = epilog(
    'bem-adhesion infer curve.csv --fixed radius="5 um" --spring "0.1 N/m" -o fit.nc --figure fit.png',
    'bem-adhesion infer jkr_test.csv --model jkr --fixed radius="1 mm" --prior modulus="2 +- 0.2 MPa"',
)


def add(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "curves", nargs="+", type=Path, metavar="CURVE", help="force curves, as text or of a microscope"
    )
    words = "hertz, jkr, dmt, maugis, simulation; default: the last of a study, else the three before it"
    parser.add_argument("--model", nargs="+", metavar="NAME", help=words)
    parser.add_argument("--study", type=Path, metavar="PROBE.toml", help="study of the probe, for the model simulation")
    words = "folder of the simulated loops, used again by later runs; default: PROBE.loops"
    parser.add_argument("--loops", type=Path, metavar="FOLDER", help=words)
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="processes for the loops; default 1")
    words = "known value, such as radius='5 um'"
    parser.add_argument("--fixed", action="append", default=[], metavar="KEY=VALUE", help=words)
    words = "value with a standard error, such as modulus='2 +- 0.2 MPa'"
    parser.add_argument("--prior", action="append", default=[], metavar="KEY=VALUE", help=words)
    words = "standard error of force, displacement or contact_radius, such as force='0.1 nN'"
    parser.add_argument("--noise", action="append", default=[], metavar="KEY=VALUE", help=words)
    words = "spring constant of the cantilever; default: that of the file or of --reading"
    parser.add_argument("--spring", metavar="VALUE", help=words)
    words = "how to read the curves, such as positive_force=tension"
    parser.add_argument("--reading", action="append", default=[], metavar="KEY=VALUE", help=words)
    words = "samples of the posterior to store (extra sampler)"
    parser.add_argument("--samples", type=int, default=0, metavar="N", help=words)
    parser.add_argument("-o", "--output", metavar="FIT.nc", help="dataset to write")
    parser.add_argument("--figure", metavar="FILE", help="figure of fit, residuals and profiles to write")
    parser.add_argument("--overwrite", action="store_true", help="replace existing files")


def run(given: argparse.Namespace) -> int:
    from contact_study import infer
    from contact_study.campaign.store.files import check_inputs_kept, named_file, writable_output, write_aside
    from contact_study.plots.style import RESOLUTION, format_of

    output, figure = (None if name is None else named_file(name) for name in (given.output, given.figure))
    if output is not None and output.suffix != ".nc":
        raise InputError(f"-o {output}: expected a name that ends in .nc")
    kind = None if figure is None else format_of(figure, "--figure")
    for path in filter(None, (output, figure)):
        check_inputs_kept(path, given.curves)
        if path.exists() and not given.overwrite:
            raise InputError(f"{path} exists; use --overwrite to replace it")
        writable_output(path)
    options: dict[str, Any] = {
        name: dict(pair(words, f"--{name}") for words in getattr(given, name)) for name in _PAIRS
    }
    options |= {"study": given.study, "loops": given.loops, "workers": given.workers, "samples": given.samples}
    found = infer(given.curves, given.model, spring_constant=given.spring, **options)
    found.attrs["history"] = f"{datetime.now(UTC).isoformat(timespec='seconds')}: {given.words}"
    if output is not None:
        write_aside(output, found.to_netcdf)
    if figure is not None:
        from contact_study.plots import inference

        drawn: Any = inference(found)
        write_aside(figure, lambda partial: drawn.savefig(partial, dpi=RESOLUTION, format=kind))
    print_table(("model", "parameter", "estimate", "90 % interval"), [*_rows(found)])
    for line in found.attrs["notes"].splitlines():
        print(f"{given.command}: {line}", file=sys.stderr)
    for path in filter(None, (output, figure)):
        print(path)
    return DONE


_PAIRS = ("fixed", "prior", "noise", "reading")


def _rows(found: "xr.Dataset") -> Iterable[tuple[str, str, str, str]]:
    """Rows of the table, the model that the evidence prefers first."""
    from contact_study.inference.parameters import PHYSICAL

    for at in found["bic"].values.argsort():
        one, name = found.isel(model=at), str(found["model"].values[at])
        for parameter in [parameter for parameter in PHYSICAL if parameter in one]:
            value = float(one[parameter])
            if value != value or (parameter == "force_scale" and not int(one[f"{parameter}_status"])):
                continue
            low, high = (float(one[f"{parameter}_{end}"]) for end in ("lower", "upper"))
            if not int(one[f"{parameter}_status"]):
                interval = "fixed"
            elif low != low and high != high:
                interval = "not identifiable"
            elif low != low or high != high:
                interval = f"below {_shown(parameter, high)}" if low != low else f"above {_shown(parameter, low)}"
            else:
                interval = f"{_shown(parameter, low)} to {_shown(parameter, high)}"
            yield name, parameter, _shown(parameter, value), interval
        yield name, "evidence", f"{float(one['weight']):.2g}", f"BIC {float(one['bic']):.1f}"


def _shown(parameter: str, value: float) -> str:
    from contact_study.inputs.units import length, stress

    if parameter == "contact_modulus":
        return stress(value)
    if parameter == "force_scale":
        return f"{value:.4g}"
    return f"{1e3 * value:.4g} mJ/m²" if parameter == "work_of_adhesion" else length(value)
