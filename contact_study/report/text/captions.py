"""Captions of the figures, from what they show."""

from collections.abc import Collection

import numpy as np
import xarray as xr

from contact_study.physics.laws import TractionLaw
from contact_study.report.compute.cases import SweepPoint, case_points, select, sweep_points
from contact_study.report.compute.curves import Curve, in_compression, mean_gap_panels
from contact_study.report.compute.magnification import resolving
from contact_study.report.compute.plotted import PathCurves, density_at
from contact_study.report.compute.scales import scales
from contact_study.report.compute.scatter import Strips
from contact_study.report.compute.shown_states import PanelPoints, common_label, point_label, state_label
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.load_steps import SEED
from contact_study.report.wording import listed, listed_points
from contact_study.study.load_steps import PathPoint

_ROUNDING = 1e-6  # of h_rms: what a gap prescribed as zero may differ from it


def captions(
    inputs: Inputs,
    shown: PanelPoints,
    curves: PathCurves,
    seed: int | None,
    banded: Collection[str],
    strips: Strips | None = None,
) -> dict[str, str]:
    """Captions of the figures, by figure name.

    Parameters
    ----------
    inputs : Inputs
        What was compared.
    shown : PanelPoints
        States whose distributions and fields are shown.
    curves : PathCurves
        What is shown along the path.
    seed : int or None
        Seed of the surface whose fields are shown, None where no seed is swept.
    banded : collection of str
        Theories between whose metastable branches a band is shaded.
    strips : Strips, optional
        The scatter between surfaces, where it is shown.
    """
    models = inputs.models
    panels = _panels(inputs, shown, seed)
    gaps = scales(models, shown.case).height_symbol
    told = dict.fromkeys(entry_of(name).densities for name in models)
    densities = "".join(f" {words}" for words in told if words)
    panels_of_area = ""
    if in_compression(curves.areas):
        panels_of_area = ", (a) linear, (b) logarithmic, compression only"
    state = state_label(shown.case, point_label(shown.common, scales(models, shown.case), inputs.control))
    whose = f", surface of the first {inputs.average.replace('_', ' ')} ({seed})" if seed is not None else ""
    own = dict.fromkeys(type(case.law) for case in inputs.cases_at(shown.case.selection))
    return {
        "stress_distribution": "Distribution of the interfacial normal stress, compression positive, in units of E*: "
        f"{panels}{_normalised(models)}{densities}{_absent(inputs, shown, 'pressure_pdf')}",
        "gap_distribution": f"Distribution of the local gap u in units of {gaps}: {panels} u is the distance of the "
        f"surfaces, not reduced by the equilibrium distance.{_absent(inputs, shown, 'gap_pdf')}",
        "contact_area": f"Relative contact area against mean pressure{panels_of_area}. {_areas(models, inputs.laws)}"
        f"{_lines(inputs, banded)}{_scatter(strips)}",
        "mean_gap": _mean_gap(inputs, curves, gaps, banded) + _scatter(strips),
        "gap_map": f"Local gap of {_simulations(inputs)} at {state}{whose}; contact, {_contact(own)}, is black.",
        "interface": f"Interface of {_simulations(inputs)} at {state}{whose}. (a) Local pressure, compression red, "
        f"tension blue; (b) clusters of contact, {_contact(own)}, the six largest in colour; (c) section along x "
        "through the highest point of the surface.",
        "magnification": _magnification(inputs, shown),
        "atoms": f"Bottom layer of the block over the sites of the substrate at {state}{whose}, at true proportions: "
        "one row along x through the atom under the largest tension, compression red, tension blue.",
    }


def _magnification(inputs: Inputs, shown: PanelPoints) -> str:
    """Caption of the figure over the magnification, whose map is there where it was kept."""
    name = resolving(inputs)
    if name is None:
        return ""
    who = entry_of(name).words
    every, one = (", each point of the sweep", f" at {shown.case.label}") if shown.case.label else ("", "")
    words = (
        f"{who[0].upper()}{who[1:]} at {common_label(inputs.models, shown.common, inputs.control)}{every}, against the "
        "magnification ζ = q/q_L, the wavevector up to which roughness counts over the smallest one: (a) apparent "
        "contact area; (b) largest tensile stress, at which contact is lost; (c) effective work of adhesion, negative "
        "where roughness stores more energy than adhesion gains"
    )
    if any("pressure_pdf_at" in dataset for dataset in inputs.models.values()):
        return f"{words}; (d) distribution of the stress{one}, compression positive."
    return f"{words}."


def _panels(inputs: Inputs, shown: PanelPoints, seed: int | None) -> str:
    """What the two panels of a distribution show."""
    common = common_label(inputs.models, shown.common, inputs.control)
    units = scales(inputs.models, shown.case)
    symbol = point_label(shown.common, units, inputs.control).partition(" = ")[0]
    several = ", ".join(point_label(named, units, inputs.control).partition(" = ")[2] for named in shown.several)
    case = f"{shown.case.label}, " if shown.case.label else ""
    every = "for each point of the sweep " if shown.case.label else ""
    words = f"(a) {every}at {common}; (b) at {case}{symbol} = {several}."
    if shown.paper:
        words += " The paper does not state the pressure of its panel (a): this one is a choice."
    if seed is not None:
        words += (
            f" Of {_samples(inputs)}, each curve is the mean over those that converged in contact, the band its "
            "standard error."
        )
    return words


def _samples(inputs: Inputs) -> str:
    """What is averaged over, in words."""
    return "seeds" if inputs.average == SEED else f"the values of {inputs.average.replace('_', ' ')}"


def _simulations(inputs: Inputs) -> str:
    return entry_of(inputs.simulations[0]).words if len(inputs.simulations) == 1 else "the simulations"


