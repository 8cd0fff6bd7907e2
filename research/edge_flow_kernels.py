"""Other costs of a modulation in the edge flow, against the continuum's ensemble, as Markdown.

In second order a wave q on a half-space that a modulation p scatters gives way by <1/(K_|q+p| + c)>, the mean over
directions, as if its stiffness were κK: κ = 1/<1/(|q+p|/q + c/K)> − c/K. A kernel s X + t + (1 − t) b/(X + b) with
X = p²/q² is the edge flow's form of it. For three c it is given the exact growth for p → 0 and the exact value at
p = 2q (t = 0); the last one is fitted to that of c = K from p = q/2 to 8q with all three numbers. The simulations are
those of ``data/edge_flow_trial_surfaces.csv``; the theory gets the same surfaces.

python -m research.edge_flow_kernels --surfaces 6 --table data/edge_flow_kernels.csv   # minutes
python -m research.edge_flow_kernels --from data/edge_flow_kernels.csv
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import brentq, least_squares

from contact_study.study.case import Case, realise
from contact_study.study.study import make_study
from research.edge_flow_ensemble import PRESSURES, study
from scripts.harness import Option, head, row, tabulated
from theory import EdgeFlow, edge_flow
from theory.edge_flow.equilibrium import KERNEL

SIMULATIONS = Path(__file__).resolve().parent.parent / "data" / "edge_flow_trial_surfaces.csv"
SHOWN = (0.5, 1.0, 2.0, 4.0, 8.0)  # p/q at which κ is printed
PRESSURE = 1.0  # GPa, of the ratio of both pressures
Kernel = tuple[float, float, float]


def exact(wavenumber: np.ndarray | float, curvature: float) -> np.ndarray:
    """κ of a modulation p/q at c/K."""
    angles = (np.arange(4096) + 0.5) * np.pi / 4096
    p = np.asarray(wavenumber, dtype=float)[..., None]
    together = np.sqrt(1 + p**2 + 2 * p * np.cos(angles))
    return 1 / np.mean(1 / (together + curvature), axis=-1) - curvature


def rational(wavenumber: np.ndarray | float, kernel: Kernel) -> np.ndarray:
    """κ of a modulation p/q in the form of the edge flow."""
    slope, level, pole = kernel
    x = np.asarray(wavenumber) ** 2
    return slope * x + level + (1 - level) * pole / (x + pole)


def kernels() -> dict[str, Kernel]:
    """The kernels that are compared, by their words; the edge flow's own is the first."""
    found = {"the edge flow's": KERNEL}
    for words, curvature in (("c = 0", 0.0), ("c = K", 1.0), ("c = 1000 K", 1e3)):
        growth = 0.25 - 0.5 / (1 + curvature)  # of κ over X at X = 0
        aim = float(exact(2.0, curvature))
        pole = float(brentq(lambda b: rational(2.0, (growth + 1 / b, 0.0, b)) - aim, 0.1, 100.0))  # noqa: B023
        found[words] = (growth + 1 / pole, 0.0, pole)
    at = np.geomspace(0.5, 8.0, 40)
    fit = least_squares(
        lambda v: np.log(rational(at, (v[0], v[1], np.exp(v[2]))) / exact(at, 1.0)),
        [0.1, 0.0, 1.0],
        bounds=([0.0, -np.inf, -np.inf], np.inf),  # a slope below zero would be a cost below zero somewhere
    )
    found["c = K, fitted"] = (float(fit.x[0]), float(fit.x[1]), float(np.exp(fit.x[2])))
    return found


def ensemble(given: argparse.Namespace) -> pd.DataFrame:
    """Means over the surfaces: a kernel, a law and a pressure a row."""
    surfaces = given.surfaces
    simulated = pd.read_csv(SIMULATIONS)
    ratios, points = sorted(simulated["ratio"].unique()), int(simulated["points"].max())
    cases = make_study(study(surfaces, points, ratios)).cases
    every = kernels()
    found = []
    for number, case in enumerate(cases):
        print(f"{number + 1}/{len(cases)}", file=sys.stderr, flush=True)
        spectrum, ratio = realise(case).measured_spectrum(), ratios[number // surfaces]
        highest = max(1.1e9 * max(PRESSURES), spectrum_stress(spectrum, case))
        for words, kernel in every.items():
            flow = edge_flow(spectrum, case.solid, case.law, highest, kernel=kernel)
            for pressure in PRESSURES:
                found.append((words, ratio, pressure, *state_at(flow, case, 1e9 * pressure)))
    columns = ["model", "ratio", "pressure_GPa", "relative_contact_area", "mean_gap", "pressures"]
    table = pd.DataFrame(found, columns=columns).groupby(columns[:3], sort=False)
    return table.mean().assign(surfaces=table["mean_gap"].count()).reset_index()


def spectrum_stress(spectrum, case: Case) -> float:
    """Deviation of the stress in full contact (Pa)."""
    return float(np.sqrt(spectrum.full_contact_stress_variance(case.solid.stiffness)))


def state_at(flow: EdgeFlow, case: Case, pressure: float) -> tuple[float, float, float]:
    """Area, mean gap (m) and the mean local pressure over the pressure; no numbers where there is no state."""
    try:
        state = flow.at_pressure(pressure)
    except ValueError:
        return np.nan, np.nan, np.nan
    if not state.converged:
        return np.nan, np.nan, np.nan
    area, gap = state.fraction_below(case.contact_distance), state.mean_gap - case.law.equilibrium_distance
    return area, gap, state.mean_traction / state.pressure


def rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: mean and worst error in per cent from 0.2 GPa on, a kernel and a well depth a line."""
    at = "κ at p/q = " + ", ".join(f"{p:g}" for p in SHOWN)
    yield head("kernel", at, "well depth", "A", "ū", "local / mean pressure", "surfaces")
    simulated = pd.read_csv(SIMULATIONS)
    simulated = simulated[(simulated["model"] == "continuum") & (simulated["branch"] == "loading")]
    simulated = simulated[simulated["pressure_GPa"] >= 0.2]
    truth = simulated.pivot_table(index=["ratio", "pressure_GPa"], columns="quantity", values="mean")
    for words, kernel in kernels().items():
        own = table[(table["model"] == words) & (table["pressure_GPa"] >= 0.2)]
        values = ", ".join(f"{value:.2f}" for value in rational(np.array(SHOWN), kernel))
        for ratio, part in own.groupby("ratio"):
            means = part.set_index(["ratio", "pressure_GPa"])
            cells = []
            for name in ("relative_contact_area", "mean_gap"):
                error = 100 * (means[name] / truth[name].loc[means.index] - 1).abs()
                cells.append(f"{error.mean():.1f} ({error.max():.1f}) %" if error.notna().any() else "–")
            balance = float(means["pressures"].loc[(ratio, PRESSURE)])
            cells += [f"{balance:.2f}" if np.isfinite(balance) else "–", f"{part['surfaces'].min():.0f}"]
            yield row(words, values, f"{ratio:g} ε0", *cells)


main = tabulated(ensemble, rows, Option("--surfaces", 12, "number of surfaces, the first of the simulations' ones"))

if __name__ == "__main__":
    sys.exit(main())
