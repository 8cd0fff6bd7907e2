"""Hysteresis of the contact atlas beside two forms in Maugis' number that were fitted to other loops.

Γ_D = 1 + D/(Δγ ΔA), D the loss from the lightest pressure to the largest preload and back, ΔA the change of area.

python -m scripts.validate_hysteresis data/contact_atlas_tenth.nc
"""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from contact_study.physics.spheres.jkr import jkr_contact_radius
from contact_study.physics.spheres.numbers import maugis_parameter
from scripts.contact_atlas import AREA, DATA, LIGHTEST, deepest, read, solid_of, stress_of
from scripts.harness import Option, program, show

# Maugis' number at which the loop of one asperity opens under a given separation, by law.
OPENS = {"lennard_jones_10_4": 0.96, "exponential": 1.14, "dugdale": 0.89}


class Hysteresis(NamedTuple):
    """Measured and predicted apparent work of adhesion on unloading over that on loading, of one deepest loop."""

    condition: int
    surface: int
    law: str
    solid: str
    adhesion: float  # θ
    ratio: float  # x = λ/λ₁
    measured: float  # Γ_D = 1 + D/(Δγ ΔA)
    jumps: float  # the same of the jumps that adaptive steps found one by one
    candidate: float
    quadratic: float


def run(given: argparse.Namespace) -> None:
    """Print the apparent work of adhesion of the deepest loops, and errors of two forms fitted to other loops."""
    found = [loop for path in given.files for loop in loops_of(read(path))]
    groups: dict[str, Callable[[Hysteresis], bool]] = {
        "all": lambda one: True,
        "x < 1.14": lambda one: one.ratio < 1.14,
        "x ≥ 1.14": lambda one: one.ratio >= 1.14,
        "half-spaces, θ < 1": lambda one: one.solid == "half_space" and one.adhesion < 1,
        "θ ≥ 1": lambda one: one.adhesion >= 1,
    }
    rows = []
    for words, holds in groups.items():
        chosen = [one for one in found if holds(one)]
        if not chosen:
            continue
        measured, *others = np.array([(one.measured, one.candidate, one.quadratic, 1.0) for one in chosen]).T
        errors = (np.abs(other - measured) for other in others)
        cells = (f"{error.mean():.3f} ({error.max():.2f})" for error in errors)
        rows.append((words, len(chosen), f"{measured.min():.2f}…{measured.max():.2f}", *cells))
    show(("loops", "number", "Γ_D", "error of the cubic form: mean (worst)", "of the quadratic form", "of Γ = 1"), rows)
    shown = [one for one in found if max(one.measured, one.candidate, one.quadratic) > 1.02]
    if not shown:
        return
    print()
    show(
        ("condition", "law", "solid", "θ", "x", "Γ_D", "by large jumps", "cubic", "quadratic"),
        (
            (
                one.condition,
                one.law,
                one.solid,
                f"{one.adhesion:.2f}",
                f"{one.ratio:.2f}",
                f"{one.measured:.3f}",
                f"{one.jumps:.3f}",
                f"{one.candidate:.3f}",
                f"{one.quadratic:.3f}",
            )
            for one in sorted(shown, key=lambda one: one.ratio)
        ),
    )


def loops_of(data: xr.Dataset) -> list[Hysteresis]:
    """Measure Γ_D = 1 + D/(Δγ ΔA) of the deepest loops, from the lightest pressure and back, and predict it.

    Both forms, ln Γ = 0.073 c^0.7 (x³ − 1.14³)₊ and Γ − 1 = 0.089 (x² − 1.28²)₊, were fitted to other loops.
    """
    found = []
    for one in deepest(data):
        law, modulus, work = str(one["law"].values), float(one["contact_modulus"]), float(one["work_of_adhesion"])
        radius, slope = 1 / float(one["rms_curvature"]), float(one["rms_slope"])
        pressure = one["mean_pressure"].values / stress_of(one)
        there = np.flatnonzero(np.isfinite(pressure))
        pressure, turn = pressure[there], int(np.argmax(pressure[there]))
        ways = {name: one[name].values[there] for name in (AREA, "dissipated_energy", "unaccounted_work")}
        start, end = _crossing(pressure[: turn + 1][::-1]), _crossing(pressure[turn:])
        if start is None or end is None:
            continue
        begun = {name: _at(values[: turn + 1][::-1], start) for name, values in ways.items()}
        back = {name: _at(values[turn:], end) for name, values in ways.items()}
        change = work * (ways[AREA][turn] - begun[AREA])
        jumps = back["dissipated_energy"] - begun["dissipated_energy"]
        lost = jumps + back["unaccounted_work"] - begun["unaccounted_work"]
        ratio = float(maugis_parameter(radius, modulus, work, float(one["peak_tensile_stress"]))) / OPENS[law]
        contact = float(jkr_contact_radius(0.0, radius, modulus, work))
        covered = 0.023 * (2 / (radius * slope)) ** 2 * np.pi * contact**2
        found.append(
            Hysteresis(
                int(one["condition"]),
                int(one["surface"]),
                law,
                solid_of(one),
                float(one["relative_adhesion"]),
                ratio,
                1 + lost / change,
                1 + jumps / change,
                float(np.exp(0.073 * covered**0.7 * max(ratio**3 - 1.14**3, 0.0))),
                1 + 0.089 * max(ratio**2 - 1.28**2, 0.0),
            )
        )
    return found


def _crossing(pressure: np.ndarray) -> float | None:
    """Find the place, counted from the turning point, where a falling pressure passes the lightest one."""
    below = np.flatnonzero(pressure < LIGHTEST)
    if not below.size or not below[0]:
        return None
    after = int(below[0])
    share = (pressure[after - 1] - LIGHTEST) / (pressure[after - 1] - pressure[after])
    return float(after - 1 + share)


def _at(values: np.ndarray, place: float) -> float:
    return float(np.interp(place, np.arange(values.size), values))


main = program(run, Option("files", [DATA], "datasets of the atlas", nargs="*", type=Path))

if __name__ == "__main__":
    sys.exit(main())
