"""Combine measurements of one surface into one power spectrum."""

import argparse
import math
import sys
import tomllib
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_study.command_line.frame import epilog, print_table
from contact_study.inputs.errors import DONE, InputError

if TYPE_CHECKING:
    import xarray as xr

USAGE = "FILE ... -o SPECTRUM.nc [--figure PICTURE] [--KEY VALUE ...]"
END = epilog(
    "bem-adhesion spectrum afm.nc stylus.csv -o surface_psd.nc --figure surface_psd.png",
    "bem-adhesion spectrum measurements.toml container.zip -o surface_psd.nc",
    "bem-adhesion spectrum afm.npy -o psd.nc --size '1 um' --height_unit nm --tip_radius '10 nm'",
)


def add(parser: argparse.ArgumentParser) -> None:
    from contact_study.study.schema.keys import keys_of
    from contact_study.study.schema.measurement import MeasurementSection

    words = "maps, line scans, containers (.zip), lists of them (.toml)"
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help=words)
    parser.add_argument("-o", "--output", required=True, metavar="SPECTRUM.nc", help="dataset to write")
    parser.add_argument("--figure", metavar="PICTURE", help="figure of all spectra to write")
    words = "line scans in two dimensions: abel (default), or approximate, C = C_1D / 2q"
    parser.add_argument("--rule", choices=("abel", "approximate"), default="abel", metavar="RULE", help=words)
    parser.add_argument("--overwrite", action="store_true", help="replace an existing file")
    keys = parser.add_argument_group("keys of every FILE that is no list")
    for name, declared in keys_of(MeasurementSection).items():
        if name != "path":
            keys.add_argument(f"--{name}", metavar="VALUE", help=f"{declared.description} ({declared.kind})")


def run(given: argparse.Namespace) -> int:
    from contact_study.campaign.store.files import check_inputs_kept, named_file, writable_output, write_aside
    from contact_study.inputs.units import length
    from contact_study.results.measured_spectrum import measured_spectrum

    output = named_file(given.output)
    figure = None if given.figure is None else named_file(given.figure)
    if output.suffix != ".nc":
        raise InputError(f"-o {output}: expected a name that ends in .nc")
    if figure is not None:
        from contact_study.plots.style import format_of

        format_of(figure, "--figure")
    for path in filter(None, (output, figure)):
        check_inputs_kept(path, given.files)
        if path.exists() and not given.overwrite:
            raise InputError(f"{path} exists; use --overwrite to replace it")
        writable_output(path)
    dataset = measured_spectrum(given.files, given.rule, **_shared(given))
    dataset.attrs["history"] = f"{datetime.now(UTC).isoformat(timespec='seconds')}: {given.words}"
    write_aside(output, dataset.to_netcdf)
    if figure is not None:
        _draw(dataset, figure)
    names = ("measurement", "kind", "shortest_wavelength", "limited_by", "instrument")
    every = zip(*(dataset[name].values.tolist() for name in names), strict=True)
    rows = [(name, kind, length(shortest), limit, instrument) for name, kind, shortest, limit, instrument in every]
    print_table(("measurement", "kind", "reliable down to", "limited by", "instrument"), rows)
    longest, shortest = (2 * math.pi / float(q) for q in dataset["wavevector"][[0, -1]])
    print(
        f"wavelengths from {length(shortest)} to {length(longest)}; measurements differ by "
        f"{100 * math.expm1(float(dataset['spread'])):.0f} % beyond statistics"
    )
    for line in dataset.attrs["warnings"].splitlines():
        print(f"{given.command}: warning: {line}", file=sys.stderr)
    print(*filter(None, (output, figure)), sep="\n")
    return DONE


def _shared(given: argparse.Namespace) -> dict[str, Any]:
    """Keys that are given as options, as TOML or text."""
    from contact_study.study.schema.keys import keys_of
    from contact_study.study.schema.measurement import MeasurementSection

    typed = {name: getattr(given, name) for name in keys_of(MeasurementSection) if name != "path"}
    found: dict[str, Any] = {}
    for name, value in typed.items():
        if value is not None:
            try:
                found[name] = tomllib.loads(f"value = {value}")["value"]
            except ValueError:
                found[name] = value
    return found


def _draw(dataset: "xr.Dataset", figure: Path) -> None:
    from contact_study.campaign.store.files import write_aside
    from contact_study.plots import measured_spectra
    from contact_study.plots.style import RESOLUTION, format_of

    drawn: Any = measured_spectra(dataset).figure
    kind = format_of(figure, "--figure")
    write_aside(figure, lambda partial: drawn.savefig(partial, dpi=RESOLUTION, format=kind))
