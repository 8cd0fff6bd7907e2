"""Persson's theory under every choice of its constants, beside a dataset of the continuum.

The scan covers α of the crack condition, β of the energy weight, the area on which adhesion acts (`theory.true_area`)
and a detachment stress limited to the law's largest tensile stress. A cell of the table is the mean magnitude of the
relative deviation of the contact area over the loading states, least and largest over β and the cap.

python -m research.persson_choices results/yang2008-paper/bem.nc
"""

import argparse
import itertools
import sys
import tomllib
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from contact_study.report.text.wording import listed, percent_of
from contact_study.study.case import Case, realise
from contact_study.study.study import make_study
from scripts.harness import Option, head, program, row
from theory import PerssonTheory

ALPHAS = (0.5, 1.0, 2.0, 4.0)
BETAS = (0.3, 0.4, 0.5, 1.0)
AREAS = ("persson", "none", "lattice")


@dataclass(frozen=True)
class Choice:
    """One choice of the constants, and how far it is from the continuum."""

    alpha: float
    beta: float
    true_area: str
    capped: bool
    deviation: float


def run(given: argparse.Namespace) -> None:
    with xr.open_dataset(given.continuum, decode_timedelta=False) as dataset:
        found = scan(dataset, given.continuum.parent)
    print(table(found))


def scan(dataset: xr.Dataset, folder: Path = Path()) -> dict[float, list[Choice]]:
    """Every choice at each well-depth ratio of a dataset of the continuum, by that ratio."""
    study = make_study(tomllib.loads(dataset.attrs["study_toml"]), folder)
    found = {}
    for case in study.cases:
        part = dataset.sel(well_depth_ratio=case.interaction.well_depth_ratio)
        fit = (part["converged"] == 1) & (part["detached"] != 1) & (part["branch"] == 0)
        pressures, areas = (part[name].values[fit.values] for name in ("applied_pressure", "relative_contact_area"))
        choices = itertools.product(ALPHAS, BETAS, AREAS, (False, True))
        found[case.interaction.well_depth_ratio] = [
            Choice(*choice, deviation(case, pressures, areas, *choice)) for choice in choices
        ]
    return found


def deviation(
    case: Case, pressures: np.ndarray, areas: np.ndarray, alpha: float, beta: float, true_area: str, capped: bool
) -> float:
    """Mean magnitude of the relative deviation of the contact area; NaN if some state does not converge."""
    theory = PerssonTheory(
        realise(case).measured_spectrum(),
        case.solid,
        case.law.work_of_adhesion,
        beta=beta,
        true_area=true_area,
        alpha=alpha,
        stress_cap=case.law.peak_tensile_stress if capped else np.inf,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        states = [theory.at_pressure(float(pressure)) for pressure in pressures]
    if not all(state.converged for state in states):
        return np.nan
    return float(np.mean(np.abs(np.array([state.relative_contact_area for state in states]) / areas - 1)))


def table(found: dict[float, list[Choice]]) -> str:
    """Markdown: α and the area that adheres down, adhesion across; below it the best choice of each."""
    ratios = list(found)
    lines = [head("α", "area", *(f"{ratio:g} ε₀" for ratio in ratios))]
    for alpha, area in itertools.product(ALPHAS, AREAS):
        cells = []
        for ratio in ratios:
            own = [each.deviation for each in found[ratio] if (each.alpha, each.true_area) == (alpha, area)]
            known = [value for value in own if np.isfinite(value)]
            ends = dict.fromkeys(percent_of(value) for value in (min(known), max(known))) if known else {"–": None}
            cells.append(" to ".join(ends) + (" *" if len(known) < len(own) else ""))
        lines.append(row(f"{alpha:g}", area, *cells))
    best = {ratio: min(found[ratio], key=lambda each: np.nan_to_num(each.deviation, nan=np.inf)) for ratio in ratios}
    words = listed(
        f"{percent_of(one.deviation)} at {ratio:g} ε₀ (α = {one.alpha:g}, β = {one.beta:g}, area "
        f"{one.true_area}, {'capped' if one.capped else 'no cap'})"
        for ratio, one in best.items()
    )
    missing = any(not np.isfinite(each.deviation) for own in found.values() for each in own)
    note = " Cells with a star leave out choices without a converged state at some pressure." if missing else ""
    return "\n".join([*lines, "", f"The least deviation of all {len(found[ratios[0]])} choices is {words}.{note}"])


main = program(run, Option("continuum", Path, "dataset of bem-adhesion over adhesion, one surface"))

if __name__ == "__main__":
    sys.exit(main())
