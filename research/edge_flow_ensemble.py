r"""Errors of the theories of the local gap against the continuum on an ensemble of surfaces, as Markdown.

The surfaces are the paper's, of realised rms height; the theories know each surface's own spectrum. Loading from
separation and the way back; the errors are those of ensemble means at equal pressure.
Twenty-four surfaces take twenty minutes.

python -m research.edge_flow_ensemble                          # six surfaces of 128 × 128 points
python -m research.edge_flow_ensemble --surfaces 24 --points 256 --ratios 0.5 1 2 4 6 8 --table \
    data/edge_flow_ensemble.csv
python -m research.edge_flow_ensemble --from data/edge_flow_ensemble.csv
python -m research.edge_flow_ensemble --settings --surfaces 12 --points 256 --table data/edge_flow_settings.csv
python -m research.edge_flow_ensemble --settings --from data/edge_flow_settings.csv   # other spectra and laws
"""

import argparse
import itertools
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

import contact_study
from contact_study.study.study import read_study

PAPER = Path(__file__).resolve().parent.parent / "data" / "yang2008.toml"
PRESSURES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)  # GPa
WEAK = 2.0  # well depths, in units of ε0, that stand in the first rows
THEORIES = ("gap_flow", "edge_flow")
BRANCHES = ("loading", "unloading")
# Of what the lines of the paper's setting are means.
SHARES = (
    ("loading", PRESSURES[1:]),
    ("loading", PRESSURES[:1]),
    ("loading", PRESSURES[-1:]),
    ("unloading", PRESSURES[1:]),
)
SHOWN = {"relative_contact_area": "A", "mean_gap": "ū"}
# What other settings change, and their well depths in units of ε0: contact edges want four grid points, and the
# shortest waves some ten.
SETTINGS: dict[str, tuple[dict[str, dict[str, Any]], list[float]]] = {
    "H = 0.5": ({"surface": {"hurst_exponent": 0.5}}, [1.0, 4.0]),
    "half the range": ({"interaction": {"length": "1.64 angstrom", "contact_distance": "1.84 angstrom"}}, [0.5, 2.0]),
    "9-3 attraction": ({"interaction": {"law": "lennard_jones_9_3"}}, [1.0, 4.0]),
    "H = 0.9, cutoff 48": (
        {"surface": {"hurst_exponent": 0.9, "cutoff_mode": 48, "shape": [512, 512]}},
        [1.0, 4.0, 8.0],
    ),
}


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--surfaces", type=int, default=6, help="number of surfaces")
    made.add_argument("--points", type=int, default=128, help="grid points along each side")
    made.add_argument("--ratios", type=float, nargs="+", default=[1.0, 4.0, 8.0], help="well depths in units of ε0")
    made.add_argument(
        "--settings", nargs="*", choices=list(SETTINGS), metavar="NAME", help="other spectra and laws, by default all"
    )
    made.add_argument("--table", type=Path, help="CSV to write the ensemble's means to")
    made.add_argument("--from", type=Path, dest="source", help="CSV to read them from, in place of a run")
    return made


def study(surfaces: int, points: int, ratios: Sequence[float], setting: str | None = None) -> dict[str, Any]:
    """The study file's content: the paper's surface and solid."""
    paper = read_study(PAPER).table
    table: dict[str, Any] = {
        "surface": dict(paper["surface"], shape=[points, points]),
        "material": dict(paper["material"]),
        "interaction": {
            "work_of_adhesion": "0.6924 J/m^2",
            "length": "3.28 angstrom",
            "contact_distance": "3.68 angstrom",
        },
        "loading": {"path": [f"{pressure} GPa" for pressure in PRESSURES], "unload": True},
        "theory": {"spectrum": "surface"},
        "sweep": {
            "interaction.work_of_adhesion": [f"{0.6924 * ratio} J/m^2" for ratio in ratios],
            "surface.seed": list(range(1, surfaces + 1)),
        },
    }
    for section, keys in SETTINGS[setting][0].items() if setting is not None else ():
        table[section] |= keys
    return table


def means(surfaces: int, points: int, ratios: Sequence[float], setting: str | None = None) -> pd.DataFrame:
    """Mean and standard error of every quantity: a model, a law, a pressure and a branch of the path a row."""
    table = study(surfaces, points, ratios, setting)
    return summary(contact_study.run(table, "continuum"), contact_study.run(table, "theory"), ratios)


