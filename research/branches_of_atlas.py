"""Which state a contact of the atlas is in: the same loop by equilibria, flow, creep and thermal motion.

Each condition is loaded from separation, pressed, and unloaded, one surface on the atlas' own grid, which resolves the
process zone. The ways from load to load:

- small steps: quasi-static, ten steps from one load to the next; all else is compared with these.
- large steps: quasi-static, one step.
- flow: motion of each point against the same friction; the load changes by that share of E* in the relaxation time.
- creep: the solid dissipates. A Maxwell branch of nine times the modulus relaxes until the elastic state is left.
- thermal: means of the canonical distribution of the grid's gaps, the chain of one load started from that before. The
  temperature moves a free surface by that share of the law's length. A wall has no forces to follow, so only the 10-4
  law has this way.

Rows that the file has already are not computed again.

    python -m research.branches_of_atlas --jumping --largest 216 --table data/branches_of_atlas.csv
    python -m research.branches_of_atlas --from data/branches_of_atlas.csv
"""

import argparse
import math
import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import constants

import contact_study
from bem_adhesion import rough_contact
from contact_study.atlas.design import JUMPING, LEAST_JUMP, MODULUS, SIZE, STRESS, WHOLE, Condition, design
from contact_study.atlas.loops import seeds_of, theory_study_of
from contact_study.inputs.errors import InputError
from contact_study.numerics.time_series import statistics_of
from contact_study.study.case import realise
from contact_study.study.study import make_study
from md_reference.block.condensed import SurfaceStiffness
from md_reference.interface.pairs import INSIDE
from md_reference.thermal.hmc import ThermalSampler
from scripts.harness import Option, head, minus, program, read_rows, row, write_rows

LOADS, PRELOAD = (0.05, 0.2, 0.8), 2.0  # over E* h'/2
LOOP = (*LOADS, PRELOAD, *LOADS[::-1])
STEPS = {"small steps": 10, "large steps": 1}
FLOWS = {"flow 1e-2": 1e-2, "flow 1e-3": 1e-3}
THERMAL = {"thermal 0.05": 0.05, "thermal 0.1": 0.1}
WAYS = (*STEPS, *FLOWS, "creep", *THERMAL)
# The load changes in a relaxation time and rests for these; the contact creeps in ten.
_BRANCH, _TIMES, _TIME_STEPS = 9, (1, 1, 10, 100, 1000), 5
_EQUILIBRATION, _TRAJECTORIES = 120, 120
SAME, ERRORS = 1e-3, 4.0  # of area and of mean gap over the rms height; standard errors of thermal means beside it
SHOWN = 8  # states that differ most
COLUMNS = ["condition", "points", "jump_ratio", "law", "solid", "way", "branch", "load"]
COLUMNS += ["area", "gap", "area_error", "gap_error", "converged", "seconds"]
STATE = ["condition", "branch", "load"]


def run(given: argparse.Namespace) -> None:
    table = read_rows(given.source or given.table, COLUMNS)
    if given.source is None:
        for condition, way in wanted(given):
            if not ((table.condition == condition.number) & (table.way == way)).any():
                found = pd.DataFrame(states(condition, way))
                table = found if table.empty else pd.concat([table, found], ignore_index=True)
                write_rows(table, given.table)
                print(f"{condition.number}, {condition.points}²: {way}", file=sys.stderr, flush=True)
    print("\n".join(lines(table)))


def wanted(given: argparse.Namespace) -> Iterator[tuple[Condition, str]]:
    """The conditions from the smallest grid on, and the ways that each has."""
    taken, _ = design(JUMPING, least_jump=LEAST_JUMP) if given.jumping else design(WHOLE)
    for condition in sorted(taken, key=lambda one: (one.points, one.number)):
        for way in given.ways if condition.points <= given.largest else ():
            walled, layer = condition.traction_law.has_wall, condition.solid != "half_space"
            if not (way in THERMAL and walled) and not (way == "creep" and layer):
                yield condition, way


def states(condition: Condition, way: str) -> list[dict[str, Any]]:
    """The states of a loop but that under the preload, by one way."""
    began = time.process_time()
    found = list(thermal(condition, THERMAL[way]) if way in THERMAL else settled(condition, way))
    seconds = time.process_time() - began
    rows = []
    for number, (load, state) in enumerate(zip(LOOP, found, strict=True)):
        branch = "unloading" if number > len(LOADS) else "loading"
        about = condition.number, condition.points, condition.jump_ratio, condition.law, condition.solid, way
        rows.append(dict(zip(COLUMNS, (*about, branch, load, *state, seconds), strict=True)))
    return [one for one in rows if one["load"] != PRELOAD]