def _counting(models: Collection[str]) -> tuple[str, bool]:
    """Who counts every site, at the beginning of a sentence, and whether they are several; empty where nobody does."""
    entries = [entry_of(name) for name in models if not entry_of(name).densities]
    words = list(dict.fromkeys("simulations" if entry.simulation else entry.label for entry in entries))
    joined = listed(words) if words else ""
    return joined[:1].upper() + joined[1:], len(words) > 1 or any(entry.simulation for entry in entries)


def _normalised(models: Collection[str]) -> str:
    who, several = _counting(models)
    if not who:
        return ""
    return (
        f" {who} {'are' if several else 'is'} normalised over all sites, so that sites out of contact, nearly free of "
        "stress, make the central peak."
    )


def _areas(models: Collection[str], laws: Collection[type[TractionLaw]]) -> str:
    """What each model counts as contact."""
    who, several = _counting(models)
    own = [f"{entry_of(name).words} {entry_of(name).area}" for name in models if entry_of(name).area]
    if not who:
        return "".join(f"The area is {entry_of(name).area}." for name in models if entry_of(name).area)
    return ", ".join([f"{who} {'count' if several else 'counts'} points of {_contact(laws)}", *own]) + "."


def _contact(laws: Collection[type[TractionLaw]]) -> str:
    """What counts as contact, by law; laws without a wall first."""
    first, *others = sorted(laws, key=lambda law: law.has_wall)
    apart = [f" (for the {law.title}, {law.counts_as_contact})" for law in others if law.has_wall > first.has_wall]
    return first.counts_as_contact + "".join(apart)


def _mean_gap(inputs: Inputs, curves: PathCurves, gaps: str, banded: Collection[str]) -> str:
    """Caption of figure 4, whose panels depend on where there is tension."""
    shown = mean_gap_panels(curves.gaps, curves.linear_gaps)
    what = {
        "logarithmic": "Natural logarithm of the mean pressure in units of E*, compression only",
        "linear": "Mean pressure in units of E*, tension negative",
    }
    if len(shown) == 2:
        words = f"(a) {what['logarithmic']}; (b) {what['linear']}"
    else:
        words = "; ".join(what[name] for name in shown)
    where = ", measured from the equilibrium distance of flat surfaces"
    walls = [law.title for law in inputs.laws if law.has_wall]
    if walls:
        where = "" if len(walls) == len(inputs.laws) else f"{where} (for the {' and the '.join(walls)} from touching)"
    words += f", against the mean gap ū in units of {gaps}{where}."
    return words + _below_zero(curves.linear_gaps) + _lines(inputs, banded)


def _below_zero(curves: Collection[Curve]) -> str:
    """What a negative mean gap means, for each kind of model that has one."""
    words = ""
    for meaning in dict.fromkeys(entry_of(curve.model).negative_gap for curve in curves):
        found = [
            curve
            for curve in curves
            if entry_of(curve.model).negative_gap == meaning and (curve.x[np.isfinite(curve.y)] < -_ROUNDING).any()
        ]
        if found:
            who = listed(entry_of(curve.model).words for curve in found)
            words += (
                f" Where ū < 0 ({'; '.join(filter(None, (who, listed_points(c.label for c in found))))}), {meaning}."
            )
    return words


def _lines(inputs: Inputs, banded: Collection[str]) -> str:
    errors = ""
    if inputs.samples > 1:
        errors = f", points are means, bands about lines and error bars standard errors over {_samples(inputs)}"
    words = (
        f" Lines join the computed states in the order of the path{errors}; filled: loading, hollow: unloading, "
        "crosses: not converged; detached states are left out."
    )
    if banded:
        theories = listed(entry_of(name).words for name in banded)
        words += f" The shaded band lies between the metastable loading and unloading branches of {theories}."
    return words


def _scatter(strips: Strips | None) -> str:
    if strips is None:
        return ""
    return (
        f" Behind the points, darker: mean ± one standard deviation of {entry_of(strips.model).words} over "
        f"{strips.surfaces} surfaces of one spectrum, each on its own path."
    )


def _absent(inputs: Inputs, shown: PanelPoints, name: str) -> str:
    """Names the states without a distribution, apart by reason."""
    states = [(point, shown.common) for point in sweep_points(inputs.models)]
    states += [(shown.case, named) for named in shown.several]
    missing: dict[str, list[str]] = {}
    for model, dataset in inputs.models.items():
        for point, named in states:
            reason = _why_absent(inputs, dataset, name, point, named)
            if reason:
                missing.setdefault(reason, []).append(f"{entry_of(model).words} at {_state(inputs, point, named)}")
    return "".join(f" {reason}: {'; '.join(dict.fromkeys(words))}." for reason, words in missing.items())


def _why_absent(inputs: Inputs, dataset: xr.Dataset, name: str, point: SweepPoint, named: PathPoint) -> str:
    """Why a model shows no distribution at a state; nothing where it does, or where it has none at all."""
    part = select(dataset, point)
    if name not in dataset or part is None:
        return ""
    path = case_points(part, inputs.control)
    if named not in path:
        return "Not on the loading path"
    if density_at(dataset, point, name, named, inputs.control) is not None:
        return ""
    state = part.isel(step=path.index(named))
    flagged = (
        flag in state and bool((state[flag] == value).any()) for flag, value in (("detached", 1), ("converged", 0))
    )
    return "Not shown, being detached or not converged" if any(flagged) else "Without a result"


def _state(inputs: Inputs, point: SweepPoint, named: PathPoint) -> str:
    return state_label(point, point_label(named, scales(inputs.models, point), inputs.control))
