"""Errors of the theories without adhesion against the hard wall on an ensemble of surfaces, as Markdown.

The surfaces are the paper's, of realised rms height; the theories know each surface's own spectrum. ``paper`` is the
theory of Yang et al. 2008: the plain area, the energy with the weight A[β + (1−β)A²], β = 0.4. The area of the
continuum is of first order in the grid's spacing and is extrapolated from two grids. The errors are those of ensemble
means at equal pressure.

python scripts/non_adhesive_shelf.py                 # twelve surfaces, 128 × 128 and 256 × 256 points
python scripts/non_adhesive_shelf.py --table data/non_adhesive_shelf.csv
python scripts/non_adhesive_shelf.py --from data/non_adhesive_shelf.csv
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

import contact_study
from contact_study.problem.study import make_study, read_study
from contact_study.problem.surface import realise
from theory import NonAdhesiveTheory, PerssonTheory, closed_forms
from theory.non_adhesive import CORRECTIONS

PAPER = Path(__file__).resolve().parent.parent / "data" / "yang2008.toml"
PRESSURES = (0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)  # GPa
THEORIES = (*CORRECTIONS, "paper")
SHOWN = {"relative_contact_area": "A", "mean_gap": "ū", "elastic_energy": "U"}


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--surfaces", type=int, default=12, help="number of surfaces")
    made.add_argument("--points", type=int, default=256, help="points along each side of the finer grid")
    made.add_argument("--table", type=Path, help="CSV to write the ensemble's means to")
    made.add_argument("--from", type=Path, dest="source", help="CSV to read them from, in place of a run")
    return made


def study(surfaces: int, points: int) -> dict[str, Any]:
    """The study file's content: the paper's surface and solid."""
    paper = read_study(PAPER).table
    return {
        "surface": dict(paper["surface"], shape=[points, points]),
        "material": dict(paper["material"]),
        "interaction": {"law": "hard_wall"},
        "loading": {"path": [f"{pressure} GPa" for pressure in PRESSURES]},
        "sweep": {"surface.seed": list(range(1, surfaces + 1))},
    }


def ensemble(surfaces: int, points: int) -> pd.DataFrame:
    """Mean and standard error of every quantity: a model and a pressure a row."""
    coarse, fine = (contact_study.run(study(surfaces, count), "continuum") for count in (points // 2, points))
    truth = {name: fine[name] for name in SHOWN}
    truth["relative_contact_area"] = 2 * fine["relative_contact_area"] - coarse["relative_contact_area"]
    found = []

    def row(model: str, name: str, pressure: float, values: pd.Series) -> None:
        found.append((model, name, pressure, values.mean(), values.std(ddof=1) / len(values) ** 0.5, surfaces))

    for name, values in truth.items():
        for step, pressure in enumerate(PRESSURES):
            row("continuum", name, pressure, values.isel(step=step).to_series())
    cases = make_study(study(surfaces, points), Path(tempfile.gettempdir())).cases
    for correction in CORRECTIONS:
        theories = [NonAdhesiveTheory(realise(case).measured_spectrum(), case.solid, correction) for case in cases]
        for pressure in PRESSURES:
            contacts = [theory.at_pressure(1e9 * pressure) for theory in theories]
            for name in SHOWN:
                row(correction, name, pressure, pd.Series([getattr(contact, name) for contact in contacts]))
    spectra = [realise(case).measured_spectrum() for case in cases]
    solid = cases[0].solid
    for pressure in PRESSURES:
        contacts = [PerssonTheory(spectrum, solid, 0.0).at_pressure(1e9 * pressure) for spectrum in spectra]
        gaps = [float(closed_forms.mean_gap(1e9 * pressure, spectrum, solid)) for spectrum in spectra]
        row("paper", "relative_contact_area", pressure, pd.Series([each.relative_contact_area for each in contacts]))
        row("paper", "mean_gap", pressure, pd.Series(gaps))
        row("paper", "elastic_energy", pressure, pd.Series([each.elastic_energy for each in contacts]))
    return pd.DataFrame(found, columns=["model", "quantity", "pressure_GPa", "mean", "standard_error", "surfaces"])


def rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: the error at each pressure in per cent, the truth and its own error first."""
    yield f"| p (GPa) | quantity | continuum | standard error | {' | '.join(f'`{name}`' for name in THEORIES)} |"
    yield "|---" * (4 + len(THEORIES)) + "|"
    truth = table[table["model"] == "continuum"]
    for name, symbol in SHOWN.items():
        for _, own in truth[truth["quantity"] == name].iterrows():
            here = table[(table["quantity"] == name) & (table["pressure_GPa"] == own["pressure_GPa"])]
            means = here.set_index("model")["mean"]
            errors = [f"{100 * (means[theory] / own['mean'] - 1):+.1f} %" for theory in THEORIES]
            unit, size = {"A": ("", 1), "ū": (" nm", 1e9), "U": (" J/m²", 1)}[symbol]
            error = 100 * own["standard_error"] / own["mean"]
            yield (
                f"| {own['pressure_GPa']:g} | {symbol} | {own['mean'] * size:.4f}{unit} | {error:.1f} % | "
                f"{' | '.join(errors).replace('-', '−')} |"
            )


def main(arguments: Sequence[str] | None = None) -> int:
    given = parser().parse_args(arguments)
    table = pd.read_csv(given.source) if given.source is not None else ensemble(given.surfaces, given.points)
    if given.table:
        table.to_csv(given.table, index=False, float_format="%.6g")
    for row in rows(table):
        print(row)
    return 0


if __name__ == "__main__":
    sys.exit(main())
