"""Inspect a surface before a run: statistics in words, a picture, and the spectrum as a table."""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_study.command_line.frame import epilog
from contact_study.inputs.errors import DONE, InputError

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure

    from contact_study.numerics.grid import Grid
    from contact_study.physics.roughness.statistics import PowerSpectrum, Roughness
    from contact_study.study.schema.surface import SurfaceSection

KEYS = True
USAGE = "FILE [-o PICTURE] [--surface.key VALUE ...]"
END = epilog(
    'bem-adhesion inspect afm.npy --surface.size "1 um" --surface.height_unit nm',
    "bem-adhesion inspect study.toml --surface.seed 2 -o surface.pdf",
)

# Largest number of points of the picture along a side.
_PICTURE = 1024


def add(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("file", type=Path, metavar="FILE", help="height map, or study file (.toml)")
    parser.add_argument("-o", "--output", metavar="PICTURE", help="figure to write; default: FILE.inspect.png")
    parser.add_argument(
        "--surface.key",
        metavar="VALUE",
        help="size, height_unit, fill ...; see `bem-adhesion keys surface --kind file`",
    )


def run(given: argparse.Namespace) -> int:
    """Describe a surface."""
    from contact_study.campaign.store.files import check_inputs_kept, named_file, writable_output
    from contact_study.inputs.files import require_file

    require_file(given.file, "inspect")
    output = None if given.output is None else named_file(given.output)
    if output is not None:
        check_inputs_kept(output, [given.file])
        writable_output(output)
    for line in inspect(given.file, given.keys, output):
        print(line)
    return DONE


def inspect(path: Path, overrides: Mapping[str, Any], picture: Path | None = None) -> list[str]:
    """Describe and draw a map, or the surface of a study's first case.

    Parameters
    ----------
    path : pathlib.Path
        A map, or a study file (``.toml``).
    overrides : mapping
        Values of keys ("surface.key") that replace those of the study, or that describe the map.
    picture : pathlib.Path, optional
        Figure to write; default beside ``path``. The spectrum goes to a table of the same name (``.csv``).

    Returns
    -------
    list of str
        Lines to print; the last one names the files that were written.

    Raises
    ------
    InputError
        If the surface cannot be realised.
    """
    # Slow to import, and needed here only.
    from matplotlib.figure import Figure

    from contact_study.campaign.store.files import write_aside
    from contact_study.plots.style import DOUBLE, RESOLUTION
    from contact_study.study.checks import described, map_warnings

    section, directory, words = _surface(path, overrides)
    if section.absent:
        raise InputError(f"{path}: has no [surface] to look at, a roughness spectrum only")
    scales = section.scales(directory)
    surface = section.realise(directory)
    lines = [words, *described(surface.roughness)]
    lines += [f"warning: {line}" for line in map_warnings(str(section.map_path), scales)]
    if surface.roughness.rms_slope > 1:
        lines.append("warning: surface: an rms slope above 1; linear elasticity of a half-space is meant for far less")
    figure = picture or path.with_name(f"{path.stem}.inspect.png")
    drawn = Figure(figsize=(DOUBLE, 2.8), layout="constrained")
    known = drawn.canvas.get_supported_filetypes()
    kind = figure.suffix.lower().lstrip(".")
    if kind not in known:
        raise InputError(f"-o {figure}: inspect writes a figure; expected a name that ends in {', '.join(known)}")
    table = figure.with_suffix(".csv")
    grid = surface.roughness.grid
    heights = surface.heights(grid.shape)
    _picture(drawn, heights, grid, surface.roughness.sample)
    write_aside(figure, lambda partial: drawn.savefig(partial, dpi=RESOLUTION, format=kind))
    write_aside(table, lambda partial: _tabulate(partial, surface.roughness.sample.spectrum))
    return [*lines, f"{figure} (map and spectrum), {table} (spectrum)"]


def _surface(path: Path, overrides: Mapping[str, Any]) -> "tuple[SurfaceSection, Path, str]":
    from contact_study.study.schema.keys import bind
    from contact_study.study.schema.surface import SURFACES
    from contact_study.study.study import read_study

    if path.suffix.lower() == ".toml":
        study = read_study(path, overrides)
        case = study.cases[0]
        kinds = len({one.surface for one in study.cases})
        which = f", at {case.label}, the first of {kinds} surfaces" if kinds > 1 else ""
        return case.surface, case.directory, f"{path}: surface of kind {case.surface.kind}{which}"
    strangers = [dotted for dotted in overrides if not dotted.startswith("surface.")]
    if strangers:
        raise InputError(f"--{strangers[0]}: a map alone has no such key; inspect STUDY.toml takes it")
    table = {dotted.removeprefix("surface."): value for dotted, value in overrides.items()}
    section = bind(SURFACES, {**table, "kind": "file", "path": path.name}, "surface")
    return section, path.parent, f"{path}: heights in {section.measured(path.parent).unit}"


def _picture(figure: "Figure", heights: "np.ndarray", grid: "Grid", sample: "Roughness") -> None:
    """Draw the map, coarsened if it is large, and the spectrum."""
    import xarray as xr
    from matplotlib import rc_context

    from contact_study import plots
    from contact_study.plots.densities import draw_spectrum
    from contact_study.plots.style import STYLE

    y, x = grid.coordinates
    surface = xr.Dataset({"height": (("y", "x"), heights)}, coords={"y": y, "x": x})
    with rc_context(STYLE):
        left, right = figure.subplots(1, 2)
    every = max(1, max(grid.shape) // _PICTURE)
    plots.height_map(surface.isel(y=slice(None, None, every), x=slice(None, None, every)), left)
    if sample.rms_height > 0:
        draw_spectrum(sample.spectrum, sample.fit, right)
    else:
        right.set_axis_off()


def _tabulate(path: Path, spectrum: "PowerSpectrum") -> None:
    import numpy as np

    columns = np.column_stack([spectrum.wavevectors, spectrum.density, spectrum.waves])
    np.savetxt(path, columns, fmt=("%.9g", "%.9g", "%g"), delimiter=",", header="q (1/m),C (m^4),waves", comments="")
