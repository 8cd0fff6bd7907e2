"""Errors of the theories without adhesion against the hard wall on an ensemble of surfaces, as Markdown.

The surfaces are the paper's, of realised rms height; the theories know each surface's own spectrum. ``paper`` is the
theory of Yang et al. 2008: the plain area, the energy with the weight A[β + (1−β)A²], β = 0.4. The area of the
continuum is of first order in the grid's spacing and is extrapolated from two grids. The errors are those of ensemble
means at equal pressure.

python -m research.non_adhesive_shelf                 # twelve surfaces, 128 × 128 and 256 × 256 points
python -m research.non_adhesive_shelf --table data/non_adhesive_shelf.csv
python -m research.non_adhesive_shelf --from data/non_adhesive_shelf.csv
"""

import argparse
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from scipy.special import erfc

import contact_study
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity
from contact_study.study.case import realise
from contact_study.study.study import make_study, read_study
from scripts.harness import PAPER, Option, head, minus, per_cent, row, tabulated
from theory import NonAdhesiveTheory, PerssonTheory
from theory.non_adhesive import closed_forms
from theory.non_adhesive.corrections import CORRECTIONS

PRESSURES = (0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)  # GPa
THEORIES = (*CORRECTIONS, "paper")
# Symbol, unit and its size of what is shown. The stress that would press a surface flat has the deviation s.
SHOWN = {
    "relative_contact_area": ("A", "", 1.0),
    "share_of_high_stress": ("A(σ > s)", "", 1.0),
    "mean_gap": ("ū", " nm", 1e9),
    "stiffness": ("−dp/dū", " GPa/nm", 1e-18),
    "elastic_energy": ("U", " J/m²", 1.0),
}
STEP = 1e-3  # of the pressure, by which the stiffness of the paper's mean gap is found


def study(surfaces: int, points: int) -> dict[str, Any]:
    """The study file's content: the paper's surface and solid."""
    paper = read_study(PAPER).table
    return {
        "surface": dict(paper["surface"], shape=[points, points]),
        "material": dict(paper["material"]),
        "interaction": {"law": "hard_wall"},
        "loading": {"path": [f"{pressure} GPa" for pressure in PRESSURES]},
        "sweep": {"surface.seed": list(range(1, surfaces + 1))},
        "output": {"fields": True, "stiffness": True},
    }


def ensemble(given: argparse.Namespace) -> pd.DataFrame:
    """Mean and standard error of every quantity: a model and a pressure a row."""
    surfaces, points = given.surfaces, given.points
    cases = make_study(study(surfaces, points)).cases
    spectra, solid = [realise(case).measured_spectrum() for case in cases], cases[0].solid
    deviations = [float(np.sqrt(spectrum.full_contact_stress_variance(solid.stiffness))) for spectrum in spectra]
    found = simulated(surfaces, points, deviations)
    for pressure in PRESSURES:
        of_theories: dict[str, list[dict[str, float]]] = {name: [] for name in THEORIES}
        for spectrum, deviation in zip(spectra, deviations, strict=True):
            for correction in CORRECTIONS:
                of_theories[correction].append(corrected(spectrum, solid, correction, 1e9 * pressure, deviation))
            of_theories["paper"].append(of_the_paper(spectrum, solid, 1e9 * pressure, deviation))
        found += [
            (name, quantity, pressure, pd.Series([each[quantity] for each in values]))
            for name, values in of_theories.items()
            for quantity in SHOWN
        ]
    rows = [(*keys, values.mean(), values.std(ddof=1) / len(values) ** 0.5, surfaces) for *keys, values in found]
    return pd.DataFrame(rows, columns=["model", "quantity", "pressure_GPa", "mean", "standard_error", "surfaces"])


def simulated(surfaces: int, points: int, deviations: list[float]) -> list[tuple[str, str, float, pd.Series]]:
    """Model, quantity, pressure (GPa) and the values of all surfaces, by the hard wall."""
    coarse, fine = (contact_study.run(study(surfaces, count), "continuum") for count in (points // 2, points))
    high = xr.DataArray(deviations, dims="seed", coords={"seed": fine["seed"]})
    truth = {
        "relative_contact_area": 2 * fine["relative_contact_area"] - coarse["relative_contact_area"],
        "share_of_high_stress": (fine["pressure"] > high).mean(("y", "x")),
        "mean_gap": fine["mean_gap"],
        "stiffness": fine["contact_stiffness"],
        "elastic_energy": fine["elastic_energy"],
    }
    return [
        ("continuum", name, pressure, values.isel(step=step).to_series())
        for name, values in truth.items()
        for step, pressure in enumerate(PRESSURES)
    ]


def corrected(
    spectrum: RoughnessSpectrum, solid: Elasticity, correction: str, pressure: float, deviation: float
) -> dict[str, float]:
    """What is shown, by one of the corrections."""
    contact = NonAdhesiveTheory(spectrum, solid, correction).at_pressure(pressure)
    return {
        "relative_contact_area": contact.relative_contact_area,
        "share_of_high_stress": above(deviation, pressure, float(contact.stress_variance_at())),
        "mean_gap": contact.mean_gap,
        "stiffness": contact.stiffness,
        "elastic_energy": contact.elastic_energy,
    }


def of_the_paper(spectrum: RoughnessSpectrum, solid: Elasticity, pressure: float, deviation: float) -> dict[str, float]:
    """What is shown, by the theory of the paper."""
    contact = PerssonTheory(spectrum, solid, 0.0).at_pressure(pressure)
    around = pressure * np.array([1 - STEP, 1.0, 1 + STEP])
    wide, gap, narrow = (float(closed_forms.mean_gap(each, spectrum, solid)) for each in around)
    return {
        "relative_contact_area": contact.relative_contact_area,
        "share_of_high_stress": above(deviation, pressure, deviation**2),
        "mean_gap": gap,
        "stiffness": 2 * STEP * pressure / (wide - narrow),
        "elastic_energy": contact.elastic_energy,
    }


def above(stress: float, pressure: float, variance: float) -> float:
    """Share of the area under more than a stress, of P(σ) with a variance."""
    width = np.sqrt(2 * variance)
    return float(0.5 * (erfc((stress - pressure) / width) - erfc((stress + pressure) / width)))


def rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: the error at each pressure in per cent, the truth and its own error first."""
    yield head("p (GPa)", "quantity", "continuum", "standard error", *(f"`{name}`" for name in THEORIES))
    truth = table[table["model"] == "continuum"]
    for name, (symbol, unit, size) in SHOWN.items():
        for _, own in truth[truth["quantity"] == name].iterrows():
            here = table[(table["quantity"] == name) & (table["pressure_GPa"] == own["pressure_GPa"])]
            means = here.set_index("model")["mean"]
            errors = [minus(per_cent(means[theory], own["mean"])) for theory in THEORIES]
            error = 100 * own["standard_error"] / own["mean"]
            shown = f"{own['mean'] * size:.4g}{unit}", f"{error:.1f} %"
            yield row(f"{own['pressure_GPa']:g}", symbol, *shown, *errors)


main = tabulated(
    ensemble,
    rows,
    Option("--surfaces", 12, "number of surfaces"),
    Option("--points", 256, "points along each side of the finer grid"),
)

if __name__ == "__main__":
    sys.exit(main())