def settled(condition: Condition, way: str) -> Iterator[tuple[float, ...]]:
    """Each state of the loop by a way without temperature, from the campaign."""
    ends = STRESS * np.array(LOOP)
    repeats = STEPS.get(way, len(_TIMES) if way == "creep" else 1)
    path = np.repeat(ends, repeats)
    if way in STEPS:
        shares = np.arange(1, repeats + 1) / repeats
        starts = np.append(0.0, ends[:-1])
        path = (starts[:, None] * (1 - shares) + ends[:, None] * shares).ravel()
    table = _study(condition, path.tolist())
    if way in FLOWS:
        table["solver"]["path"] = "overdamped"
        table["overdamped"] = {"loading_rate": FLOWS[way]}
    if way == "creep":
        branch = _BRANCH * table["material"]["youngs_modulus"]
        table["elasticity"] = {"kind": "viscoelastic", "branch_youngs_moduli": [branch], "relaxation_times": [1.0]}
        table["loading"] |= {"duration": list(_TIMES) * len(LOOP), "time_steps": _TIME_STEPS}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of states that did not converge: rows have flags
        dataset = contact_study.run(table, "continuum", workers=1)
    for number in range(len(LOOP)):
        state = dataset.isel(step=(number + 1) * repeats - 1)
        area, gap = state.relative_contact_area.item(), state.mean_gap.item() / condition.spectrum.rms_height
        yield area, gap, 0.0, 0.0, state.converged.item()


def _study(condition: Condition, path: list[float]) -> dict[str, Any]:
    """A condition's first surface under a path of pressures (Pa)."""
    table = theory_study_of(condition, seeds_of(condition, 1)[0], path)
    del table["theory"]
    table["solver"] = {"threads": 1, "max_iterations": 20000}
    return table


class Points:
    """The law between the grid's points and the rigid surface, as the sampler of atoms takes it: forces along z."""

    def __init__(self, condition: Condition, height: np.ndarray):
        self.law, self.height, self.cell = condition.traction_law, height, (SIZE / len(height)) ** 2

    def evaluate(self, displacement: np.ndarray, force: np.ndarray, hessian: np.ndarray | None = None) -> float:
        """Write forces (N) and second derivatives (N/m), and return the energy (J), infinite inside the surface."""
        gap = displacement[2] - self.height
        if not gap.min() > INSIDE * self.law.length:
            return math.inf
        force[:2], force[2] = 0.0, -self.cell * self.law.traction(gap)
        if hessian is not None:
            hessian[...] = 0.0
            hessian[2] = self.cell * self.law.stiffness(gap)
        return self.cell * float(np.sum(self.law.potential(gap)))


def thermal(condition: Condition, share: float) -> Iterator[tuple[float, ...]]:
    """The mean state of each load, at the temperature that moves the free surface by a share of the law's length.

    The sampler is that of the atoms. Along x and y its points are free: their waves have the half-space's stiffness.
    """
    case = make_study(_study(condition, [STRESS])).cases[0]
    surface, solid, law = realise(case), case.solid, case.law
    height, grid = surface.sampled, surface.grid
    cell = (SIZE / len(height)) ** 2
    stiffness, moving = np.zeros((6, *grid.wavenumber.shape)), grid.wavenumber > 0
    stiffness[:2] = 0.5 * MODULUS * cell * grid.wavenumber
    stiffness[2, moving] = cell * solid.stiffness(grid.wavenumber[moving])
    # <u²> = k_BT / n Σ 1/S over the waves of n points, but for the mean.
    compliance = float(np.sum(grid.multiplicity / np.where(moving, stiffness[2], np.inf))) / height.size
    temperature = (share * law.length) ** 2 / compliance / constants.k
    block = SurfaceStiffness(grid, math.sqrt(cell), stiffness)
    contact = rough_contact(height, SIZE, solid, law)
    displacement = np.zeros((3, *height.shape))
    displacement[2] = contact.step(contact.separated(), LOOP[0] * STRESS).gap + height
    generator = np.random.default_rng(condition.number)
    points: Any = Points(condition, height)
    for load in LOOP:
        sampler = ThermalSampler(block, points, MODULUS, temperature, load * STRESS)
        chain = sampler.equilibrated(sampler.start(displacement), _EQUILIBRATION, generator)
        series = np.empty((_TRAJECTORIES, 2))
        for state in series:
            chain = sampler.next(chain, generator)
            displacement = sampler.displacement(chain)
            gap = displacement[2] - height
            mean_gap = gap.mean() - law.equilibrium_distance
            state[:] = np.mean(gap < law.contact_distance), mean_gap / condition.spectrum.rms_height
        found = statistics_of(series)
        yield *found.mean, *found.standard_error, int(found.resolved.all())


