"""Captions of the figures, from what they show."""

from contact_study.comparison.cases import SweepPoint, case_points, select, sweep_points
from contact_study.comparison.datasets import Inputs
from contact_study.comparison.findings import MODEL_WORDS
from contact_study.comparison.path_points import AVERAGED, Point
from contact_study.comparison.plotted import (
    PanelPoints,
    Scales,
    contact_area_data,
    density_at,
    in_compression,
    point_label,
)


def captions(inputs: Inputs, shown: PanelPoints, units: Scales, seed: int | None) -> dict[str, str]:
    """Captions of the figures, by figure name.

    Parameters
    ----------
    inputs : Inputs
        What was compared.
    shown : PanelPoints
        States whose distributions and fields are shown.
    units : Scales
        Units of the axes.
    seed : int or None
        Seed of the surface whose fields are shown, None where no seed is swept.
    """
    models, control = inputs.models, inputs.control
    hard_wall = inputs.study.cases[0].interaction.law == "hard_wall"
    common = point_label(shown.common, units, control)
    several = ", ".join(point_label(named, units, control).partition(" = ")[2] for named in shown.several)
    case = f" at {shown.case.label}" if shown.case.label else ""
    panels = f"(a) for each point of the sweep at {common}; (b){case} at {common.partition(' = ')[0]} = {several}."
    if shown.paper:
        panels += " The paper does not state the pressure of its panel (a): this one is a choice."
    if seed is not None:
        panels += " With several seeds, each curve is the mean over those that converged in contact."
    absent = _absent(inputs, shown, units)
    counted = " and ".join(
        words
        for words, there in (
            ("simulations", "atomistic" in models or "continuum" in models),
            ("gap-flow theory", "gap_flow" in models),
        )
        if there
    )
    counted = counted[0].upper() + counted[1:]
    persson = persson_area = ""
    if "theory" in models:
        persson = (
            " Persson's theory counts the stress in contact only, so that its integral is A/A₀; it has no distribution "
            "of gaps."
        )
        persson_area = ", Persson's theory its real contact area at the highest magnification"
    contact = "points under positive pressure" if hard_wall else "gaps below the contact distance"
    gaps = units.height_symbol
    panels_of_area = ""
    if in_compression(contact_area_data(models, control)):
        panels_of_area = ", (a) linear, (b) logarithmic, compression only"
    from_where = "" if hard_wall else ", measured from the equilibrium distance of flat surfaces"
    whose = f", surface of the first seed ({seed})" if seed is not None else ""
    black = "a positive pressure" if hard_wall else "a gap below the contact distance"
    return {
        "stress_distribution": "Distribution of the interfacial normal stress, compression positive, in units of E*: "
        f"{panels} {counted} are normalised over all sites, so that sites out of contact, nearly free of stress, make "
        f"the central peak.{persson}{absent}",
        "gap_distribution": f"Distribution of the local gap u in units of {gaps}: {panels} u is the distance of the "
        f"surfaces, not reduced by the equilibrium distance.{absent}",
        "contact_area": f"Relative contact area against mean pressure{panels_of_area}. {counted} count "
        f"{contact}{persson_area}.{_lines(inputs)}",
        "mean_gap": f"Natural logarithm of the mean pressure in units of E* against the mean gap in units of {gaps}"
        f"{from_where}; compression only.{_lines(inputs)}",
        "gap_map": f"Local gap of the simulations{case} at {common}{whose}; contact, {black}, is black.",
    }


def _lines(inputs: Inputs) -> str:
    seeds = any(AVERAGED in dataset.dims for dataset in inputs.models.values())
    errors = ", points are means and error bars standard errors over seeds" if seeds else ""
    words = (
        f" Lines join the computed states in the order of the path{errors}; filled: loading, hollow: unloading, "
        "crosses: not converged; detached states are left out."
    )
    if len(inputs.branches) == 2:
        words += " The shaded band lies between the metastable loading and unloading branches of the gap-flow theory."
    return words


def _absent(inputs: Inputs, shown: PanelPoints, units: Scales) -> str:
    """Names the states without a distribution, apart by reason: none asked for, or none found."""
    states = [(point, shown.common) for point in sweep_points(inputs.models)]
    states += [(shown.case, named) for named in shown.several]
    unvisited, unfit = [], []
    for model, dataset in inputs.models.items():
        for point, named in states:
            part = select(dataset, point)
            if "pressure_pdf" not in dataset or part is None:
                continue
            words = f"{MODEL_WORDS[model]} at {_state(point, named, units, inputs.control)}"
            if named not in case_points(part, inputs.control):
                unvisited.append(words)
            elif density_at(dataset, point, "pressure_pdf", named, inputs.control) is None:
                unfit.append(words)
    return "".join(
        f" {reason}: {'; '.join(dict.fromkeys(missing))}."
        for reason, missing in (
            ("Not shown, being detached or not converged", unfit),
            ("Not on the loading path", unvisited),
        )
        if missing
    )


def _state(point: SweepPoint, named: Point, units: Scales, control: str) -> str:
    return ", ".join(filter(None, (point.label, point_label(named, units, control))))
