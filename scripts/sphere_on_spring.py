"""A sphere pulled off by machines of several stiffnesses, on several grids, against Maugis and JKR.

`docs/validation.md` explains the columns.

    python -m scripts.sphere_on_spring --figure sphere_on_spring.png
"""

import argparse
import math
import sys
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr

import contact_study
from contact_study import plots
from contact_study.plots.force_curves import force_states
from scripts.harness import FIGURE, Option, head, program, row, save
from theory import JKR, MaugisDugdale, SphereTheory

# E* (Pa), reach (m) and work of adhesion (J/m²) of Dugdale's tension: scales, without consequence.
MODULUS, REACH, WORK = 1e9, 1e-9, 0.02
TABOR = 1.0
RADIUS = TABOR**3 * MODULUS**2 * REACH**3 / WORK**2
PULL = math.pi * WORK * RADIUS
JKR_SPHERE = JKR(RADIUS, MODULUS, WORK)
MAUGIS = MaugisDugdale(RADIUS, MODULUS, WORK, WORK / REACH)
RADIUS_AT_REST = JKR_SPHERE.at_force(0.0)[2]
CELL = 3.4 * RADIUS_AT_REST


def run(given: argparse.Namespace) -> None:
    titles = "points", "k / 2E*a₀", "pull-off / πwR", "Maugis", "detached at / reach", "Maugis", "energy", "a₀"
    print(head(*titles), flush=True)
    found: xr.Dataset | None = None
    for points in given.points:
        rest = contact_study.run(study(points, {"path": [f"{PULL} N", "0 N"]}), "continuum")
        wide = float(rest["contact_radius"][-1]) / MAUGIS.at_force(0.0)[2] - 1
        for share in given.stiffness:
            stiffness = share * 2 * MODULUS * RADIUS_AT_REST
            found = contact_study.run(study(points, loading(stiffness, given.resolution)), "continuum")
            print(row(str(points), f"{share:g}", *compared(found, stiffness), f"{100 * wide:+.1f} %"), flush=True)
    if given.figure and found is not None:
        save(plots.force_curve(found, against="approach").figure, given.figure)
    force, radius = (JKR_SPHERE.pull_off_force / PULL, RADIUS_AT_REST / MAUGIS.at_force(0.0)[2] - 1)
    print(f"\nJKR: pull-off {-force:.3f} πwR, a₀ {100 * radius:+.1f} % of Maugis.")


def loading(stiffness: float, resolution: float) -> dict[str, Any]:
    """A path of the machine that presses to πwR and pulls beyond its largest extension (N/m)."""
    most = 2 * PULL / stiffness
    path = [-1.5 * REACH, 8 * REACH + most, -6 * REACH - most]
    own = {"control": "approach", "path": path, "machine_stiffness": stiffness, "trigger_force": PULL}
    return {**own, "adaptive": True, "resolution": resolution}


def study(points: int, loading: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "surface": {"kind": "sphere", "size": CELL, "shape": [points, points], "radius": RADIUS},
        "material": {"youngs_modulus": MODULUS, "poissons_ratio": 0.0},
        "elasticity": {"boundary": "free"},
        "interaction": {"law": "dugdale", "work_of_adhesion": WORK, "length": REACH},
        "loading": loading,
    }


def compared(found: xr.Dataset, stiffness: float) -> Iterator[str]:
    """Pull-off force, approach at which the machine detaches, and its work, of the path and of Maugis."""
    held, off = (-float(found[f"pull_off_force{end}"]) / PULL for end in ("", "_resolution_error"))
    yield f"{held:.3f} to {held - off:.3f}"
    yield f"{-MAUGIS.pull_off_force / PULL:.3f}"
    approach, force, outwards = force_states(found, "approach")
    last = int(np.flatnonzero(outwards & (force < -0.1 * PULL))[-1])
    yield f"{approach[last] / REACH:.2f} to {approach[last + 1] / REACH:.2f}"
    exact, work = detachment(MAUGIS, stiffness)
    yield f"{exact / REACH:.2f}"
    yield f"{100 * (float(found['separation_energy']) / work - 1):+.1f} %"


def detachment(sphere: SphereTheory, stiffness: float) -> tuple[float, float]:
    """Approach at which a machine (N/m) detaches a sphere (m): the fold of δ + F/k; and its work from F = 0 on (J)."""
    curve = sphere.curve(PULL, 20_000)
    machine = curve.displacement + curve.force / stiffness
    fold = int(np.argmin(machine))
    pulled = (curve.force < 0) & (np.arange(machine.size) >= fold)
    return float(machine[fold]), float(np.trapezoid(-curve.force[pulled], machine[pulled]))


main = program(
    run,
    Option("--points", [32, 64, 96], "points along each side"),
    Option("--stiffness", [10.0, 1.0, 0.1], "stiffnesses of the machine over 2 E* a₀"),
    Option("--resolution", 0.02, "loading.resolution"),
    FIGURE,
)

if __name__ == "__main__":
    sys.exit(main())
