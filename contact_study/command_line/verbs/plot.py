"""Draw one picture of a dataset."""

import argparse
import sys
from pathlib import Path
from typing import Any

from contact_study.command_line.frame import epilog
from contact_study.command_line.selection import add_selection, one_case, one_step, opened, pair, selected
from contact_study.inputs.errors import DONE, InputError

# Of a picture: its function in contact_study.plots, whether it shows one case and one load step alone, and what it is.
PICTURES = {
    "area": ("contact_area", False, False, "contact area against pressure"),
    "gap": ("mean_gap", False, False, "mean gap against pressure"),
    "loop": ("hysteresis_loop", True, False, "pressure against separation, loading and unloading"),
    "force": ("force_curve", False, False, "force against displacement, approach and retraction"),
    "map": ("gap_map", True, True, "local gap"),
    "pressure": ("pressure_map", True, True, "local pressure"),
    "patches": ("patch_sizes", True, True, "number density of the patches' areas"),
    "leakage": ("leakage", False, False, "hydraulic gap against contact area (output.leakage)"),
    "contact": ("contact_map", True, True, "contact and its clusters"),
    "section": ("section", True, True, "section through the interface"),
    "heights": ("height_map", True, False, "the rough surface"),
    "gaps": ("gap_distribution", True, True, "distribution of the gap"),
    "stresses": ("stress_distribution", True, True, "distribution of the stress"),
    "spectrum": ("surface_spectrum", True, False, "power spectrum of the surface"),
    "atoms": ("atoms", True, True, "one row of atoms"),
    "magnified": ("area_by_magnification", True, True, "contact area against magnification (Persson)"),
    "detachment": ("detachment_stress", True, True, "detachment stress against magnification (Persson)"),
    "criteria": ("criteria_map", False, False, "criteria of stickiness (theories)"),
    "tornado": ("tornado", False, False, "what each uncertain key does to the answers ([uncertainty])"),
}
USAGE = "FILE.nc [PICTURE] [-o PICTURE.png] [--case KEY=VALUE] [--step N]"
_ONE = "bem-adhesion plot bem.nc map --case well_depth_ratio=4 --step -1 -o gap.pdf"
_LIST = "".join(f"  {word:12}{words}\n" for word, (*_, words) in PICTURES.items())
END = f"pictures:\n{_LIST}\n{epilog(_ONE)}"


def add(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, metavar="FILE.nc", help="dataset of a run")
    parser.add_argument("picture", nargs="?", default="area", choices=PICTURES, metavar="PICTURE", help="default: area")
    parser.add_argument("-o", "--output", metavar="FILE", help="png, pdf or svg to write; default: FILE.PICTURE.png")
    add_selection(parser)
    of_force = parser.add_argument_group("options of the picture force")
    words = "measured force curves, as text or of a microscope"
    of_force.add_argument("--measured", nargs="+", type=Path, default=[], metavar="FILE", help=words)
    words = "how to read them, such as positive_force=tension"
    of_force.add_argument("--reading", action="append", default=[], metavar="KEY=VALUE", help=words)
    words = "theories of a smooth sphere: hertz, jkr, dmt, maugis"
    of_force.add_argument("--theory", nargs="+", default=[], metavar="NAME", help=words)
    of_force.add_argument("--against", metavar="NAME", help="displacement (default), contact_radius, approach")


def run(given: argparse.Namespace) -> int:
    from contact_study import plots
    from contact_study.campaign.store.files import check_inputs_kept, named_file, writable_output, write_aside
    from contact_study.plots.style import RESOLUTION, format_of

    output = named_file(given.output or given.file.with_name(f"{given.file.stem}.{given.picture}.png"))
    kind = format_of(output, "-o")
    check_inputs_kept(output, [given.file, *given.measured])
    name, single_case, single_step, _ = PICTURES[given.picture]
    options = _of_force(given)
    with opened(given.file) as dataset:
        shown, chosen = selected(dataset, given.case, given.step), list[str]()
        for narrowed in [one_case] * single_case + [one_step] * single_step:
            shown, words = narrowed(shown)
            chosen += words
        try:
            drawn = getattr(plots, name)(shown, **options)
        except ValueError as error:
            raise InputError(f"{given.file}: {error}") from None
        writable_output(output)
        write_aside(output, lambda partial: drawn.figure.savefig(partial, dpi=RESOLUTION, format=kind))
    if chosen:
        print(f"{given.command}: shown is {', '.join(chosen)}; --case and --step choose others", file=sys.stderr)
    print(output)
    return DONE


def _of_force(given: argparse.Namespace) -> dict[str, Any]:
    """Arguments of the picture of a force curve; InputError where another picture is asked for."""
    asked = {"--measured": given.measured, "--reading": given.reading, "--theory": given.theory}
    used = [option for option, value in (asked | {"--against": given.against}).items() if value]
    if used and given.picture != "force":
        raise InputError(f"{used[0]}: belongs to the picture force; give: plot {given.file} force {used[0]} ...")
    if given.reading and not given.measured:
        raise InputError("--reading: says how to read measured curves; give them by --measured FILE")
    if not used:
        return {}
    from contact_study import read_force_curve

    reading = dict(pair(words, "--reading") for words in given.reading)
    curves = [read_force_curve(path, **reading) for path in given.measured]
    return {"measured": curves, "theories": given.theory, **({"against": given.against} if given.against else {})}
