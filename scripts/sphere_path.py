"""A sphere brought into contact and off it again: jump-in, pull-off and work of separation against Maugis.

`docs/validation.md` explains the rows.

    python -m scripts.sphere_path --figure sphere_path.png
"""

import argparse
import sys

import numpy as np
import xarray as xr

import contact_study
from bem_adhesion import Dugdale
from bem_adhesion.adhesive.contact import reach
from contact_study import plots
from scripts.harness import FIGURE, Option, program, save, show
from theory import MaugisDugdale, maugis_of_tabor

# E* (Pa), reach (m) and work of adhesion (J/m²) of Dugdale's tension: scales, without consequence.
MODULUS, REACH, WORK = 1e9, 1e-9, 0.02
TABOR = 1.0
# Of the path: approaches in units of the reach, and the cell over the larger of contact and ring under tension.
APPROACHES = (-1.5, 8.0, -4.0)
CELL = 3.4


def run(given: argparse.Namespace) -> None:
    radius = TABOR**3 * MODULUS**2 * REACH**3 / WORK**2
    length = (3 * np.pi * WORK * radius**2 / (4 * MODULUS)) ** (1 / 3)
    size = CELL * 2 * length
    found = path(radius, size, given.points, given.resolution)
    unit = np.pi * WORK * radius / size**2
    maugis = MaugisDugdale.of_parameter(float(maugis_of_tabor(TABOR, relative_strength=1.0)))
    held, off = (float(found[f"pull_off_pressure{name}"]) / unit for name in ("", "_resolution_error"))
    at, step = (float(found[f"jump_in_separation{name}"]) for name in ("", "_resolution_error"))
    tip = size**2 / (12 * radius)  # over the heights' mean
    work = float(found["work_of_separation"]) * size**2
    scale = (WORK**5 * radius**4 / MODULUS**2) ** (1 / 3)
    ends = f"1 to {reach(Dugdale(WORK, REACH)) / REACH:.2f}"
    rows = (
        ("pull-off force / πwR", f"{held - off:.3f} to {held:.3f}", f"{maugis.pull_off_force:.3f}"),
        ("work of separation / (w⁵R⁴/E*²)^(1/3)", f"{work / scale:.2f}", f"{maugis_work(maugis):.2f}"),
        ("tip at jump-in / reach", f"{(at - step - tip) / REACH:.2f} to {(at - tip) / REACH:.2f}", ends),
        ("force at jump-in / πwR", f"{float(found['jump_in_pressure']) / unit:.3f}", "0"),
    )
    show(("", "path", "Maugis"), rows)
    if given.figure:
        save(plots.hysteresis_loop(found).figure, given.figure)


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


def maugis_work(sphere: MaugisDugdale) -> float:
    """∫−F dδ from no force to the least approach, over (w⁵R⁴/E*²)^(1/3).

    D. Maugis, J. Colloid Interface Sci. 150, 243 (1992); above λ = 0.94 the sphere lets go at that approach.
    """
    force, approach, _, held = sphere.curve(0.0, points=4000)
    # Forces in πwR, approaches in (3πw/4E*)^(2/3) R^(1/3).
    return float(np.trapezoid(-force[held], approach[held])) * np.pi * (3 * np.pi / 4) ** (2 / 3)


main = program(
    run,
    Option("--points", 64, "points along each side"),
    Option("--resolution", 0.005, "loading.resolution"),
    FIGURE,
)

if __name__ == "__main__":
    sys.exit(main())