def compared(table: pd.DataFrame) -> pd.DataFrame:
    """All ways but small steps, with their differences from these, and whether the condition has hysteresis by them."""
    reference = table[table.way == "small steps"].set_index(STATE)
    own = reference.rename(columns={"area": "area_steps", "gap": "gap_steps"})[["area_steps", "gap_steps"]]
    others = table[table.way != "small steps"].join(own, on=STATE).dropna(subset="area_steps")
    others["d_area"], others["d_gap"] = others.area - others.area_steps, others.gap - others.gap_steps
    within = (others[f"d_{name}"].abs() < SAME + ERRORS * others[f"{name}_error"] for name in ("area", "gap"))
    others["same"] = np.logical_and(*within)
    opening = opened(table, "small steps").groupby("condition").agg(lambda change: change.abs().max())
    return others.assign(hysteretic=others.condition.map(opening) >= SAME)


def opened(table: pd.DataFrame, way: str) -> pd.Series:
    """The area on unloading minus that on loading, by condition and load."""
    rows = table[table.way == way].set_index(["condition", "load"])
    return rows.area[rows.branch == "unloading"] - rows.area[rows.branch == "loading"]


def lines(table: pd.DataFrame) -> Iterator[str]:
    """How often each way ends in the state of small steps, by how much not, its hysteresis, and where ways part."""
    others = compared(table)
    if others.empty:
        raise InputError("nothing to print: no condition has been run by small steps and by another way")
    states = "same on loading", "same on unloading", "largest ΔA", "largest Δū/h"
    opening = "A unloading − loading: small steps", "this way"
    yield head("hysteresis", "way", "conditions", "grids", *states, *opening)
    for hysteretic, way in ((flag, way) for flag in (True, False) for way in WAYS):
        own = others[(others.hysteretic == hysteretic) & (others.way == way)]
        if own.empty:
            continue
        same = [own.same[own.branch == branch] for branch in ("loading", "unloading")]
        counts = [f"{one.sum()} of {one.size}" for one in same]
        largest = [own[name].iloc[own[name].abs().argmax()] for name in ("d_area", "d_gap")]
        mine = opened(own, way)
        steps = opened(table, "small steps").reindex(mine.index)
        cells = [minus(f"{value:+.4f}") for value in (*largest, steps.mean(), mine.mean())]
        unsettled = "" if own.converged.all() else f" ({(own.converged == 0).sum()} states not settled)"
        number, grids = own.condition.nunique(), f"{own.points.min()}²…{own.points.max()}²"
        yield row("yes" if hysteretic else "no", way + unsettled, number, grids, *counts, *cells)
    parted = others[~others.same & ~others.way.isin(list(THERMAL))]
    order = parted.d_area.abs().sort_values(ascending=False, kind="stable").index
    most = f"; the {min(SHOWN, len(parted))} that do most:\n" if len(parted) else "."
    yield f"\n{len(parted)} states without temperature part from small steps{most}"
    if parted.empty:
        return
    yield head("condition", "grid", "law", "solid", "λ/onset", "way", "branch", "load", "A small steps", "ΔA", "Δū/h")
    for one in parted.loc[order[:SHOWN]].itertuples():
        about = one.condition, f"{one.points}²", one.law, one.solid, f"{one.jump_ratio:.2f}", one.way, one.branch
        yield row(*about, one.load, f"{one.area_steps:.4f}", minus(f"{one.d_area:+.4f}"), minus(f"{one.d_gap:+.4f}"))


main = program(
    run,
    Option("--jumping", False, "conditions whose mean asperity jumps, not the whole design"),
    Option("--largest", 80, "grid to run, in points along each side"),
    Option("--ways", ["small steps", "large steps", "flow 1e-2", "creep", *THERMAL], "", choices=WAYS),
    Option("--table", Path, "CSV to add to"),
    Option("--from", Path, "CSV to print, in place of a run"),
    interrupted="finished rows are kept",
)

if __name__ == "__main__":
    sys.exit(main())
