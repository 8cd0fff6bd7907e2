"""Inspect a surface before a run: statistics in words, a picture, and the spectrum as a table."""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_study.command_line.frame import epilog
from contact_study.inputs.errors import DONE, InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contact_study.physics.surfaces.surface import Surface
    from contact_study.study.schema.surface import SurfaceSection

KEYS = True
USAGE = "FILE [-o PICTURE] [--surface.key VALUE ...]"
END = epilog(
    'bem-adhesion inspect afm.npy --surface.size "1 um" --surface.height_unit nm',
    "bem-adhesion inspect study.toml --surface.seed 2 -o surface.pdf",
)


def add(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, metavar="FILE", help="height map, or study file (.toml)")
    parser.add_argument("-o", "--output", metavar="PICTURE", help="figure to write; default: FILE.inspect.png")
    words = "size, height_unit, fill ...; see `bem-adhesion keys surface --kind file`"
    parser.add_argument("--surface.key", metavar="VALUE", help=words)


def run(given: argparse.Namespace) -> int:
    """Describe and draw a map, or the surface of a study's first case."""
    from contact_study.campaign.store.files import check_inputs_kept, named_file, writable_output, write_aside
    from contact_study.inputs.files import require_file

    require_file(given.file, "inspect")
    output = None if given.output is None else named_file(given.output)
    if output is not None:
        check_inputs_kept(output, [given.file])
        writable_output(output)
    import numpy as np  # these and what follows are slow to import
    from matplotlib.figure import Figure

    from contact_study.plots.style import DOUBLE, RESOLUTION
    from contact_study.study.checks import described, map_warnings

    section, directory, words = _surface(given.file, given.keys)
    if section.absent:
        raise InputError(f"{given.file}: has no [surface] to look at, a roughness spectrum only")
    scales, surface = section.scales(directory), section.realise(directory)
    lines = [*words, *described(surface.roughness)]
    maps = scales.maps or ((str(section.map_path), scales),)
    lines += [f"warning: {line}" for one in maps for line in map_warnings(*one)]
    if surface.roughness.rms_slope > 1:
        lines.append("warning: surface: an rms slope above 1; linear elasticity of a half-space is meant for far less")
    picture = output or given.file.with_name(f"{given.file.stem}.inspect.png")
    figure = Figure(figsize=(DOUBLE, 2.8), layout="constrained")
    known, kind = figure.canvas.get_supported_filetypes(), picture.suffix.lower().lstrip(".")
    if kind not in known:
        raise InputError(f"-o {picture}: inspect writes a figure; expected a name that ends in {', '.join(known)}")
    _draw(figure, surface)
    write_aside(picture, lambda partial: figure.savefig(partial, dpi=RESOLUTION, format=kind))
    table, spectrum = picture.with_suffix(".csv"), surface.roughness.sample.spectrum
    columns = np.column_stack([spectrum.wavevectors, spectrum.density, spectrum.waves])
    form: dict[str, Any] = {
        "fmt": ("%.9g", "%.9g", "%g"),
        "delimiter": ",",
        "header": "q (1/m),C (m^4),waves",
        "comments": "",
    }
    write_aside(table, lambda partial: np.savetxt(partial, columns, **form))
    print(*lines, f"{picture} (map and spectrum), {table} (spectrum)", sep="\n")
    return DONE


def _surface(path: Path, overrides: Mapping[str, Any]) -> "tuple[SurfaceSection, Path, list[str]]":
    """Return the surface that a file has, the folder of its paths, and lines on it."""
    from contact_study.inputs.units import stress
    from contact_study.study.schema.bodies import ADDED_SECTIONS, composed
    from contact_study.study.schema.keys import bind
    from contact_study.study.schema.surface import SURFACES
    from contact_study.study.study import read_study

    if path.suffix.lower() == ".toml":
        study = read_study(path, overrides)
        case = study.cases[0]
        kinds = len({one.geometry for one in study.cases})
        which = f", at {case.label}, the first of {kinds} surfaces" if kinds > 1 else ""
        beside = {name: getattr(case, name).kind for name in ("form", *ADDED_SECTIONS)}
        more = "".join(f", {name} {kind}" for name, kind in beside.items() if kind != "none")
        lines = [f"{path}: surface of kind {case.surface.kind}{more}{which}"]
        if beside.pop("form") != "none" and (case.surface.rough or {*beside.values()} != {"none"}):
            lines.append("statistics and spectrum of the roughness, without the form")
        if case.material.counter_modulus is not None:
            lines.append(f"E* = {stress(case.solid.contact_modulus)}, combined of two elastic bodies")
        return case.geometry, case.directory, lines
    strangers = [dotted for dotted in overrides if not dotted.startswith("surface.")]
    if strangers:
        raise InputError(f"--{strangers[0]}: a map alone has no such key; inspect STUDY.toml takes it")
    table = {dotted.removeprefix("surface."): value for dotted, value in overrides.items()}
    section = bind(SURFACES, {**table, "kind": "file", "path": path.name}, "surface")
    return composed(section), path.parent, [f"{path}: heights in {section.measured(path.parent).unit}"]


def _draw(figure: "Figure", surface: "Surface") -> None:
    """Draw the map, coarsened if it is large, and the spectrum."""
    from matplotlib import rc_context

    from contact_study.plots.densities import draw_roughness
    from contact_study.plots.maps import draw_heights
    from contact_study.plots.style import STYLE

    with rc_context(STYLE):
        left, right = figure.subplots(1, 2)
    draw_heights(surface, surface.roughness.grid, left)
    draw_roughness(surface.roughness.sample, right)
