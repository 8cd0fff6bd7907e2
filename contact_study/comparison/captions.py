"""Captions of the figures, from what they show."""

from collections.abc import Mapping

import xarray as xr

from contact_study.comparison.cases import SweepPoint
from contact_study.comparison.findings import MODEL_WORDS
from contact_study.comparison.path_points import AVERAGED
from contact_study.comparison.plotted import PanelPoints, Scales, density_at, point_label


def captions(
    models: Mapping[str, xr.Dataset], shown: PanelPoints, units: Scales, control: str, points: list[SweepPoint]
) -> dict[str, str]:
    """Captions of the figures, by figure name."""
    common = point_label(shown.common, units, control)
    several = ", ".join(point_label(named, units, control).partition(" = ")[2] for named in shown.several)
    case = f" at {shown.case.label}" if shown.case.label else ""
    symbol = common.partition(" = ")[0]
    panels = f"(a) for each point of the sweep at {common}; (b){case} at {symbol} = {several}."
    if shown.paper:
        panels += " The paper does not state the pressure of its panel (a): this one is a choice."
    absent = _absent(models, shown, units, control, points)
    persson = ""
    if "theory" in models:
        persson = (
            " Persson's theory counts the stress in contact only, so that its integral is A/A₀; it has no distribution "
            "of gaps."
        )
    errors = ", error bars are standard errors over seeds" if AVERAGED in _dims(models) else ""
    join = (
        f" Lines join the computed states in the order of the path{errors}; filled: loading, hollow: unloading, "
        "crosses: not converged; detached states are left out."
    )
    if "gap_flow" in models:
        join += " The shaded band lies between the metastable loading and unloading branches of the gap-flow theory."
    gaps = units.height_symbol
    return {
        "stress_distribution": "Distribution of the interfacial normal stress, compression positive, in units of E*: "
        f"{panels} Simulations and gap-flow theory are normalised over all sites, so that sites out of contact, nearly "
        f"free of stress, make the central peak.{persson}{absent}",
        "gap_distribution": f"Distribution of the local gap u in units of {gaps}: {panels} u is the distance of the "
        f"surfaces, not reduced by the equilibrium distance.{absent}",
        "contact_area": "Relative contact area against mean pressure, (a) linear, (b) logarithmic, compression only. "
        "Simulations and gap-flow theory count gaps below the contact distance (hard wall: pressure above zero), "
        f"Persson's theory its real contact area at the highest magnification.{join}",
        "mean_gap": f"Natural logarithm of the mean pressure in units of E* against the mean gap in units of {gaps}, "
        f"measured from the equilibrium distance of flat surfaces; compression only.{join}",
        "gap_map": f"Local gap of the simulations{case} at {common}; contact, a gap below the contact distance, is "
        "black.",
    }


def _dims(models: Mapping[str, xr.Dataset]) -> set[str]:
    return {str(dim) for dataset in models.values() for dim in dataset.dims}


def _absent(
    models: Mapping[str, xr.Dataset], shown: PanelPoints, units: Scales, control: str, points: list[SweepPoint]
) -> str:
    """Names the states without a distribution: nothing is in contact there or the step did not converge."""
    states = [(point, shown.common) for point in points] + [(shown.case, named) for named in shown.several]
    missing = [
        f"{MODEL_WORDS[model]} at {point.label}, {point_label(named, units, control)}"
        for model, dataset in models.items()
        for point, named in states
        if "pressure_pdf" in dataset and density_at(dataset, point, "pressure_pdf", named, control) is None
    ]
    return f" Not shown, being detached or not converged: {'; '.join(dict.fromkeys(missing))}." if missing else ""