def summary(truth: xr.Dataset, theory: xr.Dataset, ratios: Sequence[float]) -> pd.DataFrame:
    """The means of both datasets of a study."""
    models = (("continuum", truth), *((name, theory.sel(theory=name)) for name in THEORIES))
    found = []
    for (model, dataset), name, branch in itertools.product(models, SHOWN, BRANCHES):
        values = dataset[name].where(dataset["converged"] == 1)
        mean, error = values.mean("seed"), values.std("seed", ddof=1) / values.count("seed") ** 0.5
        for (law, ratio), (step, pressure) in itertools.product(enumerate(ratios), enumerate(PRESSURES)):
            # The way back ends where it began and turns at the last pressure.
            back = branch == "unloading"
            at = {"work_of_adhesion": law, "step": 2 * len(PRESSURES) - 2 - step if back else step}
            count = int(values.isel(at).count())
            found.append((branch, model, name, ratio, pressure, float(mean[at]), float(error[at]), count))
    columns = ["branch", "model", "quantity", "ratio", "pressure_GPa", "mean", "standard_error", "surfaces"]
    return pd.DataFrame(found, columns=columns)


def ensemble(surfaces: int, points: int, ratios: Sequence[float]) -> pd.DataFrame:
    """The means at the paper's spectrum and law."""
    return means(surfaces, points, ratios).assign(points=points)


def settings_ensemble(surfaces: int, points: int, settings: Sequence[str]) -> pd.DataFrame:
    """The means in the settings."""
    every = {setting: means(surfaces, points, SETTINGS[setting][1], setting) for setting in settings}
    return pd.concat(every, names=["setting"]).reset_index(level="setting").reset_index(drop=True)


def settings_rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: mean and worst error in per cent from 0.2 GPa on, one setting, law and branch a line."""
    yield "| setting | well depth | branch | quantity | gap flow | edge flow | standard error | surfaces |"
    yield "|---|---|---|---|---|---|---|---|"
    table = table[table["pressure_GPa"] >= 0.2]
    for (setting, ratio, branch), part in table.groupby(["setting", "ratio", "branch"], sort=False):
        for name, symbol in SHOWN.items():
            own = part[part["quantity"] == name]
            wide = own.pivot_table(index="pressure_GPa", columns="model", values="mean")
            errors = [100 * (wide[theory] / wide["continuum"] - 1).abs() for theory in THEORIES]
            truth = own[own["model"] == "continuum"]
            scatter = 100 * (truth["standard_error"] / truth["mean"]).mean()
            cells = " | ".join(f"{error.mean():.1f} ({error.max():.1f}) %" for error in errors)
            head = f"| {setting} | {ratio:g} ε0 | {branch} | {symbol} |"
            yield f"{head} {cells} | {scatter:.1f} % | {truth['surfaces'].min()} |"


def rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: mean and worst error in per cent, the truth's own error beside it."""
    yield "| well depth | branch | p (GPa) | quantity | gap flow | edge flow | standard error | surfaces |"
    yield "|---|---|---|---|---|---|---|---|"
    strengths = ((f"≤ {WEAK:g} ε0", table["ratio"] <= WEAK), (f"> {WEAK:g} ε0", table["ratio"] > WEAK))
    for (branch, pressures), (words, chosen) in itertools.product(SHARES, strengths):
        within = f"{min(pressures):g}" + (f" to {max(pressures):g}" if len(pressures) > 1 else "")
        for name, symbol in SHOWN.items():
            part = table[chosen & (table["branch"] == branch) & (table["quantity"] == name)]
            part = part[part["pressure_GPa"].isin(pressures)]
            if part.empty:
                continue
            wide = part.pivot_table(index=["ratio", "pressure_GPa"], columns="model", values="mean")
            truth = part[part["model"] == "continuum"]
            cells = []
            for theory in THEORIES:
                error = 100 * (wide[theory] / wide["continuum"] - 1).abs()
                cells.append(f"{error.mean():.1f} ({error.max():.1f}) %")
            own = 100 * (truth["standard_error"] / truth["mean"]).mean()
            head = f"| {words} | {branch} | {within} | {symbol} |"
            yield f"{head} {' | '.join(cells)} | {own:.1f} % | {truth['surfaces'].min()} |"


def main(arguments: Sequence[str] | None = None) -> int:
    given = parser().parse_args(arguments)
    read = given.source is not None
    if read:
        table = pd.read_csv(given.source)
    elif given.settings is not None:
        table = settings_ensemble(given.surfaces, given.points, given.settings or list(SETTINGS))
    else:
        table = ensemble(given.surfaces, given.points, given.ratios)
    if given.table:
        table.to_csv(given.table, index=False, float_format="%.6g")
    for row in settings_rows(table) if given.settings is not None else rows(table):
        print(row)
    return 0


if __name__ == "__main__":
    sys.exit(main())
