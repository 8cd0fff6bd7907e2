"""A sphere brought into contact and off it again: jump-in, pull-off and work of separation against Maugis.

`docs/validation.md` explains the rows.

    python -m scripts.sphere_path --figure sphere_path.png
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

import contact_study
from bem_adhesion import Dugdale
from bem_adhesion.adhesive.contact import reach
from contact_study import plots
from contact_study.campaign.command_line.command import Parser, guarded
from contact_study.plots.style import RESOLUTION
from theory.references import maugis_dugdale_contact, maugis_dugdale_pull_off

# E* (Pa), reach (m) and work of adhesion (J/m²) of Dugdale's tension: scales, without consequence.
MODULUS, REACH, WORK = 1e9, 1e-9, 0.02
TABOR = 1.0
# Of the path: approaches in units of the reach, and the cell over the larger of contact and ring under tension.
APPROACHES = (-1.5, 8.0, -4.0)
CELL = 3.4


def main(arguments: Sequence[str] | None = None) -> int:
    return guarded("sphere_path", lambda: _main(arguments), interrupted="nothing is written")


def parser() -> Parser:
    made = Parser(
        description=__doc__.splitlines()[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter, allow_abbrev=False
    )
    made.add_argument("--points", type=int, default=64, help="points along each side")
    made.add_argument("--resolution", type=float, default=0.005, help="loading.resolution")
    made.add_argument("--figure", type=Path, help="draw the loop, too")
    return made


def _main(arguments: Sequence[str] | None) -> int:
    given = parser().parse_args(arguments)
    radius = TABOR**3 * MODULUS**2 * REACH**3 / WORK**2
    length = (3 * np.pi * WORK * radius**2 / (4 * MODULUS)) ** (1 / 3)
    size = CELL * 2 * length
    found = path(radius, size, given.points, given.resolution)
    unit = np.pi * WORK * radius / size**2
    parameter = 2 * TABOR * (9 / (16 * np.pi)) ** (1 / 3)
    held, off = (float(found[f"pull_off_pressure{name}"]) / unit for name in ("", "_resolution_error"))
    at, step = (float(found[f"jump_in_separation{name}"]) for name in ("", "_resolution_error"))
    tip = size**2 / (12 * radius)  # over the heights' mean
    work = float(found["work_of_separation"]) * size**2
    scale = (WORK**5 * radius**4 / MODULUS**2) ** (1 / 3)
    print("| | path | Maugis |\n|---|---|---|")
    print(f"| pull-off force / πwR | {held - off:.3f} to {held:.3f} | {-maugis_dugdale_pull_off(parameter):.3f} |")
    print(f"| work of separation / (w⁵R⁴/E*²)^(1/3) | {work / scale:.2f} | {maugis_work(parameter):.2f} |")
    ends = f"1 to {reach(Dugdale(WORK, REACH)) / REACH:.2f}"
    print(f"| tip at jump-in / reach | {(at - step - tip) / REACH:.2f} to {(at - tip) / REACH:.2f} | {ends} |")
    print(f"| force at jump-in / πwR | {float(found['jump_in_pressure']) / unit:.3f} | 0 |")
    if given.figure:
        plots.hysteresis_loop(found).figure.savefig(given.figure, dpi=RESOLUTION)
        print(given.figure, file=sys.stderr)
    return 0


def path(radius: float, size: float, points: int, resolution: float) -> xr.Dataset:
    """The sphere's dataset under a prescribed approach, in steps of the path's own."""
    return contact_study.run(
        {
            "surface": {"kind": "sphere", "size": size, "shape": [points, points], "radius": radius},
            "material": {"youngs_modulus": MODULUS, "poissons_ratio": 0.0},
            "elasticity": {"boundary": "free"},
            "interaction": {"law": "dugdale", "work_of_adhesion": WORK, "length": REACH},
            "loading": {
                "path": [approach * REACH for approach in APPROACHES],
                "control": "approach",
                "adaptive": True,
                "resolution": resolution,
            },
        },
        "continuum",
    )


def maugis_work(parameter: float) -> float:
    """∫−F dδ from no force to the least approach, over (w⁵R⁴/E*²)^(1/3).

    D. Maugis, J. Colloid Interface Sci. 150, 243 (1992); above λ = 0.94 the sphere lets go at that approach.
    """
    zone = np.exp(np.linspace(-9, 9, 20_000))
    force, a = maugis_dugdale_contact(parameter, zone)
    approach = a**2 - 4 / 3 * parameter * a * np.sqrt(zone * (zone + 2))
    pulled = (force < 0) & (np.arange(zone.size) <= np.argmin(approach))
    # Forces in πwR, approaches in (3πw/4E*)^(2/3) R^(1/3).
    return float(np.trapezoid(-force[pulled], -approach[pulled])) * np.pi * (3 * np.pi / 4) ** (2 / 3)


if __name__ == "__main__":
    sys.exit(main())
