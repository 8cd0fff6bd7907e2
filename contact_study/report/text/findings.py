"""What the numbers say, as sentences made from them alone."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from contact_study.plots.units import length_unit, pressure_unit
from contact_study.report.compute.cases import SweepPoint, case_points, select, sweep_points
from contact_study.report.compute.deviations import COMPARED
from contact_study.report.compute.scales import Scales, scales
from contact_study.report.models import TARGET, entry_of, spectrum_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.load_steps import samples_in, usable
from contact_study.report.wording import PRESCRIBED, listed, number, percent, percent_of
from contact_study.study.load_steps import PathPoint

AREA, GAP = "relative_contact_area_relative_deviation", "mean_gap_deviation"


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

    @property
    def worst(self) -> float:
        """The larger extreme, with sign."""
        return self.low if abs(self.low) > abs(self.high) else self.high

    @property
    def worst_at(self) -> str:
        """The state where it is."""
        return self.low_at if abs(self.low) > abs(self.high) else self.high_at


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
    of_pair = deviations.sel(pair=pair)
    if name not in of_pair:
        raise ValueError("nothing was compared")
    return over_states(of_pair[[name]].where(of_pair["state"] == COMPARED), name, points, scale)


def over_states(dataset: xr.Dataset, name: str, points: list[SweepPoint], scale: dict[str, float]) -> Spread:
    """A quantity over all states where it is a number; ValueError if it is none anywhere."""
    values: list[np.ndarray] = []
    places: list[str] = []
    for point in points:
        part = select(dataset, point)
        if part is None:
            continue
        lead = samples_in(part[name])
        array = part[name].transpose(*lead, "step").values / scale[point.label]
        path = case_points(part, control_of(part))
        for index in zip(*np.nonzero(np.isfinite(array)), strict=True):
            seed = "".join(f"{dim.replace('_', ' ')} {part[dim].values[index[0]]}, " for dim in lead)
            label = f"{point.label}, " if point.label else ""
            values.append(array[index])
            places.append(f"{label}{seed}{_point_words(part, path[index[-1]])}")
    if not values:
        raise ValueError("no state has a number")
    found = np.array(values)
    low, high = int(np.argmin(found)), int(np.argmax(found))
    return Spread(len(found), float(np.median(np.abs(found))), found[low], found[high], places[low], places[high])


def control_of(part: xr.Dataset) -> str:
    """What was prescribed on the path of a dataset."""
    return next(control for control in PRESCRIBED if f"applied_{control}" in part.coords)


def _point_words(part: xr.Dataset, named: PathPoint | None) -> str:
    """A point of the path: its prescribed value, and what tells it from another visit of the same value."""
    assert named is not None
    value, branch, visits = float(named[0]), named[1], named[2]
    control = control_of(part)
    largest = float(np.abs(part[f"applied_{control}"]).max())
    unit = pressure_unit(largest) if control == "pressure" else length_unit(largest)
    symbol = PRESCRIBED[control]
    again = f", visit {visits + 1}" if visits else ""
    return f"{symbol} = {number(value / unit.size, 5)} {unit.name}{' on unloading' if branch else ''}{again}"


def headline(models: Mapping[str, xr.Dataset], deviations: xr.Dataset) -> list[str]:
    """Which model comes nearest to the first reference in contact area, a sentence for each pair of ``models``."""
    deviations = deviations.sel(pair=[pair for pair in deviations["pair"].values if set(split_pair(pair)) <= {*models}])
    points = sweep_points(models)
    units = {point.label: scales(models, point) for point in points}
    sentences = _ranking(deviations, points)
    for pair in deviations["pair"].values:
        model, reference = split_pair(pair)
        try:
            sentences.append(_pair_sentence(deviations, pair, points, units))
        except ValueError:
            sentences.append(
                f"Between {entry_of(model).words} and {entry_of(reference).words} no state could be compared: none was "
                "found converged and in contact by both."
            )
    return sentences


def extents(models: Mapping[str, xr.Dataset]) -> list[str]:
    """From where to where the contact area and the mean gap of each model go: a sentence a model."""
    points = sweep_points(models)
    units = {point.label: scales(models, point) for point in points}
    heights = {label: unit.rms_height for label, unit in units.items()}
    symbol = next(iter(units.values())).height_symbol
    sentences = []
    for name, dataset in models.items():
        found, words = usable(dataset), []
        for quantity, title, sizes, unit in (
            ("relative_contact_area", "contact area A/A₀", dict.fromkeys(heights, 1.0), ""),
            ("mean_gap", "mean gap ū", heights, f" {symbol}"),
        ):
            if quantity in dataset:
                try:
                    over = over_states(dataset[[quantity]].where(found), quantity, points, sizes)
                except ValueError:
                    continue
                low, high = number(over.low, 3), number(over.high, 3)
                words.append(f"{title} {low}{unit} ({over.low_at}) to {high}{unit} ({over.high_at})")
        states = "; ".join(words) or "no state was found converged and in contact"
        sentences.append(f"{_sentence_case(entry_of(name).words)}: {states}.")
    return sentences


def on_shared_states(deviations: xr.Dataset, name: str) -> xr.Dataset:
    """The deviations of one quantity over the states that every pair has, so that pairs may be set side by side.

    A pair without any state has no say, and is left out.
    """
    if name not in deviations:
        return deviations.isel(pair=slice(0))
    there = deviations[name].notnull()
    some = there.any([dim for dim in there.dims if dim != "pair"])
    there = there.sel(pair=some)
    return deviations.sel(pair=some).where(there.all("pair"))


def _ranking(deviations: xr.Dataset, points: list[SweepPoint]) -> list[str]:
    """Models in the order of their nearness to the first reference, over the states that all of them share."""
    reference = split_pair(deviations["pair"].values[0])[1]
    pairs = [pair for pair in deviations["pair"].values if split_pair(pair)[1] == reference]
    shared = on_shared_states(deviations.sel(pair=pairs), AREA)
    if shared.sizes["pair"] < 2:
        return []
    try:
        spreads = {split_pair(pair)[0]: _area_spread(shared, pair, points) for pair in shared["pair"].values}
    except ValueError:
        return ["No state was found converged and in contact by all models: their deviations are of different states."]
    order = sorted(spreads, key=lambda model: spreads[model].median)
    medians = ", then ".join(f"{entry_of(model).words} ({percent_of(spreads[model].median)})" for model in order)
    worst = listed(f"{percent(spreads[model].worst)} ({spreads[model].worst_at})" for model in order)
    count = spreads[order[0]].count
    words = (
        f"By the median relative deviation of contact area over the {count} state{'s' if count > 1 else ''} that all "
        f"models share, nearest to {entry_of(reference).words}: {medians}. At worst they are off by {worst}, in this "
        "order"
    )
    by_worst = sorted(spreads, key=lambda model: abs(spreads[model].worst))
    if by_worst != order:
        words += f"; by the worst state the order is {', '.join(entry_of(model).words for model in by_worst)}"
    return [f"{words}."]


def sample_notes(inputs: Inputs) -> list[str]:
    """What the deviations mean statistically: whose surfaces they are of, and what their medians are over."""
    seeds = inputs.seeds
    if not seeds:
        return []
    counts = sorted({len(own) for own in seeds.values()})
    surfaces = "one realisation" if counts == [1] else f"{listed((str(count) for count in counts), 'or')} realisations"
    notes = []
    ensembles = [name for name in inputs.models if not entry_of(name).simulation and _knows_the_target(inputs, name)]
    if ensembles:
        target, realised = _slopes(inputs, ensembles), _slopes(inputs, list(seeds))
        notes.append(
            f"A theory with the target spectrum{target} knows no surface, the simulations have {surfaces} of "
            f"it{realised}: the scatter between surfaces enters its deviations from them."
        )
    notes.append(
        f"Medians and extremes are over states of the same {'surface' if counts == [1] else 'surfaces'}, which are no "
        "independent samples."
    )
    return notes


def _knows_the_target(inputs: Inputs, model: str) -> bool:
    own = spectrum_of(model)
    return any((own or case.spectra[0]) == TARGET for case in inputs.studies[entry_of(model).file].cases)


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
    return spread(deviations, pair, AREA, points, ones)


def _pair_sentence(deviations: xr.Dataset, pair: str, points: list[SweepPoint], units: dict[str, Scales]) -> str:
    model, reference = split_pair(pair)
    area = _area_spread(deviations, pair, points)
    words = (
        f"{_sentence_case(entry_of(model).words)} against {entry_of(reference).words}: contact area "
        f"{percent(area.low)} ({area.low_at}) to {percent(area.high)} ({area.high_at}), "
        f"median magnitude {percent_of(area.median)} over {area.count} states"
    )
    heights = {label: unit.rms_height for label, unit in units.items()}
    try:
        gap = spread(deviations, pair, GAP, points, heights)
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
