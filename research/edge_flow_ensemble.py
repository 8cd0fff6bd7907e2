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
from typing import Any

import pandas as pd
import xarray as xr

import contact_study
from contact_study.study.study import read_study
from scripts.harness import PAPER, Option, head, row, tabulated

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


def ensemble(given: argparse.Namespace) -> pd.DataFrame:
    """The means at the paper's spectrum and law, or in other settings."""
    if given.settings is None:
        return means(given.surfaces, given.points, given.ratios).assign(points=given.points)
    found = {
        name: means(given.surfaces, given.points, SETTINGS[name][1], name) for name in given.settings or list(SETTINGS)
    }
    return pd.concat(found, names=["setting"]).reset_index(level="setting").reset_index(drop=True)


def errors(part: pd.DataFrame, keys: list[str]) -> list[str]:
    """Cells of a quantity: mean and worst error of each theory, the truth's own error, the number of surfaces."""
    wide = part.pivot_table(index=keys, columns="model", values="mean")
    apart = [100 * (wide[theory] / wide["continuum"] - 1).abs() for theory in THEORIES]
    truth = part[part["model"] == "continuum"]
    own = 100 * (truth["standard_error"] / truth["mean"]).mean()
    cells = [f"{error.mean():.1f} ({error.max():.1f}) %" for error in apart]
    return [*cells, f"{own:.1f} %", f"{truth['surfaces'].min()}"]


def settings_rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: mean and worst error in per cent from 0.2 GPa on, one setting, law and branch a line."""
    yield head("setting", "well depth", "branch", "quantity", "gap flow", "edge flow", "standard error", "surfaces")
    table = table[table["pressure_GPa"] >= 0.2]
    for (setting, ratio, branch), part in table.groupby(["setting", "ratio", "branch"], sort=False):
        for name, symbol in SHOWN.items():
            cells = errors(part[part["quantity"] == name], ["pressure_GPa"])
            yield row(setting, f"{ratio:g} ε0", branch, symbol, *cells)


def rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: mean and worst error in per cent, the truth's own error beside it."""
    if "setting" in table:
        yield from settings_rows(table)
        return
    yield head("well depth", "branch", "p (GPa)", "quantity", "gap flow", "edge flow", "standard error", "surfaces")
    strengths = ((f"≤ {WEAK:g} ε0", table["ratio"] <= WEAK), (f"> {WEAK:g} ε0", table["ratio"] > WEAK))
    for (branch, pressures), (words, chosen) in itertools.product(SHARES, strengths):
        within = f"{min(pressures):g}" + (f" to {max(pressures):g}" if len(pressures) > 1 else "")
        for name, symbol in SHOWN.items():
            part = table[chosen & (table["branch"] == branch) & (table["quantity"] == name)]
            part = part[part["pressure_GPa"].isin(pressures)]
            if not part.empty:
                yield row(words, branch, within, symbol, *errors(part, ["ratio", "pressure_GPa"]))


main = tabulated(
    ensemble,
    rows,
    Option("--surfaces", 6, "number of surfaces"),
    Option("--points", 128, "grid points along each side"),
    Option("--ratios", [1.0, 4.0, 8.0], "well depths in units of ε0"),
    Option("--settings", str, "other spectra and laws; none: all", nargs="*", choices=list(SETTINGS), metavar="NAME"),
)

if __name__ == "__main__":
    sys.exit(main())
