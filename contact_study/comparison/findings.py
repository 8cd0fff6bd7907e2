"""What the numbers say, as sentences made from them alone."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from contact_study.comparison.cases import SweepPoint, select, sweep_points
from contact_study.comparison.datasets import Inputs
from contact_study.comparison.deviations import COMPARED
from contact_study.comparison.path_points import AVERAGED
from contact_study.comparison.plotted import Scales, scales
from contact_study.comparison.wording import length_unit, number, percent, percent_of, pressure_unit

MODEL_WORDS = {
    "atomistic": "the atoms",
    "continuum": "the continuum",
    "theory": "Persson's theory",
    "gap_flow": "the gap-flow theory",
}


@dataclass(frozen=True)
class Spread:
    """Deviations of one quantity between two models over a set of states.

    Attributes
    ----------
    count : int
        States compared.
    median : float
        Median of the magnitudes.
    low, high : float
        Extremes, with sign.
    low_at, high_at : str
        The states where they are.
    """

    count: int
    median: float
    low: float
    high: float
    low_at: str
    high_at: str


def split_pair(pair: str) -> tuple[str, str]:
    """Model and reference of an entry of the coordinate ``pair``."""
    model, _, reference = pair.partition(" - ")
    return model, reference


def spread(deviations: xr.Dataset, pair: str, name: str, points: list[SweepPoint], scale: dict[str, float]) -> Spread:
    """Deviations over the given points of the sweep, each divided by ``scale`` of its label.

    Raises
    ------
    ValueError
        If nothing was compared.
    """
    values: list[np.ndarray] = []
    places: list[str] = []
    for point in points:
        part = select(deviations.sel(pair=pair), point)
        if part is None or name not in part:
            continue
        part = part.where(part["state"] == COMPARED)
        lead = [AVERAGED] if AVERAGED in part[name].dims else []
        array = part[name].transpose(*lead, "step").values / scale[point.label]
        for index in zip(*np.nonzero(np.isfinite(array)), strict=True):
            seed = f"seed {part[AVERAGED].values[index[0]]}, " if lead else ""
            pressure = _prescribed(part).transpose(..., "step").values.reshape(-1, array.shape[-1])[-1, index[-1]]
            label = f"{point.label}, " if point.label else ""
            values.append(array[index])
            places.append(f"{label}{seed}{_prescribed_words(part, pressure)}")
    if not values:
        raise ValueError("nothing was compared")
    found = np.array(values)
    low, high = int(np.argmin(found)), int(np.argmax(found))
    return Spread(len(found), float(np.median(np.abs(found))), found[low], found[high], places[low], places[high])


def _prescribed(part: xr.Dataset) -> xr.DataArray:
    return part["applied_pressure"] if "applied_pressure" in part.coords else part["applied_gap"]


def _prescribed_words(part: xr.Dataset, value: float) -> str:
    if "applied_pressure" in part.coords:
        unit = pressure_unit(float(np.abs(part["applied_pressure"]).max()))
        return f"p = {number(value / unit.size, 4)} {unit.name}"
    unit = length_unit(float(np.abs(part["applied_gap"]).max()))
    return f"ū = {number(value / unit.size, 4)} {unit.name}"


def headline(models: Mapping[str, xr.Dataset], deviations: xr.Dataset) -> list[str]:
    """One sentence for each pair of models, and one on which comes nearest to the first reference."""
    points = sweep_points(models)
    units = {point.label: scales(models, point) for point in points}
    sentences = []
    medians: dict[str, float] = {}
    for pair in deviations["pair"].values:
        model, reference = split_pair(pair)
        try:
            sentences.append(_pair_sentence(deviations, pair, points, units))
        except ValueError:
            sentences.append(
                f"Between {MODEL_WORDS[model]} and {MODEL_WORDS[reference]} no state could be compared: none was "
                "found converged and in contact by both."
            )
            continue
        if reference == split_pair(deviations["pair"].values[0])[1]:
            medians[model] = _area_spread(deviations, pair, points).median
    if len(medians) > 1:
        order = sorted(medians, key=medians.__getitem__)
        listed = ", then ".join(f"{MODEL_WORDS[model]} ({percent_of(medians[model])})" for model in order)
        reference = split_pair(deviations["pair"].values[0])[1]
        sentences.insert(
            0, f"By the median relative deviation of contact area, nearest to {MODEL_WORDS[reference]}: {listed}."
        )
    return sentences


def sample_notes(inputs: Inputs) -> list[str]:
    """What the deviations mean statistically: whose surfaces they are of, and what their medians are over."""
    case = inputs.study.cases[0]
    simulated = [name for name in ("atomistic", "continuum") if name in inputs.models]
    if case.surface.kind != "self_affine" or not simulated:
        return []
    seeds = max(inputs.models[name].sizes.get(AVERAGED, 1) for name in simulated)
    surfaces = "one realisation" if seeds == 1 else f"{seeds} realisations"
    notes = []
    theory = inputs.studies.get("theory")
    if theory is not None and any(case.theory.spectrum == "analytic" for case in theory.cases):
        target, realised = _slopes(inputs, ["theory"]), _slopes(inputs, simulated)
        notes.append(
            f"The theory knows the target spectrum{target}, the simulations {surfaces} of it{realised}: the scatter "
            "between surfaces enters the deviations of the theory from the simulations."
        )
    notes.append(
        f"Medians and extremes are over states of the same {'surface' if seeds == 1 else 'surfaces'}, which are no "
        "independent samples."
    )
    return notes


def _slopes(inputs: Inputs, models: Sequence[str]) -> str:
    """Root-mean-square slopes of the surfaces that some models know, in brackets; nothing where none is stored."""
    stored = [inputs.models[name]["rms_slope"].values.ravel() for name in models if "rms_slope" in inputs.models[name]]
    found = np.concatenate([np.empty(0), *stored])
    found = found[np.isfinite(found)]
    if not found.size:
        return ""
    words = dict.fromkeys(number(value, 4) for value in (found.min(), found.max()))
    return f" (rms slope {' to '.join(words)})"


def _area_spread(deviations: xr.Dataset, pair: str, points: list[SweepPoint]) -> Spread:
    ones = {point.label: 1.0 for point in points}
    return spread(deviations, pair, "relative_contact_area_relative_deviation", points, ones)


def _pair_sentence(deviations: xr.Dataset, pair: str, points: list[SweepPoint], units: dict[str, Scales]) -> str:
    model, reference = split_pair(pair)
    area = _area_spread(deviations, pair, points)
    words = (
        f"{_sentence_case(MODEL_WORDS[model])} against {MODEL_WORDS[reference]}: contact area "
        f"{percent(area.low)} ({area.low_at}) to {percent(area.high)} ({area.high_at}), "
        f"median magnitude {percent_of(area.median)} over {area.count} states"
    )
    heights = {label: unit.rms_height for label, unit in units.items()}
    try:
        gap = spread(deviations, pair, "mean_gap_deviation", points, heights)
    except ValueError:
        return words + "."
    symbol = next(iter(units.values())).height_symbol
    low, high = number(gap.low, 2, plus=True), number(gap.high, 2, plus=True)
    return (
        f"{words}; mean gap {low} {symbol} ({gap.low_at}) to {high} {symbol} ({gap.high_at}), "
        f"median magnitude {number(gap.median, 2)} {symbol}."
    )


def _sentence_case(words: str) -> str:
    return words[0].upper() + words[1:]
